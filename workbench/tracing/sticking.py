"""Where an axis sticks, dry friction without memory has no prediction: it holds whatever it has to.

A model of Coulomb friction goes from one level to the other as the encoder moves on, the drive of a stuck axis ramps between them.
Where that is most of what a declared model leaves, it hides what the model lacks and bends its parameters; so those samples do not
count then, in fits and in errors alike. Of 102 axes of three authors 16 stick so, of 80 benches one, of d01 to d30 and six measured
axes none. What a model lacks may hide it in turn, so it is asked again of what is left beside what was found.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.definition import catalogue
from workbench.finding import Finding
from workbench.identification.fit import fitted_on
from workbench.identification.problem import Problem
from workbench.identification.solve import Solution, solve
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import VALIDATION
from workbench.tracing.decimation import decimate, dry, still
from workbench.tracing.near_law import SEEN, count_at, freed, laws
from workbench.tracing.wording_search import sticks

# What halving and doubling does is of these 232 axes, and those of c01 to c14.
# s within one count that are rest, and at least three samples. Halved, slow motion is rest on two axes more; doubled, five that stop for
# less do not stick
STUCK = 0.005
SPREAD = 1.0  # over the evaluation bandwidth: what happens at rest passes its filter on either side for so long; neither changes any
MOST = 0.5  # of the residual's power, held at rest, from which rest does not count. Halved, eleven axes more stick; doubled, none. Of either role: moves
# from point to point rest more than what was fitted, and there rest alone was 0.88 of what four complete models leave
# Power of a sample at rest over that of one in motion: where it is less (a coarse encoder that creeps from count to count) rest is
# motion. Of 17 axes between 4 and 5 a gear shifter that rests half the time (4.76) is complete where it sticks and unknown where it does not; the
# others' verdicts are right and the same either way. Halved, XL330's coarse encoder sticks, and two axes that leave something else; doubled, two do
# not stick. It is asked of what was fitted whatever the role: XL330 has 3.2 there and 5.3 on validation
DENSE = 4.0
# Of what rest holds of the declared model's residual, that friction may leave there which gives way over more than two counts: less, and it is
# presliding that the encoder shows, which turns within the filter's time of every reversal. It leaves 0.003 then, where axes stick 0.17 and
# more: neither halved nor doubled it changes any of 54 campaigns with dry friction
YIELDS = 0.05
# Of what rest holds of the declared model's residual, if that is most of it, what a force that goes with place must take for rest to tell of a load, and
# of what is left in motion: a servo that stands most of the time shows there the arm that nobody declared. In eighteen cuts of XL330's records and bands it takes
# 0.87 to 0.93 of rest's, of two more of 58 axes 0.75 and 0.89, of the others 0.34 at most: 0.35 to 0.74 decide alike. Doubled, no load takes as
# much, and of XL330 below 10 Hz a spring is named, and friction that goes with the load
LOAD = 0.5
LOADS = ("gravity", "linear_stiffness", "constant_offset")

# Share of the samples in which an axis must move: of one that rests all the time by its counts (a beam on a motor of 1024 counts a turn, swept to
# and fro) nothing would be left to count. Halved or doubled, neither that one nor an actuator that rests in a seventh changes
MOVES = 0.1


@dataclass(frozen=True, eq=False)
class Sticking:
    """inverses: that count where the axis moves. samples, power: shares of the drive's samples and of a model's residual at rest. beside:
    whether that model is the declared one with all that was found beside it."""

    inverses: tuple[InverseDynamics, ...]
    samples: float
    power: float
    beside: bool = False

    @property
    def finding(self) -> Finding:
        """What is said of it."""
        return sticks(self.samples, self.power, self.beside)


def sticking(plant: Plant, inverses: Sequence[InverseDynamics]) -> Sticking | None:
    """Return the inverse dynamics that count where the axis moves, None where rest is not most of what the declared model leaves, on the
    records that it was fitted to or on those of validation."""
    rest = _resting(plant, inverses)
    if rest is None:
        return None
    decimated = decimate(fitted_on(inverses))
    problem = Problem(plant, decimated)
    found = solve(problem)
    fitted = _held(problem, found, rest, inverses)
    seen = decimate([p for p in inverses if p.motion.record.role == VALIDATION])
    beside = Problem(plant, seen)
    beside.carry(found.c)
    others = [_held(beside, found, rest, inverses)] if seen else []
    held = next((h for h in (fitted, *others) if h.power > MOST * h.total and h.density > DENSE), None)
    if held is None or fitted.density <= DENSE:  # an encoder so coarse that rest is motion is so in either role
        return None
    yielding = _giving_way(plant, decimated)
    if yielding is not None:
        given = Problem(yielding, decimated)
        if _held(given, solve(given), rest, inverses).power < YIELDS * fitted.power:
            return None
    counted = tuple(InverseDynamics(p.motion, counts=~r, times=p.times) for p, r in zip(inverses, rest, strict=True))
    return Sticking(counted, held.samples / held.count, held.power / held.total)


def holds_a_load(plant: Plant, inverses: Sequence[InverseDynamics]) -> bool:
    """Whether what rest holds of the declared model's residual, if that is most of it, is a load's and not friction's: a force that goes with place
    takes `LOAD` of it, and as much of what is left in motion. (Between two stops friction that holds has a place, too, but none in motion.) Such
    samples tell what is missing, and count."""
    rest = _resting(plant, inverses)
    if rest is None:
        return False
    decimated = decimate(fitted_on(inverses))
    declared, loaded = (Problem(p, decimated) for p in (plant, _with_load(plant)))
    held = _held(declared, solve(declared), rest, inverses)
    if held.power <= MOST * held.total:
        return False
    left = _held(loaded, solve(loaded), rest, inverses)
    return max(left.power / held.power, left.moving / max(held.moving, 1e-300)) < 1.0 - LOAD


def _with_load(plant: Plant) -> Plant:
    """Return the plant with a weight, a spring to ground and an offset at what it moves, those that it has not."""
    at = "axis" if plant.kind == ONE_MASS else "load"
    there = {e.name for e in plant.effects if e.at == at}
    for name in LOADS:
        if name not in there and "cable_spring" not in there and (plant.rotary or name != "gravity"):
            plant = plant + catalogue()[name](at=at)
    return plant


@dataclass(frozen=True)
class _Held:
    """power: of a model's residual at rest, total: of all of it; samples at rest, and count of all."""

    power: float
    total: float
    samples: int
    count: int

    @property
    def moving(self) -> float:
        """What the model leaves where the axis moves."""
        return self.total - self.power

    @property
    def density(self) -> float:
        """Power of a sample at rest over that of one in motion; 0 where hardly one is."""
        if self.count - self.samples < MOVES * self.count:
            return 0.0
        moving = self.moving * self.samples
        return self.power * (self.count - self.samples) / moving if moving > 0.0 else np.inf


