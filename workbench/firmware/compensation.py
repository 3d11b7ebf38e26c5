"""A compensation as firmware: what named effects take of the drive, in C99, to be handed to a law's `added`.

The instructions are those of the law that was simulated: `compensation.parts`, of the way since the last sample in counts. What
has memory runs as instructions; what has none and needs an exponential or a sine is a table over the place or the speed.

    way, place ─► observe: dq, v, a ─► look up over v and place ─► act: forces of the effects, gain, low pass, delay ─► force
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite

import casadi as ca
import numpy as np

from workbench.compensation import OBSERVED, READ, Compensator
from workbench.compensation.parts import acted, late
from workbench.compensation.structure import PREFIX, Structure, states_of, structure, values_of
from workbench.definition import namespace
from workbench.effects.elementary import clip
from workbench.errors import WorkbenchError
from workbench.firmware.naming import identifier
from workbench.firmware.parts import Constant, Part
from workbench.firmware.tabulated import PLACES, STEADY, Curve, tabulated
from workbench.firmware.units import NONE
from workbench.kernel import arrays
from workbench.kernel.choice import with_choices
from workbench.kernel.program import read
from workbench.kernel.split import split
from workbench.plant import Plant
from workbench.simulation import Loop

SEEN = ("dq", "v", "a")
FORCE = "force"


@dataclass(frozen=True, eq=False)
class Compensation:
    """observe, act: instructions. constants, values (n,): what they hold, SI. tables: name -> curve over "v" (SI) or "place" (counts).

    states: kept from sample to sample. count: rad or m; limit: N*m or N; speed: rad/s or m/s that is told apart.
    """

    compensator: Compensator
    observe: Part
    act: Part
    constants: tuple[Constant, ...]
    values: np.ndarray
    tables: Mapping[str, Curve]
    states: tuple[str, ...]
    loop: Loop
    limit: float
    speed: float
    effort: str

    @property
    def count(self) -> float:
        return self.loop.count

    def over(self, table: str) -> str:
        """What a table is looked up over."""
        return table.split("_")[1]


def compensation(
    compensator: Compensator, loop: Loop, plant: Plant, travel: tuple[float, float] | None = None
) -> Compensation:
    """Return the instructions and numbers of a compensation on a loop.

    travel: rad or m from the zero of the identification, where a force over the place is compensated. WorkbenchError for an
    effect that reads what only a simulation knows, an observer, an encoder without counts, a drive without limits.
    """
    _refuse(compensator, loop, plant)
    s = structure(compensator)
    tables, known = tabulated(s, compensator, loop, plant, travel)
    numbers = values_of(compensator, s) | {
        "count": loop.count, "sample_rate": 1.0 / loop.sample_time, "dt": loop.sample_time, "smoothing": loop.smoothing,
    }  # fmt: skip
    p = {n: ca.SX.sym(n) for n in numbers}
    z = {n: ca.SX.sym(n) for n in states_of(s)}
    seen, kept = _observed(s, p)
    rows = {n: ca.SX.sym(n) for n in (*SEEN, "place", *tables)}
    after, force = _act(s, rows, z, p, known)
    constants: list[Constant] = []
    values: list[float] = []
    observe = _part("observe", seen, kept, p, numbers, constants, values)
    acting = _part("act", rows | z, after | {FORCE: force}, p, numbers, constants, values)
    states = tuple(dict.fromkeys((*observe.outputs, *(n for n in acting.outputs if n != FORCE))))
    return Compensation(
        compensator, observe, acting, tuple(constants), np.array(values), tables, states, loop, plant.limits.drive,
        plant.limits.speed, plant.effort,
    )  # fmt: skip


def _refuse(c: Compensator, loop: Loop, plant: Plant) -> None:
    """Raise WorkbenchError, saying what would mend it, for what is no firmware of its own."""
    if c.source == OBSERVED:
        raise WorkbenchError(
            "an observer lives in the loop of its law; export a compensation from 'measured' or 'reference'."
        )
    if c.maps:
        raise WorkbenchError(
            f"effect '{c.maps[0].named}' is an error of the angle, no force; workbench.drives.kinematic writes its table."
        )
    if c.source == READ and len({e.at for e in c.forces}) > 1:
        raise WorkbenchError("a compensation from the measured position reads one encoder; export one for each side.")
    for e in c.forces:
        missing = [n for n in e.reads if n not in {*SEEN, *PLACES, *STEADY, "dir"}]
        if missing:
            raise WorkbenchError(
                f"effect '{e.named}' reads '{missing[0]}', which a compensation's firmware does not have."
            )
    if loop.count <= 0.0 or not isfinite(plant.limits.drive) or not isfinite(plant.limits.speed):
        raise WorkbenchError(
            "firmware needs counts of the encoder, a limit of the drive and one of the speed; state them."
        )


def _observed(s: Structure, p: Mapping[str, ca.SX]) -> tuple[dict, dict]:
    """Return (rows, outputs): the way since the last sample to increments, speed and acceleration, as `compensation.parts` has them."""
    rows = {n: ca.SX.sym(n) for n in ("moved", "gap", "vh", "before")}
    moved, speed = rows["moved"], rows["moved"] * p["count"] * p["sample_rate"]
    out = {"dq": moved * p["count"], "v": speed}
    if s.source == READ:  # a dead band of one count, and the loop's filtered difference
        gap = clip(rows["gap"] - moved, -0.5, 0.5)
        v = rows["vh"] + p["smoothing"] * (speed - rows["vh"])
        out = {"dq": (moved + gap - rows["gap"]) * p["count"], "v": v, "gap": gap, "vh": v}
    if any("a" in e.reads for e in s.order):
        out |= {"a": (out["v"] - rows["before"]) * p["sample_rate"], "before": out["v"]}
    return rows, out


def _act(s: Structure, rows: Mapping, z: Mapping, p: Mapping, known: Mapping) -> tuple[dict, ca.SX]:
    """Return (next states, force) from what was observed and looked up."""
    q = rows["place"] * p["count"]
    signals = {n: rows[n] for n in SEEN} | dict.fromkeys(PLACES, q) | {"dt": p["dt"], "locked": ca.SX(0)}
    signals |= {n: p[f"{PREFIX}_{n}"] for n in ("ratio", "pole_pairs")}
    states, numbers = namespace(**z), namespace(**p)
    after, total = {}, ca.SX(0)
    for side in s.sides:
        stand = {k: (lambda given, names=names: _looked(names, rows, given)) for k, names in known.items()}
        following, force = acted(s, side, dict(signals), states, numbers, p["count"], stand)
        after, total = after | following, total + force
    shaped, total = late(s, namespace(dt=p["dt"]), states, numbers, total)
    return after | shaped, total


def _looked(names: tuple[str, ...], rows: Mapping, given: Mapping) -> ca.SX:
    """What tables stand for: a value, and one times the direction. A sum is read at the first of its effects."""
    return sum((rows[n] * (given["dir"] if n.endswith("dir") else 1.0) for n in names), ca.SX(0))


def _part(name, rows, outputs, p, numbers, constants: list[Constant], values: list[float]) -> Part:
    """Return one stage with its constants cut out, evaluated, and counted among those that there are."""
    result = ca.vertcat(*(ca.densify(ca.SX(v)) for v in outputs.values()))
    symbols = rows | dict(p)
    needed = ca.which_depends(result, ca.vertcat(*symbols.values()), 1, False)
    used = {n: x for (n, x), need in zip(symbols.items(), needed, strict=True) if need}
    function = ca.Function(name, [ca.vertcat(*used.values())], [ca.cse(result)])
    before, after = split(read(function), [n in p for n in used])
    given = [numbers[n] for n in used if n in p]
    found = [float(v) for v in arrays.evaluate(before, given)[0]] if before.outputs[0] else []
    places = []
    for k, v in enumerate(found):
        places.append(values.index(v) if v in values else len(values))
        if v not in values:
            values.append(v)
            constants.append(Constant(f"{name}_{k}", f"{name} {k}", NONE))
    program = with_choices(after)
    alive = {line.out for line in program.lines}
    said = {v: identifier(n) for n, v in zip(outputs, program.outputs[0], strict=True) if v in alive}
    powers = dict.fromkeys((*alive, *said), NONE)
    return Part(name, tuple(n for n in used if n not in p), tuple(places), tuple(outputs), program, said, powers)
