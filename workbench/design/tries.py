"""What a search tries on the simulated loop: points, met by the scenarios that cost most first, and only as far as they may still count."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from workbench.design.families.family import Family
from workbench.task.task import Task, cost, each, least

UNSTABLE = 10.0  # what an unstable linearisation counts as, of sensitivity over its limit
ROUNDED = 1.001  # by what a limit may be missed and still counts as kept
JUDGED = (
    "time_1pct",
    "final_error",
    "overshoot",
    "ripple",
)  # metrics that a cost is made of; none costs less than zero of each
# One of so many scenarios, those that cost members most, is met first. Half or twice as many take as long; of the main study's
# fixed PD, cascade and profile a fifth to a third of the lanes is spared; no result depends on it.
FIRST = 4


@dataclass(frozen=True, eq=False)
class Trail:
    """Every point that a search tried, arrays (n,): the worst 1 % time in s and final error in rad or m over the scenarios,
    whether the limits on overshoot, ripple and sensitivity were kept, and the cost."""

    time: np.ndarray
    error: np.ndarray
    kept: np.ndarray
    cost: np.ndarray

    @classmethod
    def joined(cls, trails: "Sequence[Trail]") -> "Trail":
        """Return several trails as one."""
        return cls(*(np.concatenate([getattr(t, n) for t in trails]) for n in ("time", "error", "kept", "cost")))

    def front(self) -> tuple[np.ndarray, np.ndarray]:
        """Return (time, error) of the points that keep the limits and that no other beats on both, by rising time."""
        ok = self.kept & np.isfinite(self.time) & np.isfinite(self.error)
        return _front(self.time[ok], self.error[ok])

    @classmethod
    def nothing(cls, least: np.ndarray) -> "Trail":
        """Return points of which only what they cost at least, (n,), is known."""
        return cls(
            np.full(least.shape, np.inf), np.full(least.shape, np.inf), np.zeros(least.shape, dtype=bool), least.copy()
        )

    def take(self, which: np.ndarray) -> "Trail":
        return Trail(*(values[which] for values in vars(self).values()))

    def with_points(self, which: np.ndarray, other: "Trail") -> "Trail":
        """Return the trail with another one's points in the places `which`."""
        made = {name: values.copy() for name, values in vars(self).items()}
        for name, values in vars(other).items():
            made[name][which] = values
        return Trail(**made)


class Tries:
    """The points of one search, and what each cost. most: what those that are tried next may cost, one or (points,).

    A cost is a worst case: what some scenarios cost is the least that all can. A point whose sensitivity alone, or whose first scenarios,
    cost more than `most` takes no member's place, and is not simulated further, unless it might be on the trail's front. Of it the trail
    holds the least that it can cost, and that it does not keep the limits. No result depends on it.
    """

    def __init__(self, task: Task, family: Family):
        self.task, self.family = task, family
        self.scenarios, self.bound, self.least = task.scenarios(), task.bound(), least(task)
        self.order = np.arange(self.scenarios.lanes)  # of the scenarios, what cost most before first
        self.trails: list[Trail] = []
        self.front = np.empty(0), np.empty(0)  # of all trails
        self.most: float | np.ndarray = np.inf

    def costs(self, logs: np.ndarray) -> np.ndarray:
        """Return what points cost, (points,); logs (numbers, points)."""
        points, w = np.exp(np.atleast_2d(logs.T)), self.task.weights
        most = np.broadcast_to(self.most, len(points))
        beyond = np.clip(self.family.sensitivity(points) / w.sensitivity - 1.0, 0.0, UNSTABLE)
        trail = Trail.nothing(self.least + w.steepness * beyond)
        run = np.flatnonzero(trail.cost <= most)
        if run.size:
            trail = trail.with_points(run, self._met(points[run], beyond[run], most[run]))
        self.trails.append(trail)
        times, errors = trail.front()
        self.front = _front(np.append(self.front[0], times), np.append(self.front[1], errors))
        return trail.cost.copy()

    def _met(self, points: np.ndarray, beyond: np.ndarray, most: np.ndarray) -> Trail:
        """Return what points gave, of those that were given up what they cost at least."""
        lanes = self.scenarios.lanes
        found = {name: np.zeros((len(points), lanes)) for name in JUDGED}
        first = lanes if np.isinf(most).all() else max(lanes // FIRST, 1)
        left = np.arange(len(points))
        self._run(points, left, self.order[:first], found)
        if first < lanes:
            so_far = self._judged(found, beyond)
            left = np.flatnonzero((so_far.cost <= most) | (so_far.kept & ~self._behind(so_far)))
            if left.size:
                self._run(points, left, self.order[first:], found)
        trail = self._judged(found, beyond)
        if left.size:
            self._learn({name: values[left] for name, values in found.items()}, trail.cost[left])
        if left.size == len(points):
            return trail
        return Trail.nothing(trail.cost).with_points(left, trail.take(left))

    def _run(self, points: np.ndarray, left: np.ndarray, which: np.ndarray, found: Mapping[str, np.ndarray]) -> None:
        """Put into found (points, scenarios) what the points `left` come to in the scenarios `which`."""
        controller = self.family.controller(points[left], which.size)
        metrics = self.task.run(controller, self.scenarios.taken(which).tiled(left.size))
        for name, values in found.items():
            values[np.ix_(left, which)] = getattr(metrics, name).reshape(left.size, which.size)

    def _judged(self, found: Mapping[str, np.ndarray], beyond: np.ndarray) -> Trail:
        """Return what points gave, as far as it was found; beyond: how far their sensitivity exceeds its limit."""
        w, worst = self.task.weights, {name: values.max(axis=1) for name, values in found.items()}
        metrics = SimpleNamespace(**{name: values.ravel() for name, values in found.items()})
        value = cost(self.task, metrics, self.bound, self.scenarios.lanes) + w.steepness * beyond
        fine = worst["overshoot"] <= w.overshoot * ROUNDED
        fine &= worst["ripple"] <= w.ripple * self.task.plant.limits.drive * ROUNDED
        return Trail(worst["time_1pct"], worst["final_error"], fine & (beyond <= ROUNDED - 1.0), value)

    def _behind(self, trail: Trail) -> np.ndarray:
        """Return whether a known point beats each on both time and error, or is as good."""
        times, errors = self.front
        before = np.searchsorted(times, trail.time, side="right")
        return np.append(np.inf, errors)[before] <= trail.error

    def _learn(self, found: Mapping[str, np.ndarray], costs: np.ndarray) -> None:
        """Order the scenarios by what they cost the better half of points that met them all."""
        better = np.argsort(costs, kind="stable")[: -(-len(costs) // 2)]
        metrics = SimpleNamespace(**{name: values[better].ravel() for name, values in found.items()})
        value, over, rough = each(self.task, metrics, self.bound)
        alone = (value + self.task.weights.steepness * over + rough).reshape(better.size, -1)
        self.order = np.argsort(-alone.mean(axis=0), kind="stable")

    def replaced_below(self, intermediate_result) -> None:
        """Hear after each generation what its members cost: the next one's trials take their places where they cost no more."""
        self.most = intermediate_result.population_energies.copy()


def _front(time: np.ndarray, error: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (time, error) of the points that no other beats on both, by rising time."""
    order = np.lexsort((error, time))
    time, error = time[order], error[order]
    least = np.concatenate([[np.inf], np.minimum.accumulate(error)[:-1]])
    return time[error < least], error[error < least]
