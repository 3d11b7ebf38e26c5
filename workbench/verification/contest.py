"""A contest of controllers: each tuned by the same search, from several seeds, on the same scenarios; or stated, as it is.

What a controller does is judged without load, with load, and over a grid of inertia and friction that its plant may have.
Medians over the seeds stand for it; the spread is kept.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.control import Controller
from workbench.design.families.family import Family
from workbench.design.optimise import BUDGET, SEEDS, Budget, Seeded, optimise_all, optimise_seeds
from workbench.keeping import kept
from workbench.plant import Plant
from workbench.simulation import Metrics
from workbench.task.task import PHASES, Task
from workbench.verification.compare import LEVEL, side

Factory = Callable[[int], Controller]


@dataclass(frozen=True, eq=False)
class Result:
    """What one controller does. values: figure -> (runs,), one a seed, SI:

    time, error, overshoot: without load, the worst of PHASES encoder phases; time_loaded, error_loaded: with it; time_grid,
    error_grid, overshoot_grid: the worst over the grid; error_spread: largest less smallest error over the grid;
    sensitivity: the largest over the linearisations; cost: of tuning. tuned: absent where the controller was stated.
    """

    name: str
    values: Mapping[str, np.ndarray]
    factories: tuple[Factory, ...]
    tuned: Seeded | None = None

    def median(self, figure: str) -> float:
        """The median over seeds."""
        return float(np.median(self.values[figure]))

    def span(self, figure: str) -> tuple[float, float]:
        """(smallest, largest) over seeds."""
        return float(np.min(self.values[figure])), float(np.max(self.values[figure]))

    def of_seed(self, seed: int) -> dict[str, np.ndarray] | None:
        """Return the figures as judged, (1,) each, of the search from one seed; None where there was none."""
        seeds = [r.seed for r in self.tuned.runs] if self.tuned else []
        if seed not in seeds:
            return None
        own = {k: v[[seeds.index(seed)]] for k, v in self.values.items()}
        return {k: v for k, v in own.items() if k not in ("sensitivity", "cost")}

    @property
    def factory(self) -> Factory:
        """The controller that stands for all: of the seed with the middling cost."""
        return self.factories[0] if self.tuned is None else self.factories[self.tuned.runs.index(self.tuned.median)]


@dataclass(frozen=True, eq=False)
class Contest:
    """standings: by name, in order. bound, bound_loaded: time-optimal 1 % times, s. task: by which they were judged."""

    task: Task
    standings: Mapping[str, Result]
    bound: float
    bound_loaded: float

    def __getitem__(self, name: str) -> Result:
        return self.standings[name]

    @property
    def factories(self) -> dict[str, Factory]:
        """Name -> factory of the controller that stands for it."""
        return {n: s.factory for n, s in self.standings.items()}

    def over_bound(self, name: str) -> float:
        """Median 1 % time without load over the bound."""
        return self[name].median("time") / self.bound


def contest(
    task: Task,
    families: Sequence[Family],
    stated: Mapping[str, Factory] | None = None,
    *,
    tuning_time: float,
    seeds: Sequence[int] = SEEDS,
    budget: Budget = BUDGET,
    loaded: bool = False,
    known: Plant | None = None,
    say: Callable[[str], None] = lambda _: None,
) -> Contest:
    """Tune every family from every seed on the grid of `task` (its frictions and inertias), and judge it with the stated ones.

    budget: of each search. known: the plant that is tuned for, where it is not the task's own, which judges. tuning_time: duration of a simulation while tuning, s. The task's load inertias are none, then the load; tuning meets
    the load where `loaded`.
    """
    loads = task.load_inertias if loaded else task.load_inertias[:1]
    training = replace(task, load_inertias=loads, duration=tuning_time).on(known or task.plant)
    standings = {}
    say(f"tuning {len(families)} controllers from {len(seeds)} seeds each")
    runs = optimise_all([(training, family, seed) for seed in seeds for family in families], budget)
    for family in families:
        tuned = Seeded(tuple(r for r in runs if r.family is family))
        standings[family.name] = _standing(task, family.name, tuned)
    for name, factory in (stated or {}).items():
        standings[name] = Result(name, judged(task, (factory,)), (factory,))
    loads = task.load_inertias
    return Contest(task, standings, task.bound(loads[0]), task.bound(loads[-1]))


@kept
def entered(
    task: Task,
    training: Task,
    family: Family,
    seeds: Sequence[int] = SEEDS,
    name: str = "",
    budget: Budget = BUDGET,
) -> Result:
    """Tune a family from every seed on the scenarios of `training`, and judge it on `task`. name: the family's where empty."""
    return _standing(task, name or family.name, optimise_seeds(training, family, seeds, budget))


