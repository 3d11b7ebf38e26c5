"""The search for a gain table over the ladder: from stiff and soft arrivals, from the references' own gains and from points that
fill the space, by an evolution strategy whose steps adapt.

Each generation tries points about the best, half of them in a few numbers only: a ratio acts on a part of the ladder, so the
numbers nearly part, and a step in one of them is not spoilt by the others. The spread of the steps grows with success and
shrinks without (Rechenberg's rule). Starts and seeds differ; every run is kept, so that how far they part can be said.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.keeping import kept
from workbench.verification.families import Family, OfFamily
from workbench.verification.ladder import Ladder, all_rungs, climbed
from workbench.verification.regret import References, Regret, cost, raised, references, regret

OFFSPRING = 10  # points a generation
GENERATIONS = 24
WIDTH = 0.25  # of the first steps, of a logarithm
GROW, SHRINK = 1.15, 0.85
BEYOND = 100.0  # what a start costs that |S| forbids
ALONE = 0.3  # share of the numbers that every other generation moves


@dataclass(frozen=True, eq=False)
class Climb(OfFamily):
    """One run. point: its numbers. value: its cost. figures (rungs, 2, 3). evaluations: points tried."""

    family: Family
    seed: int
    point: np.ndarray
    value: float
    figures: np.ndarray
    evaluations: int = 0


@dataclass(frozen=True, eq=False)
class Climbed:
    """runs: every run, the best first. references: what no run beats. regret: of the best."""

    on: Ladder
    runs: tuple[Climb, ...]
    references: References
    regret: Regret

    @property
    def best(self) -> Climb:
        return self.runs[0]

    @property
    def spread(self) -> float:
        """The worst run's cost over the best one's."""
        return max(r.value for r in self.runs) / self.runs[0].value


@kept
def climb(
    on: Ladder,
    starts: Sequence[Family],
    fixed: tuple[Family, np.ndarray],
    informed: Callable[[References], Family] | None = None,
    *,
    seeds: Sequence[int] = (1, 2, 3),
    generations: int = GENERATIONS,
    say: Callable[[str], None] = lambda _: None,
) -> Climbed:
    """Tune a table over the ladder from each seed; raise the references that it beats, and tune on.

    starts: the same family with other starts, each of which every run tries. fixed: a fixed PD's family and points (p, numbers) for
    the references' first grid. informed: from these references to one more start.
    """
    say("tuning a reference for each move alone")
    known = references(on, *fixed)
    say("tuning the gain table over all moves")
    every = [*starts, *([informed(known)] if informed else [])]
    first = [evolved(on, starts[0], known, seed, generations, [f.start for f in every]) for seed in seeds]
    best = min(first, key=lambda r: r.value)
    say("tuning the references again that it beats")
    known = raised(on, known, best.family, best.point)
    runs = [evolved(on, r.family, known, r.seed + 100, generations // 2, [r.point], again=True) for r in first]
    best = min(runs, key=lambda r: r.value)
    known = raised(on, known, best.family, best.point)
    values = [float(cost(_of(on, r.figures, known))[0]) for r in runs]
    order = np.argsort(values)
    kept = tuple(replace(runs[i], seed=first[i].seed, value=values[i]) for i in order)
    return Climbed(on, kept, known, regret(on, kept[0].figures, known))


def _of(on: Ladder, figures: np.ndarray, known: References) -> Regret:
    """Return the regret of one point's figures (rungs, 2, 3), with a leading axis."""
    return regret(on, figures[None], known)


def evolved(
    on: Ladder, family: Family, known: References, seed: int, generations: int, starts: Sequence[np.ndarray] = (),
    again: bool = False,
) -> Climb:  # fmt: skip
    """Return the best point that an evolution strategy finds from the best of starts (numbers,) and, unless it goes on from these
    (again), as many points as a generation has that fill the space."""
    draw = np.random.default_rng(seed)
    width, limit = WIDTH / 4.0 if again else WIDTH, on.task.weights.sensitivity * 1.001
    points = _first(family, draw, starts or (family.start,), 0 if again else OFFSPRING)
    tried = climbed(on, family, points, all_rungs(on, points))
    costs = cost(regret(on, tried, known)) + np.where(family.sensitivity(points) > limit, BEYOND, 0.0)
    i = int(costs.argmin())
    point, value, figures = points[i], float(costs[i]), tried[i]
    for generation in range(generations):
        steps = width * draw.standard_normal((OFFSPRING, point.size))
        if generation % 2:
            steps = np.where(draw.random(steps.shape) < ALONE, steps, 0.0)
        points = family.settled(np.clip(point * np.exp(steps), family.lower, family.upper))
        points = points[family.sensitivity(points) <= limit]
        if not len(points):
            width *= SHRINK
            continue
        tried = climbed(on, family, points, all_rungs(on, points))
        costs = cost(regret(on, tried, known))
        i = int(costs.argmin())
        better = costs[i] < value
        width *= GROW if better else SHRINK
        if better:
            point, value, figures = points[i], float(costs[i]), tried[i]
    return Climb(family, seed, point, value, figures, len(costs) + generations * OFFSPRING)


def _first(family: Family, draw: np.random.Generator, starts: Sequence[np.ndarray], count: int) -> np.ndarray:
    """Return starts and `count` points of a Latin hypercube over the logarithms of a family's range, (n, numbers)."""
    from scipy.stats import qmc

    low, high = np.log(family.lower), np.log(family.upper)
    even = np.exp(low + (high - low) * qmc.LatinHypercube(low.size, rng=draw).random(count)) if count else []
    return family.settled(np.clip(np.array([*starts, *even]), family.lower, family.upper))
