"""The search for a gain table over the ladder: differential evolution about stiff and soft arrivals and the references' own gains,
then a local search about each run's best.

A ratio acts on a part of the ladder, so points are crossed and drawn to one of the best (current-to-pbest/1: Zhang and Sanderson 2009):
what is good for short steps comes together with what is good for long ones. The landscape is rugged, for the worst of many moves is
counted and an overshoot of more than two counts at once. Seeds differ; every run is kept, so that how far they part can be said.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from workbench.design.against import Against, Tried
from workbench.design.families.family import Family, OfFamily
from workbench.design.ladder import Ladder
from workbench.design.regret import References, Regret, raised, references, regret
from workbench.keeping import kept
from workbench.processes import shared

NEAR = 0.35  # of the first members about a start, of a logarithm
BEST, CROSSED, FACTOR = 3, 0.9, (0.4, 0.9)  # how many are the best, share of numbers that cross, range of the step
# Members a number of a family that has few, and at least. Of three searches of the main study's two-level switch (four numbers) with twelve members, of
# its fixed gains (two) with eight, the worst ends within 3 and 5 % of the best with 24, in half the time; with half as many in 26 and 170 %.
A_NUMBER, LEAST = 3, 12
# Of the local search: widths between two, and every which step moves a share of the numbers together. A ratio acts on steps of one size
# and on the last part of longer ones. Where steps are of few counts the landscape is so rugged that only many points find a good one,
# and there a point costs the least.
NARROW, WIDE, FAR, THIRD, OTHERS = 0.01, 0.15, 2.0, 4, 0.3


@dataclass(frozen=True)
class Climbing:
    """Budget of a run. members: points of a generation; on the main study an evolution strategy of as many points from one best
    ended up to 12 % apart. landings: a generation meets one of so many. steps: of the local search, which meets all; offspring: points of one, many:
    where a number touches few rungs, at most.

    Of twelve numbers: with 16 members and generations and 64 steps six runs of the main study end 11 % apart, and with twice the steps or
    the generations no nearer; with 24 members, 28 generations and 22 or 44 steps 2 to 3 %. With 44 instead of 22 steps a search takes a quarter
    longer, and four runs of the main study end 0.3 % cheaper in the mean, four of the single mass 0.4 % dearer."""

    members: int = 24
    generations: int = 28
    landings: int = 4
    steps: int = 22
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
class Run:
    """Where a search is. point (numbers,), figures (rungs, 2, 3), value: its best. touches: number -> rungs that it was seen to touch."""

    seed: int
    point: np.ndarray
    figures: np.ndarray
    value: float
    evaluations: int
    touches: Mapping[int, np.ndarray] = field(default_factory=dict)

    def with_tried(self, tried: Tried) -> "Run":
        """Return the run with the best of what was tried, where that costs less."""
        i, more = int(tried.costs.argmin()), self.evaluations + len(tried.points)
        if tried.costs[i] >= self.value:
            return replace(self, evaluations=more)
        return replace(self, point=tried.points[i], figures=tried.figures[i], value=float(tried.costs[i]), evaluations=more)  # fmt: skip

    def of(self, family: Family) -> Climb:
        return Climb(family, self.seed, self.point, self.value, self.figures, self.evaluations)


@dataclass(frozen=True, eq=False)
class Climbed:
    """runs: every run, first what costs least at landings that no search knew. references: what no run beats. regret: of that one."""

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
        return max(r.value for r in self.runs) / min(r.value for r in self.runs)


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
    against = Against(on, starts[0], references(on, *fixed))
    say("tuning the gain table over all moves")
    every = [f.start for f in (*starts, *([informed(against.known)] if informed else []))]
    runs = list(shared(lambda seed: _evolved(against, seed, every, budget), seeds))
    say("tuning the references again that it beats")
    against = _raised(against, runs)
    near = list(shared(lambda run: _refined(against, run, budget), _priced(against, runs)))
    against = _raised(against, near)
    elsewhere = replace(against, on=on.elsewhere)
    points = np.array([run.point for run in near])
    order = elsewhere.tried(points).costs.argsort(kind="stable")
    found = [_priced(against, near)[k] for k in order]
    return Climbed(
        on,
        tuple(r.of(starts[0]) for r in found),
        against.known,
        regret(on, found[0].figures, against.known),
    )


def _raised(against: Against, runs: Sequence[Run]) -> Against:
    """Return references that no best point of some runs beats."""
    points, figures = (np.stack([getattr(r, n) for r in runs]) for n in ("point", "figures"))
    return replace(against, known=raised(against.on, against.known, against.family, points, figures))


def _priced(against: Against, runs: Sequence[Run]) -> list[Run]:
    """Return runs with what they cost against other references."""
    return [replace(r, value=float(against.costs(r.point[None], r.figures[None])[0])) for r in runs]


def evolved(on: Ladder, family: Family, known: References, seed: int, budget: Climbing) -> Climb:
    """Return the best point of a family that a search from its own start finds; where it has few numbers, with fewer members."""
    members = min(budget.members, max(A_NUMBER * len(family.numbers), LEAST))
    whole = replace(budget, members=members, landings=1)  # no local search comes behind it
    return _evolved(Against(on, family, known), seed, [family.start], whole).of(family)


def _evolved(against: Against, seed: int, starts: Sequence[np.ndarray], budget: Climbing) -> Run:
    """Return the best of a population about the starts (numbers,); each member gives way to what it is crossed to where that costs no more.

    The members meet one of `budget.landings` of a step's landings, and which of them is the best all landings say."""
    draw = np.random.default_rng(seed)
    fewer = replace(against, on=against.on.at_landings(budget.landings))
    begun = fewer.tried(_about(against.family, draw, starts, budget.members))
    points, figures, costs = begun.points.copy(), begun.figures.copy(), begun.costs.copy()
    for _ in range(budget.generations):
        tried = fewer.tried(_crossed(against.family, draw, points, costs), costs, figures)
        ok = tried.costs <= costs
        points[ok], figures[ok], costs[ok] = tried.points[ok], tried.figures[ok], tried.costs[ok]
    met = against.tried(points)
    i = int(met.costs.argmin())
    return Run(seed, points[i], met.figures[i], float(met.costs[i]), budget.members * (2 + budget.generations))


