"""The search for a gain table over the ladder: differential evolution about stiff and soft arrivals and the references' own gains,
then a local search about each run's best.

A ratio acts on a part of the ladder, so points are crossed and drawn to one of the best (current-to-pbest/1: Zhang and Sanderson 2009):
what is good for short steps comes together with what is good for long ones. The landscape is rugged, for the worst of many moves is
counted and an overshoot of more than two counts at once. Seeds differ; every run is kept, so that how far they part can be said.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from workbench.design.families.family import Family, OfFamily
from workbench.design.ladder import Ladder, all_rungs, climbed
from workbench.design.regret import References, Regret, climbed_below, cost, raised, references, regret
from workbench.keeping import kept
from workbench.processes import shared

Item, Run = TypeVar("Item"), TypeVar("Run")

NEAR = 0.35  # of the first members about a start, of a logarithm
BEST, CROSSED, FACTOR = 3, 0.9, (0.4, 0.9)  # how many are the best, share of numbers that cross, range of the step
# Of the local search: widths between two, every which step moves a share
# of the numbers together, and steps a generation. A ratio acts on steps of one size and on the last part of longer ones. Where steps are of few
# counts the landscape is so rugged that only many points find a good one, and there a point costs the least.
NARROW, WIDE, FAR, THIRD, OTHERS, STEPS = 0.01, 0.15, 2.0, 4, 0.3, 4
BEYOND = 100.0  # what a start costs that |S| forbids


@dataclass(frozen=True)
class Climbing:
    """Budget of a run. members: points of a generation; on the main study an evolution strategy of as many points from one best
    ended up to 12 % apart. offspring: points of a step of the local search; many: of one where a number touches few rungs, at most."""

    members: int = 16
    generations: int = 16
    offspring: int = 10
    many: int = 80


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
    runs = _side_by_side(
        lambda seed: _evolved(on, _begun(on, starts[0], seed, every, budget.members), known, generations),
        seeds, starts[0],
    )  # fmt: skip
    say("tuning the references again that it beats")
    known = raised(
        on, known, starts[0], *(np.concatenate([getattr(r, n) for r in runs]) for n in ("points", "figures"))
    )
    near = _side_by_side(
        lambda run: _refined(on, run.best(on, known), known, STEPS * generations, budget), runs, starts[0]
    )
    known = raised(on, known, starts[0], np.stack([r.point for r in near]), np.stack([r.figures for r in near]))
    values = [float(cost(regret(on, r.figures[None], known))[0]) for r in near]
    found = tuple(replace(near[i], value=values[i]) for i in np.argsort(values))
    return Climbed(on, found, known, regret(on, found[0].figures, known))


def _side_by_side(function: Callable[[Item], Run], items: Sequence[Item], family: Family) -> list[Run]:
    """Return function(item) of each item, a run of a family: a family is functions, and every process has it."""
    made = shared(lambda item: replace(function(item), family=None), items)
    return [replace(one, family=family) for one in made]


def _refined(on: Ladder, run: Climb, known: References, steps: int, budget: Climbing) -> Climb:
    """Return the best that a local search finds about a run's point: one number moved at a time, or all of them."""
    draw = np.random.default_rng(run.seed + 100)
    for k in range(steps):
        run = _jointly(on, run, known, draw, budget) if k % THIRD == THIRD - 1 else _alone(on, run, known, draw, budget)
    return run


def _width(draw: np.random.Generator) -> float:
    return NARROW + WIDE * draw.random() ** 1.5  # more often narrow than wide


def _jointly(on: Ladder, run: Climb, known: References, draw: np.random.Generator, budget: Climbing) -> Climb:
    """Move a share of the numbers together."""
    family, width = run.family, _width(draw)
    moved = width * np.where(draw.random((budget.offspring, run.point.size)) < OTHERS, 1.0, 0.0)
    moved *= draw.standard_normal(moved.shape)
    points = family.settled(np.clip(run.point * np.exp(moved), family.lower, family.upper))
    return _better(on, run, known, points, climbed_below(on, family, points, known, run.value))


def _alone(on: Ladder, run: Climb, known: References, draw: np.random.Generator, budget: Climbing) -> Climb:
    """Move one number; rungs that it does not touch are not climbed again, and the fewer it touches, the more points are tried."""
    family, j, width = run.family, int(draw.integers(run.point.size)), _width(draw)

    def away(by: np.ndarray) -> np.ndarray:
        points = np.tile(run.point, (by.size, 1))
        points[:, j] = np.clip(run.point[j] * np.exp(width * by), family.lower[j], family.upper[j])
        return family.settled(points)

    probe = away(np.array([-FAR, FAR]))  # what a lesser move touches, these touch
    seen = climbed(on, family, probe, all_rungs(on, probe))
    touched = np.flatnonzero((seen != run.figures).any(axis=(0, 2, 3)))
    run = _better(on, run, known, probe, seen)
    if not touched.size:
        return run
    points = away(
        np.clip(draw.standard_normal(min(budget.offspring * len(on.rungs) // touched.size, budget.many)), -FAR, FAR)
    )
    tried = climbed_below(on, family, points, known, run.value, touched, run.figures)
    return _better(on, run, known, points, tried)


def _better(on: Ladder, run: Climb, known: References, points: np.ndarray, tried: np.ndarray) -> Climb:
    """Return a run with the best of some points where that costs less. points (p, numbers), tried (p, rungs, 2, 3): their figures."""
    run = replace(run, evaluations=run.evaluations + len(points))
    beyond = run.family.sensitivity(points) > on.task.weights.sensitivity * 1.001
    costs = cost(regret(on, tried, known)) + np.where(beyond, BEYOND, 0.0)
    i = int(costs.argmin())
    return replace(run, point=points[i], value=float(costs[i]), figures=tried[i]) if costs[i] < run.value else run


def evolved(on: Ladder, family: Family, known: References, seed: int, budget: Climbing) -> Climb:
    """Return the best point of a family that a search from its own start finds."""
    return _evolved(on, _begun(on, family, seed, [family.start], budget.members), known, budget.generations).best(
        on, known
    )


def _begun(on: Ladder, family: Family, seed: int, starts: Sequence[np.ndarray], many: int) -> Members:
    """Return the first members: the starts (numbers,), and others about each of them."""
    draw = np.random.default_rng(seed)
    about = np.array([starts[k % len(starts)] for k in range(many)])
    away = (
        np.where(np.arange(many)[:, None] < len(starts), 0.0, NEAR) * family.about * draw.standard_normal(about.shape)
    )
    points = family.settled(np.clip(about * np.exp(away), family.lower, family.upper))
    return Members(family, seed, draw, points, climbed(on, family, points, all_rungs(on, points)), many)


def _evolved(on: Ladder, members: Members, known: References, generations: int) -> Members:
    """Return the members after so many generations; each gives way to what it is crossed to where that costs no more."""
    family, draw = members.family, members.draw
    points, figures = members.points.copy(), members.figures.copy()
    costs = members.costs(on, known)
    for _ in range(generations):
        tried = _crossed(family, draw, points, costs)
        new = replace(members, points=tried, figures=climbed_below(on, family, tried, known, costs))
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
