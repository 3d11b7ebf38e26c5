"""Fit one candidate jointly with the present model: the best of its data-driven starts, then refined."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.identification.linearised import Linearised
from workbench.identification.problem import Problem, to_search
from workbench.identification.solve import Solution, solve
from workbench.inverse.dynamics import InverseDynamics
from workbench.parameter import Parameter
from workbench.plant import Plant
from workbench.tracing.budget import BUDGET, Budget
from workbench.tracing.candidates import ADDITION, Candidate
from workbench.tracing.starts import resolved, starts

ROUGH = 3e-3  # relative decrease of the cost at which a start has shown what it is worth
LEVEL = 2e-3  # relative difference of the cost within which two starts have come to the same fit
SLOWEST = 10.0  # delay or lag over 1/(2 pi) of the evaluation band's shortest period, at most
HOPELESS = 4e-3  # of the residual's power, that a start must explain or promise to be refined further
WORSE = 1e-9  # relative excess of the cost over the present model's from which a start is worse than none


def within_reach(plant: Plant, inverses: Sequence[InverseDynamics]) -> Plant:
    """Return the plant with orders bounded by the travel and by what is resolved, and times to SLOWEST.

    A wave longer than the travel is a polynomial in disguise, and one that the encoder or the band does not resolve is a
    longer wave; a map of the command that lets almost nothing of the band pass leaves nothing to be explained.
    """
    travel = max(float(np.ptp(p.motion.q)) for p in inverses)
    bounds = {
        "order": (2 * np.pi / max(travel, 1e-300), resolved(inverses)),
        "time": (-np.inf, SLOWEST / (2 * np.pi * inverses[0].motion.filter.bandwidth)),
    }
    for e in plant.effects:
        if any(p.scale in bounds and not p.fixed for p in e.parameters.values()):
            bounded = {n: _within(p, *bounds[p.scale]) if p.scale in bounds else p for n, p in e.parameters.items()}
            plant = plant.swap(replace(e, parameters=bounded))
    return plant


def _within(p: Parameter, least: float, most: float) -> Parameter:
    """Return the parameter with narrower bounds, and its value inside them."""
    lower, upper = max(p.lower, least), max(min(p.upper, most), least)
    return replace(p, lower=lower, upper=upper, value=min(max(p.value, lower), upper))


def problem_with(candidate: Candidate, base: Problem, solution: Solution) -> Linearised:
    """Return the problem of a candidate beside the solved present model."""
    return Linearised(within_reach(candidate.plant, base.inverses), base, solution)


def worth(problem: Linearised, options: Sequence[np.ndarray], refined: int) -> list[float]:
    """Return the cost of each start, of its linear fit alone. refined: of the cheapest, that are searched on.

    Where the first ones of a map come to the same they change nothing (its size starts from none), nor do the others: their
    slopes tell, later.
    """
    costs: list[float] = []
    for theta in options:
        same = len(costs) == refined and np.isfinite(costs).all() and max(costs) <= (1.0 + WORSE) * min(costs)
        if same and not problem.beside:
            break
        costs.append(problem.cost(theta, roughly=True))
    return costs


def fitted(
    candidate: Candidate,
    base: Problem,
    solution: Solution,
    residuals: Sequence[np.ndarray],
    budget: Budget = BUDGET,
) -> tuple[Linearised, Solution]:
    """Return the linearised problem of a candidate and its best solution. residuals: what is left on the records.

    Raises NoValue where the candidate has no value on these records from any of its starts.
    """
    problem = problem_with(candidate, base, solution)
    options = [problem.start()]
    if candidate.kind == ADDITION:
        effect = candidate.plant[candidate.key]
        options = [
            np.array([start.get(n.parameter, to_search(problem.parameter(n))) for n in problem.free_shape])
            for start in starts(effect, base.inverses, residuals, candidate.plant, budget)
        ] or options
    rough = ROUGH
    if len(options) > 1:
        costs = worth(problem, options, budget.refined)
        best = [i for i in np.argsort(costs, kind="stable")[: budget.refined] if np.isfinite(costs[i])]
        best = best[:1] + [i for i in best[1:] if costs[i] <= (1.0 + WORSE) * solution.cost]
        if best and problem.beside and costs[best[0]] > (1.0 - HOPELESS) * solution.cost:
            best, rough = best[:1], 1.0
        options = [options[i] for i in sorted(best)] or options[:1]
    least = 0.0 if problem.beside else HOPELESS  # a map starts from what changes nothing: its slopes tell
    solutions = [solve(problem, theta, rough, least) for theta in options]
    least = min(s.cost for s in solutions)
    # of equal fits the earlier start: a wave of order k is also the second harmonic of k/2, whose start comes later
    return problem, next(s for s in solutions if s.cost <= (1.0 + LEVEL) * least)
