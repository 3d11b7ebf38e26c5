"""A log so slow that friction turns between its samples: its operators then run along the path between them.

Coulomb friction takes its step at the moment of reversal. Of a log of nine times the band that is half a sample, a twentieth of the
band's period, which is more than many a model leaves. Whether a drive's log takes a value of the moment or of the sample's mean nobody
says, so the records decide.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from workbench.finding import Finding
from workbench.identification.fit import fitted_on
from workbench.identification.problem import Problem
from workbench.identification.solve import solve
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.tracing.decimation import FINE, decimate, rubs
from workbench.tracing.wording_search import turns_between

# Rate over the band along the path between samples. Halved, a complete model of a swing of Coulomb friction, logged at nine times the band,
# leaves 1.1 instead of 0.6 %, and a clock is blamed; doubled, 0.4 %
OFTEN = 64.0
# Of the power of what the declared model leaves, that turning between samples takes away at least: less is what any other path takes of a
# residual of something else. Of 184 campaigns and axes eight gain 6 % and more, others less or nothing of practical size.
# Halved, two more are read so; doubled, three less: every verdict is the same
GAINS = 0.05
ENOUGH = 1e-3  # relative decrease of the cost at which the declared model is fitted well enough to be asked: a tenth or ten times of it move no share by a hundredth


@dataclass(frozen=True, eq=False)
class SlowLog:
    """inverses: whose operators run along the path between samples. rate: Hz, of the slowest log. times: of it, what is read. before,
    after: what the declared laws leave of the drive's rms at the search's rate, at the same values."""

    inverses: tuple[InverseDynamics, ...]
    rate: float
    times: int
    before: float
    after: float

    @property
    def finding(self) -> Finding:
        """What is said of it."""
        return turns_between(self.rate, self.times, self.before, self.after)


def slow_log(plant: Plant, inverses: Sequence[InverseDynamics], practical: float) -> SlowLog | None:
    """Return operators that run between samples, None where they take less than a practical share of the drive from the declared model.

    They are asked at the rate at which operators run in a search, which is cheap, and run at OFTEN where that takes something.
    """
    if not any(_slow(p) for p in inverses) or not rubs(plant):
        return None
    problem = Problem(plant, decimate(fitted_on(inverses)))
    found = solve(problem, tolerance=ENOUGH)
    before = _left(problem, found.residual)

    def after(oftener: Sequence[InverseDynamics]) -> float:
        between = Problem(plant, decimate(fitted_on(oftener)))
        y, phi = between.assemble(found.theta)
        return _left(between, y - phi @ found.c)

    if before**2 - after(_oftener(inverses, FINE)) ** 2 < max(practical**2, GAINS * before**2):
        return None
    oftener, slowest = _oftener(inverses, OFTEN), max(inverses, key=lambda p: p.motion.dt)
    return SlowLog(oftener, 1.0 / slowest.motion.dt, _times(slowest, OFTEN), before, after(oftener))


def _oftener(inverses: Sequence[InverseDynamics], rate: float) -> tuple[InverseDynamics, ...]:
    """Return the inverse dynamics with the path of slow logs read at `rate` times the band."""
    return tuple(InverseDynamics(p.motion, counts=p.counts, times=_times(p, rate)) if _slow(p) else p for p in inverses)


def _slow(p: InverseDynamics) -> bool:
    """Return whether a log is slower than operators run in a search: at fourteen times the band a belt's complete model leaves 4.6 % by its
    own samples, 3.6 between them, and a clock is blamed for the rest."""
    return FINE * p.motion.filter.bandwidth * p.motion.dt > 1.0 + 1e-9


def _times(p: InverseDynamics, rate: float) -> int:
    """Return how often the path is read a sample, for `rate` times the band."""
    return ceil(rate * p.motion.filter.bandwidth * p.motion.dt - 1e-9)


def _left(problem: Problem, residual: np.ndarray) -> float:
    """Return the drive's part of a stacked residual, over the rms of the filtered drive."""
    drives = (p.filtered_drive(problem.plant)[0, p.motion.keep] for p in problem.inverses)
    power = sum(float(u @ u) for u in drives)
    return float(np.sqrt(sum(float(r @ r) for r in problem.drive_part(residual)) / max(power, 1e-300)))
