"""Two effects that explain the same records: the motion along which they cannot both.

One of them is taken as the truth. Along a motion its drive leaves r_0 that the declared model cannot absorb, and r that
the declared model with the other effect cannot absorb. sin(angle) = |r|/|r_0|; the two part by r'r/sqrt(r' S r) standard
deviations, S the covariance of the noise. Along every motion of a pool shape parameters are linearised; along the few best
they are refitted, each effect taken as the truth in turn, and the smaller number counts.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import asin, degrees, inf

import numpy as np

from workbench.definition import Effect
from workbench.identification.bounded import bounded, scales
from workbench.identification.problem import Problem
from workbench.identification.solve import NoValue, slopes, solve
from workbench.inverse.dynamics import InverseDynamics
from workbench.planning import wording
from workbench.planning.envelope import Envelope, Sensing
from workbench.planning.following import followed, with_effect
from workbench.planning.motions import Reference
from workbench.planning.pool import pool
from workbench.plant import Plant
from workbench.processes import shared
from workbench.threads import one_thread

SECONDS = 4.0  # length of each motion of the pool
REFITTED = 3  # motions along which shape parameters are refitted
APART = 3.0  # standard deviations by which two effects must part to be told apart
ENOUGH = 10.0  # standard deviations beyond which the larger angle is the better motion
STEP = 15.0  # degrees: angles within it are as good


@dataclass(frozen=True, eq=False)
class Separation:
    """reference: the motion, or None where none within the limits parts them. angle: rad. deviations: standard deviations.

    motion: "record a sine of ..."; sentence: that with what it brings.
    """

    first: str
    second: str
    reference: Reference | None
    angle: float
    deviations: float
    motion: str
    sentence: str

    @property
    def apart(self) -> bool:
        """Whether the motion tells the two effects apart."""
        return self.deviations >= APART


@dataclass(frozen=True)
class Parting:
    """What one motion brings. angle: rad; deviations: standard deviations."""

    angle: float
    deviations: float

    def better(self) -> tuple[float, int, float]:
        """Order: enough standard deviations, then the angle as far as it matters, then still more of them."""
        return min(self.deviations, ENOUGH), round(degrees(self.angle) / STEP), self.deviations


@one_thread
def separate(
    plant: Plant, a: Effect, b: Effect, envelope: Envelope, sensing: Sensing, *, seconds: float = SECONDS
) -> Separation:
    """Return the motion that parts two effects best.

    plant: the model without either, its values fitted; where one of them is a declared effect with another value, with the
    declared value, held. a, b: at their places, with the values that explain the records. seconds: length of the motion, the load's where there are two masses.
    """
    models, silent = tuple(with_effect(plant, x) for x in (a, b)), []
    motions = list(pool((*plant.effects, a, b), envelope, sensing, seconds, plant.displacement))
    for truth, pair in ((a, models), (b, models[::-1])):
        tried = shared(lambda r, pair=pair: _tried(r, plant, pair, envelope, sensing), motions)
        found = [(*one, r) for one, r in zip(tried, motions, strict=True) if one is not None]
        if not found or max(shown for _, shown, _ in found) >= APART:
            break
        silent.append(truth)  # nothing parts from an effect that shows nowhere: the other one is the truth then
    if len(silent) == 2:
        return Separation(a.key, b.key, None, 0.0, 0.0, "", wording.shown_nowhere(a, b))
    best = sorted(found, key=lambda x: x[0].better(), reverse=True)[:REFITTED]
    motions = [r for *_, r in best]
    refitted = zip(shared(lambda r: _refitted(r, plant, pair, sensing), motions), motions, strict=True)
    parting, reference = max(refitted, key=lambda x: x[0].better(), default=(Parting(0.0, 0.0), None))
    return _found(a, b, parting, reference, silent)


def _tried(
    reference: Reference, plant: Plant, models: tuple[Plant, Plant], envelope: Envelope, sensing: Sensing
) -> tuple[Parting, float] | None:
    """Return (parting, standard deviations by which the first shows at all) along a motion; None where it asks too much drive."""
    inverse = followed(reference, models[0], sensing)
    if np.abs(inverse.motion.u).max() > envelope.drive:
        return None
    without, left = _rest(inverse, plant), _rest(inverse, models[1])
    parting = _parting(left, without, sensing, plant) if left.size and without.size else Parting(0.0, 0.0)
    shown = _parting(without, without, sensing, plant).deviations if without.size else 0.0
    return parting, shown


def _found(a: Effect, b: Effect, parting: Parting, reference: Reference | None, silent: Sequence[Effect]) -> Separation:
    """Return what the best motion brings. silent: those of the two that show nowhere themselves."""
    best = (parting.angle, parting.deviations)
    if reference is None or parting.deviations < APART:
        sentence = wording.not_apart(a, b, *best, some=reference is not None)
        return Separation(a.key, b.key, reference, *best, "", sentence)
    motion = f"record {reference.phrase}"
    return Separation(a.key, b.key, reference, *best, motion, wording.apart(a, b, *best, motion, silent))


def _parting(left: np.ndarray, without: np.ndarray, sensing: Sensing, plant: Plant) -> Parting:
    """left: (n,) that the other effect leaves. without: (n,) that the declared model leaves."""
    power, whole = float(left @ left), float(without @ without)
    if power <= 0.0 or whole <= 0.0:
        return Parting(0.0, 0.0)
    scatter = float(sensing.scatter(left[:, None], plant)[0, 0])
    return Parting(asin(min((power / whole) ** 0.5, 1.0)), power / scatter**0.5)


def _rest(inverse: InverseDynamics, plant: Plant) -> np.ndarray:
    """Return what `plant` cannot absorb of the drive, to first order in its shape parameters, (n,)."""
    problem = Problem(plant, (inverse,))
    theta = problem.start()
    y, phi = problem.assemble(theta)
    if not (np.isfinite(y).all() and np.isfinite(phi).all()):
        return np.zeros(0)
    c = bounded(phi, y, *problem.bounds)
    columns = np.hstack([phi, slopes(problem, theta, c, y, phi)])
    columns = columns / scales(columns)
    left = y - phi @ c
    return left - columns @ np.linalg.lstsq(columns, left, rcond=1e-9)[0]


def _refitted(reference: Reference, plant: Plant, models: Sequence[Plant], sensing: Sensing) -> Parting:
    """Return the smaller parting of the two ways round, shape parameters fitted anew.

    The other way round counts only where that effect, as it is given, shows at all.
    """
    worst = Parting(inf, inf)
    for truth, other in (models, models[::-1]):
        inverse = followed(reference, truth, sensing)
        try:
            # a map of the command may have no value at what a motion asks of the other effect: that shows in what is found
            with np.errstate(all="ignore"):
                without, left = [solve(Problem(p, (inverse,)), tolerance=1e-4).residual for p in (plant, other)]
        except NoValue:
            return Parting(0.0, 0.0)
        here = _parting(left, without, sensing, plant)
        if truth is models[1] and _parting(without, without, sensing, plant).deviations < APART:
            continue
        worst = min(worst, here, key=lambda p: p.deviations)
    return worst