def _standing(task: Task, name: str, tuned: Seeded) -> Result:
    """Judge the runs of a family on `task`."""
    factories = tuple(run.controller for run in tuned.runs)
    values = judged(task, factories) | {
        "sensitivity": np.array([float(r.family.sensitivity(r.point[None, :])[0]) for r in tuned.runs]),
        "cost": np.array([r.value for r in tuned.runs]),
    }
    return Result(name, values, factories, tuned)


@kept
def judged(task: Task, factories: Sequence[Factory]) -> dict[str, np.ndarray]:
    """Return figure -> (runs,) of controllers; see Result."""
    rows = [
        {
            **_named(_nominal(task, factory, task.load_inertias[0]), "", ("time", "error", "overshoot")),
            **_named(_nominal(task, factory, task.load_inertias[-1]), "_loaded", ("time", "error")),
            **_over_grid(task, factory),
        }
        for factory in factories
    ]
    return {n: np.array([row[n] for row in rows]) for n in rows[0]}


def _nominal(task: Task, factory: Factory, load: float) -> Metrics:
    """Run the nominal plant with one load at PHASES encoder phases."""
    scenarios = task.scenarios(load_inertias=(load,), frictions=(1.0,), inertias=(1.0,), phases=PHASES)
    return task.run(factory(scenarios.lanes), scenarios)


def _named(metrics: Metrics, suffix: str, names: Sequence[str]) -> dict[str, float]:
    """Worst values of metrics by the names that a standing has."""
    worst = {"time": metrics.time_1pct, "error": metrics.final_error, "overshoot": metrics.overshoot}
    return {f"{n}{suffix}": float(np.max(worst[n])) for n in names}


def _over_grid(task: Task, factory: Factory) -> dict[str, float]:
    """Return the worst over the task's grid of frictions and inertias without load, at three phases a point."""
    scenarios = task.scenarios(load_inertias=task.load_inertias[:1], phases=3)
    metrics = task.run(factory(scenarios.lanes), scenarios)
    spread = float(np.ptp(metrics.final_error)) if np.isfinite(metrics.final_error).all() else float("inf")
    return _named(metrics, "_grid", ("time", "error", "overshoot")) | {"error_spread": spread}


def sides(ours: Result, other: Result, where: str = "") -> tuple[int, int]:
    """Return (time, error): 1 where ours is better by more than compare.LEVEL, -1 where it is worse, else 0.

    where: "" for the nominal plant, "_loaded" or "_grid".
    """
    time, error = (side(ours.median(f"{n}{where}"), other.median(f"{n}{where}"), LEVEL[n]) for n in ("time", "error"))
    return time, error


def as_table(found: Contest) -> list[dict]:
    """Every controller as results.json holds it: figures of every seed, and the numbers of the one that stands for them."""
    return [
        {
            "controller": n,
            "figures": {k: list(v) for k, v in s.values.items()},
            "numbers": s.tuned.median.numbers if s.tuned else {},
            "seeds": [r.seed for r in s.tuned.runs] if s.tuned else [],
            "front": [list(v) for v in s.tuned.trail.front()] if s.tuned else [],
        }
        for n, s in found.standings.items()
    ]
