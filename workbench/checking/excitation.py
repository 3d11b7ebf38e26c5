"""Missing excitation of each declared parameter, as identification would find it after a fit."""

from collections.abc import Iterator

import numpy as np

from workbench.checking.seen import Seen
from workbench.identification import intervals
from workbench.identification.excitation import Unexcited, unexcited
from workbench.identification.fit import fitted_on
from workbench.identification.problem import Problem
from workbench.identification.solve import Solution, solved_at

BLOCK = 0.05  # s
SMOOTH = 3  # terms of a parabola
QUIET = 0.1  # share of the blocks that are taken for noise alone


class NoValue:
    """An effect of the declared plant has no value on the records."""


def missing(seen: Seen) -> Iterator[Unexcited | NoValue]:
    """Yield which free parameters the identification records do not excite, the shape parameters as declared."""
    problem = Problem(seen.campaign.plant, fitted_on(seen.inverses))
    theta = problem.start()
    at = solved_at(problem, theta)
    if not np.isfinite(at.cost):
        yield NoValue()
        return
    solution = Solution(theta, at.c, at.y, at.phi, at.cost, lambda: np.zeros((at.y.size, theta.size)))
    names, covariance, t, _ = intervals.covariance(problem, solution)
    half = dict(zip(names, t * np.sqrt(np.maximum(np.diag(covariance), 0.0)), strict=True))
    yield from unexcited(problem, solution, half, _noise(problem, solution))


def _noise(problem: Problem, solution: Solution) -> float:
    """Return rms of the residual about a parabola of each BLOCK, where that is quietest.

    What a model lacks is smooth over so short a time (a weight, a spring, a wave of the travel), or is where the motion turns.
    """
    rows = max(p.rows(problem.plant) for p in problem.inverses)  # balances of one sample stand one after another
    parts = [[rough(solution.residual[b][k::rows]) for k in range(rows)] for b in problem.blocks(BLOCK)]
    return float(np.quantile(np.sqrt(np.mean(np.square(parts), axis=1)), QUIET))


def rough(x: np.ndarray) -> float:
    """Return rms of x (n,) about its parabola, for the degrees of freedom that are left."""
    if x.size <= SMOOTH:
        return float(np.sqrt(np.mean(x**2)))
    t = np.linspace(-1.0, 1.0, x.size)
    basis = np.linalg.qr(np.vander(t, SMOOTH))[0]
    return float(np.sqrt(np.sum((x - basis @ (basis.T @ x)) ** 2) / (x.size - SMOOTH)))
