"""Fit one suspect jointly with the declared model: the best of its data-driven starts, then refined."""

from collections.abc import Sequence

import numpy as np

from workbench.identify.passes import Passes
from workbench.identify.problem import Problem, to_search
from workbench.identify.solve import Solution, cost_at, solve
from workbench.trace.candidates import ADDITION, Suspect
from workbench.trace.starts import starts

REFINED = 2  # starts that are refined: the cheapest by their linear fit alone


def fitted(suspect: Suspect, passes: Sequence[Passes], residuals: Sequence[np.ndarray]) -> tuple[Problem, Solution]:
    """Return the problem and its best solution. passes: identification records only; residuals: what is left on them."""
    problem = Problem(suspect.plant, passes)
    base = problem.start()
    options = [base]
    if suspect.kind == ADDITION:
        effect = suspect.plant[suspect.key]
        options = []
        for start in starts(effect, passes, residuals, suspect.plant):
            theta = base.copy()
            for k, name in enumerate(problem.free_shape):
                if name.key == suspect.key:
                    theta[k] = start.get(name.parameter, to_search(problem.parameter(name)))
            options.append(theta)
        options = options or [base]
    if len(options) > 1:
        costs = [cost_at(problem, theta)[0] for theta in options]
        options = [options[i] for i in np.argsort(costs, kind="stable")[:REFINED]]
    solutions = [solve(problem, theta) for theta in options]
    return problem, min(solutions, key=lambda s: s.cost)