def _about(family: Family, draw: np.random.Generator, starts: Sequence[np.ndarray], many: int) -> np.ndarray:
    """Return the first members (many, numbers): the starts, and others about each of them."""
    about = np.array([starts[k % len(starts)] for k in range(many)])
    away = (
        np.where(np.arange(many)[:, None] < len(starts), 0.0, NEAR) * family.about * draw.standard_normal(about.shape)
    )
    return family.settled(np.clip(about * np.exp(away), family.lower, family.upper))


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


def _refined(against: Against, run: Run, budget: Climbing) -> Run:
    """Return the best that a local search finds about a run's point: one number moved at a time, or all of them."""
    draw = np.random.default_rng(run.seed + 100)
    for k in range(budget.steps):
        width = NARROW + WIDE * draw.random() ** 1.5  # more often narrow than wide
        move = _jointly if k % THIRD == THIRD - 1 else _alone
        run = move(against, run, draw, width, budget)
    return run


def _jointly(against: Against, run: Run, draw: np.random.Generator, width: float, budget: Climbing) -> Run:
    """Move a share of the numbers together."""
    moved = width * np.where(draw.random((budget.offspring, run.point.size)) < OTHERS, 1.0, 0.0)
    return run.with_tried(
        against.tried(
            _moved(against.family, run.point, moved * draw.standard_normal(moved.shape)), run.value, run.figures[None]
        )
    )


def _alone(against: Against, run: Run, draw: np.random.Generator, width: float, budget: Climbing) -> Run:
    """Move one number. Only rungs that it was seen to touch are climbed, and the fewer these are, the more points are tried; what is then
    better is climbed as a whole, so that no figure is assumed."""
    j = int(draw.integers(run.point.size))
    along = np.eye(run.point.size)[j] * width
    if j not in run.touches:  # what a lesser move touches, these touch
        probe = against.tried(_moved(against.family, run.point, along * np.array([[-FAR], [FAR]])))
        run = _seen(run, j, probe.figures).with_tried(probe)
    touched = run.touches[j]
    if not touched.size:
        return run
    many = min(budget.offspring * len(against.on.rungs) // touched.size, budget.many)
    by = np.clip(draw.standard_normal(many), -FAR, FAR)[:, None]
    tried = against.tried(_moved(against.family, run.point, along * by), run.value, run.figures[None], touched)
    i = int(tried.costs.argmin())
    run = replace(run, evaluations=run.evaluations + many)
    if tried.costs[i] >= run.value:
        return run
    best = against.tried(tried.points[i : i + 1])
    return _seen(run, j, best.figures).with_tried(best)


def _moved(family: Family, point: np.ndarray, by: np.ndarray) -> np.ndarray:
    """Return points (p, numbers) that lie by logarithms (p, numbers) beside one."""
    return family.settled(np.clip(point * np.exp(by), family.lower, family.upper))


def _seen(run: Run, j: int, figures: np.ndarray) -> Run:
    """Return a run that knows of number j which rungs it touches, where points that it was moved to have figures (p, rungs, 2, 3)."""
    touched = np.flatnonzero((figures != run.figures).any(axis=(0, 2, 3)))
    known = run.touches.get(j, touched)
    return replace(run, touches={**run.touches, j: np.union1d(known, touched)})
