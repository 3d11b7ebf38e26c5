"""A closed drive's gains beside the scheduled PD: the same steps of each size, the worst over the task's scenarios."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from workbench.control import Controller
from workbench.drive_tuning.search import DriveGains, eased, steps_of
from workbench.simulation import Metrics, simulate


@dataclass(frozen=True)
class Arrived:
    """The worst over the scenarios. time: into 1 % of the step, s. error: at its end, rad or m. overshoot: share of it."""

    time: float
    error: float
    overshoot: float


@dataclass(frozen=True)
class Beside:
    """One size of move, rad or m. scheduled: the PD schedule, single: the drive with the last set alone, sets: with its own."""

    size: float
    scheduled: Arrived
    single: Arrived
    sets: Arrived


def _worst(metrics: Metrics, task, sizes: np.ndarray, lanes: int) -> list[Arrived]:
    """Return the worst of each size, `lanes` scenarios each."""
    m = eased(metrics, task, np.repeat(sizes, lanes))
    columns = (np.max(v.reshape(-1, lanes), axis=1) for v in (m.time_1pct, m.final_error, m.overshoot))
    return [Arrived(*map(float, row)) for row in zip(*columns, strict=True)]


def beside(gains: DriveGains, scheduled: Callable[[int], Controller]) -> tuple[Beside, ...]:
    """Run every size of move under all three, behind the same current loop. scheduled(lanes): the PD schedule."""
    scenarios, n = steps_of(gains.task, gains.sizes)
    last = np.repeat(gains.points[-1:], gains.sizes.size, axis=0)
    factories = (scheduled(scenarios.lanes), gains.controller(last, n), gains.controller(gains.points, n))
    found = [_worst(gains.task.run(c, scenarios), gains.task, gains.sizes, n) for c in factories]
    return tuple(Beside(float(s), *row) for s, *row in zip(gains.sizes, *found, strict=True))


def following(gains: DriveGains) -> tuple[float, float]:
    """Return the largest following error, rad or m, along a smooth move of the task's step, without and with feed-forward.

    The move has no jerk at its ends: s^4 (35 - 84 s + 70 s^2 - 20 s^3), in three times the time-optimal bound.
    """
    task = gains.task
    t = np.arange(int(round(task.duration / task.loop.sample_time)) + 1) * task.loop.sample_time
    s = np.clip(t / min(3.0 * task.bound(), 0.8 * task.duration), 0.0, 1.0)
    move = task.start + task.step * s**4 * (35.0 - 84.0 * s + 70.0 * s**2 - 20.0 * s**3)
    one = replace(task, load_inertias=task.load_inertias[:1], frictions=(1.0,), inertias=(1.0,)).scenarios(phases=1)
    found = []
    for fed in (False, True):
        run = simulate(task.plant, task.loop, gains.controller(gains.points[-1:], one.lanes, fed), one, task.duration, reference=move)  # fmt: skip
        found.append(float(run.following_error.max()))
    return found[0], found[1]
