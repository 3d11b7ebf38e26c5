"""The free-form law of each family as a candidate, with knots from the records: what could any law of the family take?"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.definition import Effect
from workbench.effects.families import FREE_FORMS, FreeForm, family_of, knots_of
from workbench.effects.free_bank import slips_of
from workbench.effects.free_maps import angle_over_angle
from workbench.errors import WorkbenchError
from workbench.inverse.bodies import POSITION, VELOCITY
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant, places
from workbench.residual.orders import order_spectrum, peaks
from workbench.tracing.candidates import ADDITION, Candidate, needless
from workbench.tracing.starts import resolved

MEMORY = "friction with memory"
ANGLES = "angle over angle"
PERIODIC = ("force over position", "friction over position")
HARMONICS = 4  # of a motor's turn: teeth and waves of a gear, and the second of each
FASTEST = 0.25  # of the evaluation bandwidth, of a relaxation: what relaxes faster is viscous friction in the band


@dataclass(frozen=True)
class Free:
    """A free-form law at one place. candidate: the plant with it; its keys `instead` are what it takes the place of."""

    family: str
    candidate: Candidate

    @property
    def effect(self) -> Effect:
        return self.candidate.plant[self.candidate.key]


def free_forms(
    plant: Plant,
    inverses: Sequence[InverseDynamics],
    families: Sequence[str] | None = None,
    left_at: Callable[[str], Sequence[np.ndarray]] = lambda place: (),
) -> list[Free]:
    """Return the free-form law of each family (of these, all where None) at every place of a plant where it could act.

    inverses: of the identification records, from which the knots come. left_at: residuals by place, (n,) each, zero where nothing counts, whose
    peaks over position are the orders of what is periodic; none where they are not given. A family is left out where the records do not cover its
    coordinate (a travel of nothing, a bank without a friction that it could take the place of).
    """
    found = []
    for family, form in sorted(FREE_FORMS.items()):
        if families is not None and family not in families:
            continue
        for place in places(plant.kind, _sample(form)):
            if family != MEMORY and family_of(_sample(form)(at=place)) != family:
                continue
            made = _made_for(form, family, plant, inverses, place, left_at)
            if made is None or made.key in (e.key for e in plant.effects):
                continue
            instead = needless(made, plant) or _replaced(made, plant)
            rest = plant
            for key in instead:
                rest = rest.without(key)
            found.append(Free(family, Candidate(made.named, place, ADDITION, rest + made, instead)))
    return found


def _sample(form: FreeForm) -> Effect:
    """A free-form law whose knots say nothing: of its places only."""
    return form.make((1.0, 2.0, 3.0), (), form.at)


def _replaced(made: Effect, plant: Plant) -> tuple[str, ...]:
    """Keys of what gives the direction at a place where `made` gives it, too."""
    if "dir" not in made.provides:
        return ()
    return tuple(e.key for e in plant.effects if e.at == made.at and "dir" in e.provides)


def _made_for(
    form: FreeForm,
    family: str,
    plant: Plant,
    inverses: Sequence[InverseDynamics],
    place: str,
    left_at: Callable[[str], Sequence[np.ndarray]],
) -> Effect | None:
    """Return the free-form law at a place with knots from the records; None where they do not cover its coordinate."""
    if family == ANGLES:
        return _of_angle(plant, inverses, place)
    if family == MEMORY:
        knots = _slips(plant, inverses, place)
    elif family == "creep":
        knots = _rates(inverses, form.count)
    else:
        knots = knots_of([_values(form, plant, p, place) for p in inverses], form)
    if not knots:
        return None
    residuals = left_at(place) if family in PERIODIC and place != "joint" else ()
    if len(residuals):
        signed = [np.sign(p.motion.v) * r for p, r in zip(inverses, residuals, strict=True)]
        waves = _orders(inverses, signed if family == "friction over position" else residuals)
        return form.make(knots, plant.effects, place, orders=waves)
    return form.make(knots, plant.effects, place)


def _of_angle(plant: Plant, inverses: Sequence[InverseDynamics], place: str) -> Effect | None:
    """Return the gear's error over its motor's turn, of the harmonics that the records show; None where they show no turn.

    None, too, where the plant has one of the harmonics at that place: on this travel the two would be one wave, and cancel at any size.
    """
    order = plant.geometry.gear_ratio
    travel = max(float(np.ptp(p.motion.q)) for p in inverses)
    harmonics = min(HARMONICS, int(resolved(inverses) / order))
    there = (e.parameters for e in plant.effects if e.at == place and e.family == ANGLES)
    waves = [(p["order"] if "order" in p else p["turns"]).value for p in there]  # a disc's error has turns
    if any(
        abs(k - round(k / order) * order) * travel < 2.0 * np.pi for k in waves if 0.5 < k / order < harmonics + 0.5
    ):
        return None
    return angle_over_angle(order, harmonics, place) if harmonics and order * travel > 2.0 * np.pi else None


def _orders(inverses: Sequence[InverseDynamics], residuals: Sequence[np.ndarray]) -> tuple[float, ...]:
    """Return the orders of the largest peaks of residuals over position, each at the top of the parabola through its peak."""
    found, amplitude = order_spectrum(inverses, residuals)
    travel = max(float(np.ptp(p.motion.q)) for p in inverses)
    tops = []
    for k in peaks(found, amplitude, travel, resolved(inverses)):
        i = int(np.searchsorted(found, k))
        a, b, c = amplitude[i - 1 : i + 2]
        tops.append(k + 0.5 * (a - c) / min(a - 2.0 * b + c, -1e-300) * (found[1] - found[0]))
    return tuple(float(k) for k in tops)


def _values(form: FreeForm, plant: Plant, inverses: InverseDynamics, place: str) -> np.ndarray:
    """Return a family's coordinate along one record, (n,), where errors count."""
    m = inverses.motion
    if form.signal in ("u", "tau"):
        return inverses.command.applied(plant)[m.keep]
    if form.signal == "t":
        return m.t[m.keep]
    _, body = inverses.bodies.body(plant, place)
    return body[{"v": VELOCITY, "q": POSITION}[form.signal]][m.keep]


def _rates(inverses: Sequence[InverseDynamics], count: int) -> tuple[float, ...]:
    """Return rates of relaxation, 1/s: from once over the longest record to FASTEST of the band."""
    slowest = 1.0 / max(float(np.ptp(p.motion.t)) for p in inverses)
    fastest = FASTEST * 2.0 * np.pi * min(p.motion.filter.bandwidth for p in inverses)
    return tuple(float(r) for r in np.geomspace(slowest, fastest, count)) if fastest > slowest else ()


def _slips(plant: Plant, inverses: Sequence[InverseDynamics], place: str) -> tuple[float, ...]:
    """Return the slips of a bank in the place of the friction that is declared there; empty where there is none."""
    there = [e for e in plant.effects if e.at == place and (e.name == "coulomb_friction" or "dir" in e.provides)]
    counts = max((p.motion.counts for p in inverses), default=0.0)
    for e in sorted(there, key=lambda e: not e.provides):
        try:
            return slips_of(e, counts)
        except WorkbenchError:  # no counts are stated, or it has no length
            continue
    return ()
