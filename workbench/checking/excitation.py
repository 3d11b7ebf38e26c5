"""Missing excitation of each declared parameter, as identification would say it after a fit."""

from collections.abc import Iterator

import numpy as np

from workbench.checking.seen import Seen
from workbench.finding import Finding
from workbench.identification import findings, intervals
from workbench.identification.fit import fitted_on
from workbench.identification.problem import Problem
from workbench.identification.solve import Solution, solved_at

BLOCK = 0.05  # s
QUIET = 0.1  # share of the blocks that are taken for noise alone


def missing(seen: Seen) -> Iterator[Finding]:
    """Say which free parameters the identification records do not excite, the shape parameters as declared."""
    problem = Problem(seen.campaign.plant, fitted_on(seen.passes))
    theta = problem.start()
    at = solved_at(problem, theta)
    if not np.isfinite(at.cost):
        yield Finding(
            "no value", "plant",
            "An effect of the declared plant has no value on these records.",
            {}, "Check the declared parameters and their units.",
        )  # fmt: skip
        return
    solution = Solution(theta, at.c, at.y, at.phi, at.cost, np.zeros((at.y.size, theta.size)))
    names, covariance, t, _ = intervals.covariance(problem, solution)
    half = dict(zip(names, t * np.sqrt(np.maximum(np.diag(covariance), 0.0)), strict=True))
    yield from findings.excitation(problem, solution, half, noise(problem, solution), "noise")


def noise(problem: Problem, solution: Solution) -> float:
    """Return rms of the residual where it is quietest: elsewhere it is what the model lacks, and no want of excitation."""
    squares = solution.residual**2
    blocks = [float(np.sqrt(np.mean(squares[b]))) for b in problem.blocks(BLOCK)]
    return float(np.quantile(blocks, QUIET))
