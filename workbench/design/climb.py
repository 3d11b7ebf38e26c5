"""The search for a gain table over the ladder: differential evolution about stiff and soft arrivals and the references' own gains,
then a local search about each run's best.

A ratio acts on a part of the ladder, so points are crossed and drawn to one of the best (current-to-pbest/1: Zhang and Sanderson 2009):
what is good for short steps comes together with what is good for long ones. The landscape is rugged, for the worst of many moves is
counted and an overshoot of more than two counts at once. Seeds differ; every run is kept, so that how far they part can be said.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.design.families.family import Family, OfFamily
from workbench.design.ladder import Ladder, all_rungs, climbed
from workbench.design.regret import References, Regret, cost, raised, references, regret
from workbench.keeping import kept

NEAR = 0.35  # of the first members about a start, of a logarithm
BEST, CROSSED, FACTOR = 3, 0.9, (0.4, 0.9)  # how many are the best, share of numbers that cross, range of the step
# Of the local search: its first width, what that grows by with success and shrinks by without (Rechenberg's rule), and the
# share of the numbers that every other step moves. On the main study it takes 4 % off the best run's cost.
WIDTH, GROW, SHRINK, ALONE = 0.06, 1.15, 0.85, 0.3
BEYOND = 100.0  # what a start costs that |S| forbids


@dataclass(frozen=True)
class Climbing:
    """Budget of a run. members: points of a generation; on the main study an evolution strategy of as many points from one best
    ended up to 12 % apart. offspring: points of a step of the local search."""

    members: int = 16
    generations: int = 24
    offspring: int = 10


CLIMBING = Climbing()


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
class Members:
    """A population of one run. draw: its random numbers. points (members, numbers), figures (members, rungs, 2, 3)."""

    family: Family
    seed: int
    draw: np.random.Generator
    points: np.ndarray
    figures: np.ndarray
    evaluations: int

    def costs(self, on: Ladder, known: References) -> np.ndarray:
        """Return what each member costs against references, (members,)."""
        beyond = self.family.sensitivity(self.points) > on.task.weights.sensitivity * 1.001
        return cost(regret(on, self.figures, known)) + np.where(beyond, BEYOND, 0.0)

    def best(self, on: Ladder, known: References) -> Climb:
        costs = self.costs(on, known)
        i = int(costs.argmin())
        return Climb(self.family, self.seed, self.points[i], float(costs[i]), self.figures[i], self.evaluations)


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
    budget: Climbing = CLIMBING,
    say: Callable[[str], None] = lambda _: None,
) -> Climbed:
    """Tune a table over the ladder from each seed; raise the references that it beats, and tune on.

    starts: the same family with other starts, about each of which every run begins. fixed: a fixed PD's family and points (p, numbers) for
    the references' first grid. informed: from these references to one more start.
    """
    say("tuning a reference for each move alone")
    known = references(on, *fixed)
    say("tuning the gain table over all moves")
    every = [f.start for f in (*starts, *([informed(known)] if informed else []))]
    generations = budget.generations
    runs = [_evolved(on, _begun(on, starts[0], seed, every, budget.members), known, generations) for seed in seeds]
    say("tuning the references again that it beats")
    known = _raised(on, known, [r.best(on, known) for r in runs])
    runs = [_evolved(on, r, known, generations // 2) for r in runs]
    near = [_refined(on, r.best(on, known), known, 2 * generations // 3, budget.offspring) for r in runs]
    known = _raised(on, known, near)
    values = [float(cost(regret(on, r.figures[None], known))[0]) for r in near]
    found = tuple(replace(near[i], value=values[i]) for i in np.argsort(values))
    return Climbed(on, found, known, regret(on, found[0].figures, known))


def _raised(on: Ladder, known: References, runs: Sequence[Climb]) -> References:
    """Return references that the best of some runs does not beat."""
    best = min(runs, key=lambda r: r.value)
    return raised(on, known, best.family, best.point)


def _refined(on: Ladder, run: Climb, known: References, steps: int, offspring: int) -> Climb:
    """Return the best that a local search finds about a run's point."""
    draw, family, width = np.random.default_rng(run.seed + 100), run.family, WIDTH
    limit = on.task.weights.sensitivity * 1.001
    for k in range(steps):
        moved = width * draw.standard_normal((offspring, run.point.size))
        if k % 2:
            moved = np.where(draw.random(moved.shape) < ALONE, moved, 0.0)
        points = family.settled(np.clip(run.point * np.exp(moved), family.lower, family.upper))
        tried = climbed(on, family, points, all_rungs(on, points))
        costs = cost(regret(on, tried, known)) + np.where(family.sensitivity(points) > limit, BEYOND, 0.0)
        i = int(costs.argmin())
        better = costs[i] < run.value
        width *= GROW if better else SHRINK
        run = replace(run, point=points[i], value=float(costs[i]), figures=tried[i]) if better else run
    return replace(run, evaluations=run.evaluations + steps * offspring)


def evolved(on: Ladder, family: Family, known: References, seed: int, budget: Climbing) -> Climb:
    """Return the best point of a family that a search from its own start finds."""
    return _evolved(on, _begun(on, family, seed, [family.start], budget.members), known, budget.generations).best(
        on, known
    )


def _begun(on: Ladder, family: Family, seed: int, starts: Sequence[np.ndarray], many: int) -> Members:
    """Return the first members: the starts (numbers,), and others about each of them."""
    draw = np.random.default_rng(seed)
    about = np.array([starts[k % len(starts)] for k in range(many)])
    away = np.where(np.arange(many)[:, None] < len(starts), 0.0, NEAR) * draw.standard_normal(about.shape)
    points = family.settled(np.clip(about * np.exp(away), family.lower, family.upper))
    return Members(family, seed, draw, points, climbed(on, family, points, all_rungs(on, points)), many)


def _evolved(on: Ladder, members: Members, known: References, generations: int) -> Members:
    """Return the members after so many generations; each gives way to what it is crossed to where that costs no more."""
    family, draw = members.family, members.draw
    points, figures = members.points.copy(), members.figures.copy()
    costs = members.costs(on, known)
    for _ in range(generations):
        tried = _crossed(family, draw, points, costs)
        new = replace(members, points=tried, figures=climbed(on, family, tried, all_rungs(on, tried)))
        price = new.costs(on, known)
        ok = price <= costs
        points[ok], figures[ok], costs[ok] = tried[ok], new.figures[ok], price[ok]
    return replace(members, points=points, figures=figures, evaluations=members.evaluations + generations * len(points))


def _crossed(family: Family, draw: np.random.Generator, points: np.ndarray, costs: np.ndarray) -> np.ndarray:
    """Return a trial of each member: drawn towards one of the BEST, moved by the difference of two others, and crossed with itself."""
    logs, (count, numbers) = np.log(points), points.shape
    step = draw.uniform(*FACTOR, (count, 1))
    towards = logs[costs.argsort()[draw.integers(0, BEST, count)]]
    others = np.array([draw.choice(np.delete(np.arange(count), i), 2, replace=False) for i in range(count)])
    moved = logs + step * (towards - logs) + step * (logs[others[:, 0]] - logs[others[:, 1]])
    own = draw.random(points.shape) < CROSSED
    own[np.arange(count), draw.integers(0, numbers, count)] = True
    return family.settled(np.clip(np.exp(np.where(own, moved, logs)), family.lower, family.upper))
