"""Fit one suspect jointly with the declared model: the best of its data-driven starts, then refined."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.identify.passes import Passes
from workbench.identify.problem import Problem, to_search
from workbench.identify.solve import Solution, cost_at, solve
from workbench.plant import Plant
from workbench.trace.candidates import ADDITION, Suspect
from workbench.trace.starts import starts

ROUGH = 1e-4  # relative decrease of the cost at which a start has shown what it is worth
PROMISING = 0.99  # cost over what was left, below which a suspect is fitted to the end
LEVEL = 1.002  # cost within which two starts have come to the same fit
REFINED = 2  # starts that are refined: the cheapest by their linear fit alone


def within_reach(plant: Plant, passes: Sequence[Passes]) -> Plant:
    """Return the plant with orders bounded to one period in the travel: a longer wave is a polynomial in disguise."""
    travel = max(float(np.ptp(p.motion.q)) for p in passes)
    least = 2 * np.pi / max(travel, 1e-300)
    for e in plant.effects:
        if any(p.scale == "order" and not p.fixed for p in e.parameters.values()):
            bounded = {
                n: replace(p, lower=max(p.lower, least), value=max(p.value, least)) if p.scale == "order" else p
                for n, p in e.parameters.items()
            }
            plant = plant.swap(replace(e, parameters=bounded))
    return plant


def fitted(suspect: Suspect, passes: Sequence[Passes], residuals: Sequence[np.ndarray]) -> tuple[Problem, Solution]:
    """Return the problem and its best solution. passes: identification records only; residuals: what is left on them.

    Raises NoValue where the suspect has no value on these records from any of its starts.
    """
    problem = Problem(within_reach(suspect.plant, passes), passes)
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
        best = [i for i in np.argsort(costs, kind="stable")[:REFINED] if np.isfinite(costs[i])]
        options = [options[i] for i in sorted(best)] or options[:1]
    solutions = [solve(problem, theta, ROUGH) for theta in options]
    least = min(s.cost for s in solutions)
    # of equal fits the earlier start: a wave of order k is also the second harmonic of k/2, whose start comes later
    best = next(s for s in solutions if s.cost <= LEVEL * least)
    # a suspect that leaves what the declared model left is not worth its last digits
    worth = best.cost < PROMISING * sum(float(r @ r) for r in residuals)
    return problem, solve(problem, best.theta) if worth else best
