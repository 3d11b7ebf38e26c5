"""The search for a gain table over the ladder: from stiff and soft arrivals, by an evolution strategy whose steps adapt.

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
    *,
    seeds: Sequence[int] = (1, 2, 3),
    generations: int = GENERATIONS,
    say: Callable[[str], None] = lambda _: None,
) -> Climbed:
    """Tune a table over the ladder from each start and seed; raise the references that it beats, and tune on.

    starts: the same family with other starts. fixed: a fixed PD's family and points (p, 2) for the references' first grid.
    """
    say("tuning a reference for each move alone")
    known = references(on, *fixed)
    say("tuning the gain table over all moves")
    first = [evolved(on, starts[(seed - 1) % len(starts)], known, seed, generations) for seed in seeds]
    best = min(first, key=lambda r: r.value)
    say("tuning the references again that it beats")
    known = raised(on, known, best.family, best.point)
    runs = [evolved(on, r.family, known, r.seed + 100, generations // 2, r.point) for r in first]
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
    on: Ladder, family: Family, known: References, seed: int, generations: int, start: np.ndarray | None = None
) -> Climb:
    """Return the best point that an evolution strategy finds from a start."""
    draw = np.random.default_rng(seed)
    point, width = (family.start if start is None else start).copy(), WIDTH if start is None else WIDTH / 4.0
    limit = on.task.weights.sensitivity * 1.001
    figures = climbed(on, family, point[None, :], all_rungs(on, point[None, :]))[0]
    value = float(cost(_of(on, figures, known))[0])
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
    return Climb(family, seed, point, value, figures, 1 + generations * OFFSPRING)
