"""One optimiser for every controller: a global search by differential evolution, then a local one (Nelder-Mead).

Differential evolution (Storn and Price 1997) as SciPy keeps it, evaluated a generation at a time: every member of the
population and every scenario is a lane of one call. Both searches run on logarithms, from a recorded seed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.design.families.family import Family, OfFamily
from workbench.design.tries import Trail, Tries
from workbench.keeping import steps
from workbench.task.task import Task

NEAR = 0.1  # how far members about a start lie from it, of a logarithm

SEEDS = (1, 2, 3)


@dataclass(frozen=True)
class Budget:
    """What one search may spend. population: members a searched number; close: of them about each start; local: evaluations of
    the local search, which on the main study's controllers betters the evolution by up to 0.5 %. A quarter as many leave 0.06 % of that, a tenth of
    the time, and on two masses a PD whose error compensation divides by 4.99 instead of 5.07."""

    population: int = 12
    generations: int = 60
    close: int = 10
    local: int = 240


BUDGET = Budget()


@dataclass(frozen=True, eq=False)
class Tuned(OfFamily):
    """A family's best point. numbers: name -> value, SI. value: its cost; evaluations: points tried; trail: what they gave."""

    family: Family
    point: np.ndarray
    value: float
    evaluations: int
    seed: int
    trail: Trail


@dataclass(frozen=True, eq=False)
class Seeded:
    """A family tuned from several seeds, (runs,). median: the run of middling cost, which stands for all."""

    runs: tuple[Tuned, ...]

    @property
    def family(self) -> Family:
        return self.runs[0].family

    @property
    def median(self) -> Tuned:
        return sorted(self.runs, key=lambda r: (r.value, r.seed))[(len(self.runs) - 1) // 2]

    @property
    def spread(self) -> float:
        """Largest less smallest cost."""
        values = [r.value for r in self.runs]
        return max(values) - min(values)

    @property
    def trail(self) -> Trail:
        """What all points of all seeds gave."""
        return Trail.joined([r.trail for r in self.runs])


def optimise_seeds(task: Task, family: Family, seeds: Sequence[int] = SEEDS, budget: Budget = BUDGET) -> Seeded:
    """Return the family tuned from each seed."""
    return Seeded(optimise_all([(task, family, seed) for seed in seeds], budget))


def optimise(task: Task, family: Family, seed: int = 1, budget: Budget = BUDGET) -> Tuned:
    """Return the point of the family with the least worst-case cost over the task's scenarios."""
    return optimise_all([(task, family, seed)], budget)[0]


def optimise_all(searches: Sequence[tuple[Task, Family, int]], budget: Budget = BUDGET) -> tuple[Tuned, ...]:
    """Return what each search, (task, family, seed), comes to; they are made side by side."""

    def found(search: tuple[Task, Family, int]) -> Tuned:
        return replace(_optimised(*search, budget), family=None)  # a family is functions: every process has it

    made = steps("optimise", found, searches)
    return tuple(replace(one, family=family) for one, (_, family, _) in zip(made, searches, strict=True))


def _optimised(task: Task, family: Family, seed: int, budget: Budget) -> Tuned:
    """Return what one search comes to."""
    from scipy.optimize import differential_evolution, minimize

    tried = Tries(task, family)
    bounds = list(zip(np.log(family.lower), np.log(family.upper), strict=True))
    found = differential_evolution(
        tried.costs,
        bounds,
        **first_members(task, family, seed, np.array(bounds).T, budget),
        popsize=budget.population,
        maxiter=budget.generations,
        tol=1e-4,
        polish=False,
        vectorized=True,
        updating="deferred",
        callback=tried.replaced_below,
        rng=np.random.default_rng(seed),
    )
    tried.most = np.inf
    local = minimize(
        lambda x: float(tried.costs(x[:, None])[0]),
        found.x,
        method="Nelder-Mead",
        bounds=bounds,
        options={"maxfev": budget.local, "xatol": 1e-3, "fatol": 1e-4, "initial_simplex": _simplex(found.x)},
    )
    best, value = (local.x, local.fun) if local.fun <= found.fun else (found.x, found.fun)
    trail = Trail.joined(tried.trails)
    return Tuned(family, np.exp(best), float(value), trail.time.size, seed, trail)


def first_members(
    task: Task, family: Family, seed: int, bounds: np.ndarray, budget: Budget = BUDGET
) -> dict[str, np.ndarray]:
    """Return how a search begins: evenly over the space, at the family's start and close about it. bounds (2, numbers):
    logarithms.

    Where the nominal axis is what counts, members lie close about the family's soft start: that optimum is narrow, and no even start
    finds it. Over the worst case it is none, since a soft arrival leaves millimetres or milliradians in some corner.
    """
    from scipy.stats import qmc

    start, draw = np.clip(np.log(family.start), *bounds), np.random.default_rng(seed)
    low, high = bounds
    even = low + (high - low) * qmc.LatinHypercube(start.size, rng=draw).random(budget.population * start.size)
    first = [start, np.log(family.soft)] if task.nominal and family.soft is not None else [start]
    made = [one + NEAR * np.vstack([0.0 * one, draw.standard_normal((budget.close - 1, one.size))]) for one in first]
    made = np.vstack([*made, even])[: len(even)]
    return {"init": np.clip(made, low, high)}


def _simplex(x: np.ndarray) -> np.ndarray:
    """A first simplex of 5 % steps around x (logarithms)."""
    return np.vstack([x, x + 0.05 * np.eye(x.size)])