def _held(problem: Problem, found: Solution, rest: Sequence[np.ndarray], inverses: Sequence[InverseDynamics]) -> _Held:
    """Return what rest holds of the drive's residual on a problem's decimated records, at the values that were found on those of
    identification. rest: (2, n) of bool, of each whole record among `inverses`."""
    known = dict(zip((p.motion.record.name for p in inverses), rest, strict=True))
    y, phi = problem.assemble(found.theta)
    held = total = 0.0
    samples = count = 0
    with np.errstate(invalid="ignore", over="ignore"):  # a law that has no value on these records holds nothing there
        left = y - phi @ found.c
    for p, r in zip(problem.inverses, problem.drive_part(left), strict=True):
        full = known[p.motion.record.name][0]
        at = full[np.rint(np.linspace(0.0, full.size - 1, p.motion.u.size)).astype(int)][p.motion.keep]
        held, total = held + float(r[at] @ r[at]), total + float(r @ r)
        samples, count = samples + int(np.count_nonzero(at)), count + at.size
    return _Held(held, total, samples, count)


def _giving_way(plant: Plant, decimated: Sequence[InverseDynamics]) -> Plant | None:
    """Return a plant whose dry friction gives way over lengths that the encoder sees, None where no curve of such lengths is found."""
    lengths = [
        replace(law, slips=tuple(s for s in law.slips if s > SEEN * count_at(law.declared.at, decimated)))
        for law in laws(plant, decimated)
        if "dir" not in law.declared.provides
    ]
    found = freed(plant, [law for law in lengths if law.slips], decimated)
    return None if found is plant else found


def _resting(plant: Plant, inverses: Sequence[InverseDynamics]) -> list[np.ndarray] | None:
    """Return where (2, n) the bodies with dry friction rest, of each record; None where nothing does."""
    places = dry(plant)
    drive = "motor" if "motor" in places else "axis"
    rest = [np.stack([_at_rest(p, drive, places), _at_rest(p, "load", places)]) for p in inverses]
    return rest if any(r[0].any() for r in rest) else None


def _at_rest(p: InverseDynamics, place: str, places: Sequence[str]) -> np.ndarray:
    """Return where (n,) a body with dry friction rests, and for how long that shows behind the filter."""
    if place not in places:
        return np.zeros(p.motion.u.size, dtype=bool)
    m = p.motion
    return still(p, place, STUCK, STUCK / 2.0 + SPREAD / m.filter.bandwidth)
