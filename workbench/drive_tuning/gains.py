"""What a closed drive is, and what gains it has: one set a size of move."""

from dataclasses import dataclass

import numpy as np

from workbench.control import Controller, drive_cascade
from workbench.effects.command import actuator_lag
from workbench.errors import WorkbenchError
from workbench.frequency.notch import Notch
from workbench.task.task import Task

NUMBERS = ("kv", "kvp", "ki")
LEAST = 200.0  # counts of the smallest move that has a set: 1 % of a smaller one is less than `search.COUNTS`


@dataclass(frozen=True, eq=False)
class ClosedDrive:
    """What a study states of a drive. lag: of its current loop, s. notches: how many it has; sets: of gains.

    speed, acceleration: whether it feeds the reference's speed and acceleration forward. low, high (3,): of kv, kvp, ki, SI.
    """

    lag: float
    notches: int = 0
    sets: int = 1
    speed: bool = False
    acceleration: bool = False
    low: tuple[float, float, float] = (0.0, 0.0, 0.0)
    high: tuple[float, float, float] = (np.inf, np.inf, np.inf)


@dataclass(frozen=True, eq=False)
class DriveGains:
    """sizes (n,): the move of each set, rad or m, the last the task's. points (n, 3): kv, kvp, ki. notches: of every set.

    sensitivity (n,): Ms over the cases, and cost (n,). tried: simulated steps. speed_limit: rad/s or m/s. forward, mass: feed-forward.
    """

    closed: ClosedDrive
    task: Task
    sizes: np.ndarray
    points: np.ndarray
    notches: tuple[Notch, ...]
    sensitivity: np.ndarray
    cost: np.ndarray
    tried: int
    speed_limit: float
    forward: float
    mass: float

    def controller(self, points: np.ndarray, lanes: int = 1, fed: bool = True) -> Controller:
        """Return the controller of points (p, 3), each in `lanes` scenarios."""
        kv, kvp, ki = np.repeat(points, lanes, axis=0).T
        return drive_cascade(
            kv, kvp, ki, self.speed_limit, sample_time=self.task.loop.sample_time, notches=self.notches,
            forward=self.forward * fed, mass=self.mass * fed,
        )  # fmt: skip


def behind(task: Task, lag: float) -> Task:
    """Return the task with the drive's current loop before the plant; WorkbenchError where the plant has one already."""
    if "actuator_lag" in task.plant:
        if lag:
            raise WorkbenchError(
                "the plant has an actuator_lag already, as it was identified; leave the drive's current_lag out."
            )
        return task
    return task.on(task.plant + actuator_lag()(time_constant=lag)) if lag else task


def sizes_of(task: Task, sets: int) -> np.ndarray:
    """Return the sizes of moves that sets of gains are for, even in the logarithm, the task's own last."""
    least = min(LEAST * task.loop.count or 1e-3 * task.step, 0.5 * task.step)
    return np.array([task.step]) if sets == 1 else np.geomspace(least, task.step, sets)
