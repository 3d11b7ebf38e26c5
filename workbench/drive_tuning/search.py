"""Gains of a closed drive, one set a size of move, by the cost of every other controller on the same simulated loop.

Each set's search is an evolution strategy as `climb`'s; all sets are moved side by side, so that sixteen cost one run.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.description import Equivalent
from workbench.description.friction import friction_of
from workbench.drive_tuning.cases import Lagged, slowed
from workbench.drive_tuning.gains import NUMBERS, ClosedDrive, DriveGains, behind, sizes_of
from workbench.errors import WorkbenchError
from workbench.frequency import Response
from workbench.frequency.notch import Notch
from workbench.processes import shared
from workbench.simulation import Metrics, ScenarioArrays
from workbench.task.task import Task, cost
from workbench.threads import one_thread

COUNTS = 2.0  # of the encoder: what neither a band nor an overshoot is asked to be below, as on the ladder
WIDTH, GROW, SHRINK = (
    0.25,
    1.15,
    0.85,
)  # of the first steps, of a logarithm; with success and without (Rechenberg's rule)
INTEGRALS = (0.1, 1.0)  # of kv kvp: where ki sets out. From the first alone the longest moves cost half as much again
LATE = 8.0  # bounds that a move may take at most: a small one that settles late has to cost less than 10, which never settling does
HALVINGS = 20  # of the way down to gains that keep the sensitivity
SLOWEST = 1e-3  # of the gains that a start is slowed to, at most
REACH = 30.0  # factor on a start within which a set's numbers are searched


@dataclass(frozen=True)
class Strategy:
    """Budget of a search. offspring: points a set and generation; generations: of each stage, of two. Twice of them took 0.3 % off
    the cost of a harmonic drive, half left 8 % on it."""

    offspring: int = 6
    generations: int = 20


STRATEGY = Strategy()


def cases(
    task: Task, lag: float, equivalent: Equivalent, sizes: np.ndarray, notches: Sequence[Notch], measured: Response | None
) -> list[Lagged]:  # fmt: skip
    """Return the cases of each set: inertias and loads of the task, sliding, on the spring of that move and on the stiffest, at each friction."""
    _, inertia, viscous = friction_of(task.plant)
    masses = np.unique([f * inertia + m for f in (1.0, *task.inertias) for m in task.load_inertias])
    springs = np.interp(np.log(sizes), np.log(equivalent.amplitude), equivalent.stiffness)
    found, stiffest = [], float(equivalent.stiffness.max())  # where every move ends
    for spring in springs:
        beside = np.unique([0.0, *(f * k for f in (1.0, *task.frictions) for k in (spring, stiffest))])
        grid = np.meshgrid(masses, beside, indexing="ij")
        found.append(
            Lagged(task.loop, grid[0].ravel(), grid[1].ravel(), viscous, lag, tuple(notches), measured, float(spring))
        )
    return found


def steps_of(task: Task, sizes: np.ndarray) -> tuple[ScenarioArrays, int]:
    """Return (the task's scenarios for steps of each size, one size after another; how many a size)."""
    base = task.scenarios()
    n = base.lanes
    target = np.concatenate([np.broadcast_to(task.start + size + (base.target - task.start - task.step), n) for size in sizes])  # fmt: skip
    return replace(base.tiled(sizes.size), target=target), n


def eased(metrics: Metrics, task: Task, sizes: np.ndarray) -> Metrics:
    """Return metrics (lanes,) in which an overshoot of COUNTS counts or less is none."""
    over = np.where(metrics.overshoot * sizes <= COUNTS * task.loop.count, 0.0, metrics.overshoot)
    return replace(metrics, overshoot=over)


def _kept(judges: Sequence[Lagged], points: np.ndarray, limit: float) -> np.ndarray:
    """Return points (n, 3), each slowed as far as its own cases keep |S| within the limit."""
    out = points.copy()
    for i, judge in enumerate(judges):
        tried = slowed(points[i][None, :], np.geomspace(SLOWEST, 1.0, HALVINGS))
        fine = judge.sensitivity(tried) <= limit
        if not fine.any():
            raise WorkbenchError(
                f"no gains of the drive keep |S| below {limit:g}: not even the slowest of its cases. Give the drive a notch "
                "on the mode, a shorter current_lag or delay."
            )
        out[i] = tried[np.flatnonzero(fine)[-1]]
    return out


class Search:
    """The simulated steps of all sets, and their costs."""

    def __init__(self, gains: DriveGains, judges: Sequence[Lagged]):
        self.gains, self.judges, self.task = gains, judges, gains.task
        self.scenarios, self.lanes = steps_of(gains.task, gains.sizes)
        bounds = [replace(gains.task, step=float(s)).bound() for s in gains.sizes]
        self.bounds = np.maximum(bounds, gains.task.duration / LATE)
        self.tried = 0

    def values(self, points: np.ndarray) -> np.ndarray:
        """Return the costs (p, n) of points (p, n, 3), p of each set."""
        p, n, _ = points.shape
        scenarios = self.scenarios.tiled(p)
        run = self.task.run(self.gains.controller(points.reshape(-1, 3), self.lanes), scenarios)
        sizes = np.tile(np.repeat(self.gains.sizes, self.lanes), p)
        bounds = np.tile(np.repeat(self.bounds, self.lanes), p)
        found = cost(self.task, eased(run, self.task, sizes), bounds, self.lanes).reshape(p, n)
        self.tried += p * n
        w = self.task.weights
        peaks = np.stack([judge.sensitivity(points[:, i]) for i, judge in enumerate(self.judges)], axis=1)
        return found + w.steepness * np.clip(peaks / w.sensitivity - 1.0, 0.0, 10.0)


def _searched(search: Search, start: np.ndarray, low: np.ndarray, high: np.ndarray, seed: int, budget: Strategy) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Return (points (n, 3), costs (n,)) of the best that an evolution strategy a set finds from its start."""
    draw, points = np.random.default_rng(seed), start.copy()
    best, width = search.values(points[None])[0], np.full(len(start), WIDTH)
    for _ in range(budget.generations):
        steps = draw.standard_normal((budget.offspring, *start.shape)) * width[None, :, None]
        tried = np.clip(points * np.exp(steps), low, high)
        values = search.values(tried)
        i, each = values.argmin(axis=0), np.arange(len(start))
        better = values[i, each] < best
        points = np.where(better[:, None], tried[i, each], points)
        best, width = np.minimum(best, values[i, each]), width * np.where(better, GROW, SHRINK)
    return points, best


def _shared(search: Search, points: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return points (n, 3): for each set the best of all sets' points, as what one found may serve another."""
    n = len(points)
    tried = np.clip(np.broadcast_to(points[:, None, :], (n, n, 3)), low, high)
    return tried[search.values(tried).argmin(axis=0), np.arange(n)]


def _starts(
    closed: ClosedDrive, judges: Sequence[Lagged], kp: np.ndarray, kd: np.ndarray, limit: float
) -> tuple[list[np.ndarray], np.ndarray, np.ndarray]:
    """Return (starts (n, 3), lowest and highest points (n, 3)) of a search beside PD gains (n,), SI. limit: on |S|."""
    starts = [_kept(judges, np.stack([kp / kd, kd, share * kp], axis=1), 0.98 * limit) for share in INTEGRALS]
    low, high = np.maximum(closed.low, np.min(starts, axis=0) / REACH), np.minimum(closed.high, np.max(starts, axis=0) * REACH)  # fmt: skip
    if (low > high).any():
        name = NUMBERS[int(np.argmax((low > high).any(axis=0)))]
        raise WorkbenchError(f"the drive's range of {name} holds none of the gains that keep |S| below {limit:g}.")
    return starts, low, high


@one_thread
def tune_drive(
    closed: ClosedDrive,
    task: Task,
    equivalent: Equivalent,
    begin: tuple[np.ndarray, np.ndarray, np.ndarray],
    *,
    notches: Sequence[Notch] = (),
    measured: Response | None = None,
    seed: int = 1,
    budget: Strategy = STRATEGY,
) -> DriveGains:
    """Return the gains of a closed drive for the plant of a task.

    begin: (amplitude, kp, kd) (m,) of PD gains from whose neighbourhood the search sets out. notches: in the loop that is tuned.
    measured: a response that joins the cases. Raises WorkbenchError where no gains keep |S|, or the drive's ranges hold none.
    """
    own = behind(task, closed.lag)
    lag = closed.lag or next((e.parameters["time_constant"].value for e in own.plant.effects if e.name == "actuator_lag"), 0.0)  # fmt: skip
    sizes, (amplitude, kp, kd) = sizes_of(task, closed.sets), begin
    judges = cases(task, lag, equivalent, sizes, notches, measured)
    p, d = (np.exp(np.interp(np.log(sizes), np.log(amplitude), np.log(g))) for g in (kp, kd))
    starts, low, high = _starts(closed, judges, p, d, task.weights.sensitivity)
    _, inertia, _ = friction_of(task.plant)
    first = DriveGains(
        closed, own, sizes, starts[0], tuple(notches), np.zeros(sizes.size), np.zeros(sizes.size), 0,
        task.plant.limits.speed, float(closed.speed), inertia * closed.acceleration,
    )  # fmt: skip
    search = Search(first, judges)

    def run(i: int) -> tuple[np.ndarray, np.ndarray, int]:
        search.tried = 0
        return *_searched(search, np.clip(starts[i], low, high), low, high, seed + i, budget), search.tried

    runs = list(shared(run, range(len(starts))))
    search.tried = sum(r[2] for r in runs)
    which, each = np.argmin([r[1] for r in runs], axis=0), np.arange(sizes.size)
    best_of = np.stack([r[0] for r in runs])[which, each]
    points, best = _searched(search, _shared(search, best_of, low, high), low, high, seed + len(runs), budget)
    peaks = np.array([judge.sensitivity(points[i : i + 1])[0] for i, judge in enumerate(judges)])
    return replace(first, points=points, sensitivity=peaks, cost=best, tried=search.tried)
