"""One optimiser for every controller: a global search by differential evolution, then a local one (Nelder-Mead).

Differential evolution (Storn and Price 1997) as SciPy keeps it, evaluated a generation at a time: every member of the
population and every scenario is a lane of one call. Both searches run on logarithms, from a recorded seed.
"""

from dataclasses import dataclass

import numpy as np

from workbench.control import Controller
from workbench.verify.families import Family
from workbench.verify.task import Task, cost

POPULATION = 12  # members a searched number
GENERATIONS = 40
LOCAL = 160  # evaluations of the local search


@dataclass(frozen=True, eq=False)
class Tuned:
    """A family's best point. numbers: name -> value, SI. value: its cost; evaluations: points tried."""

    family: Family
    point: np.ndarray
    value: float
    evaluations: int
    seed: int

    @property
    def numbers(self) -> dict[str, float]:
        return dict(zip(self.family.numbers, map(float, self.point), strict=True))

    def controller(self, lanes: int = 1) -> Controller:
        """Return the controller, the same in every one of `lanes` scenarios."""
        return self.family.controller(self.point[None, :], lanes)


def optimise(task: Task, family: Family, seed: int = 1) -> Tuned:
    """Return the point of the family with the least worst-case cost over the task's scenarios."""
    from scipy.optimize import differential_evolution, minimize

    scenarios = task.scenarios()
    lanes = scenarios.lanes
    bound = task.bound()
    w = task.weights
    tried = 0

    def values(logs: np.ndarray) -> np.ndarray:
        """logs (numbers, points) -> cost (points,)."""
        nonlocal tried
        points = np.exp(np.atleast_2d(logs.T))
        tried += len(points)
        metrics = task.run(family.controller(points, lanes), scenarios.tiled(len(points)))
        beyond = np.maximum(family.sensitivity(points) / w.sensitivity - 1.0, 0.0)
        return cost(task, metrics, bound, lanes) + w.steepness * beyond

    bounds = list(zip(np.log(family.lower), np.log(family.upper), strict=True))
    found = differential_evolution(
        values,
        bounds,
        x0=np.clip(np.log(family.start), *np.array(bounds).T),
        popsize=POPULATION,
        maxiter=GENERATIONS,
        tol=1e-4,
        polish=False,
        vectorized=True,
        updating="deferred",
        rng=np.random.default_rng(seed),
    )
    local = minimize(
        lambda x: float(values(x[:, None])[0]),
        found.x,
        method="Nelder-Mead",
        bounds=bounds,
        options={"maxfev": LOCAL, "xatol": 1e-3, "fatol": 1e-4, "initial_simplex": simplex(found.x)},
    )
    best, value = (local.x, local.fun) if local.fun <= found.fun else (found.x, found.fun)
    return Tuned(family, np.exp(best), float(value), tried, seed)


def simplex(x: np.ndarray) -> np.ndarray:
    """A first simplex of 5 % steps around x (logarithms)."""
    return np.vstack([x, x + 0.05 * np.eye(x.size)])
