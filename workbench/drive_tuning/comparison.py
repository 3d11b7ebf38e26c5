"""A closed drive's gains beside the scheduled PD: the same steps of each size, the worst over the task's scenarios."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.checking.modes import all_resonances
from workbench.control import Controller
from workbench.description import Equivalent
from workbench.drive_tuning.gains import NUMBERS, ClosedDrive, DriveGains
from workbench.drive_tuning.search import STRATEGY, Strategy, eased, steps_of, tune_drive
from workbench.frequency import Response
from workbench.frequency.notch import Notch, notch_for
from workbench.plant import Plant
from workbench.record import Record
from workbench.simulation import Metrics, simulate
from workbench.task.task import Task
from workbench.tuning import Gains


@dataclass(frozen=True)
class Arrived:
    """The worst over the scenarios. time: into 1 % of the step, s. error: at its end, rad or m. overshoot: share of it."""

    time: float
    error: float
    overshoot: float


@dataclass(frozen=True)
class SizeComparison:
    """One size of move, rad or m. scheduled: the PD schedule, single: the drive with the last set alone, sets: with its own."""

    size: float
    scheduled: Arrived
    single: Arrived
    sets: Arrived


@dataclass(frozen=True, eq=False)
class ComparedDrive:
    """gains: of the drive. sizes: of each size of move, the task's last. following: largest following error of a smooth move, rad or
    m, without and with feed-forward."""

    gains: DriveGains
    sizes: tuple[SizeComparison, ...]
    following: tuple[float, float]

    @property
    def figures(self) -> dict[str, float]:
        """Figures by which a drive may be judged, SI."""
        last = self.sizes[-1].sets
        return {
            "drive_sensitivity_peak": float(self.gains.sensitivity.max()),
            "drive_final_error": last.error,
            "drive_following_error": self.following[1],
            "drive_step_time": last.time,
        }

    @property
    def as_dict(self) -> dict[str, object]:
        """The drive as results.json holds it."""
        g = self.gains
        sets = zip(g.sizes, g.points, g.sensitivity, strict=True)
        numbered = ((dict(zip(NUMBERS, map(float, p), strict=True)), float(s), float(m)) for s, p, m in sets)
        return {
            "sets": [point | {"move": size, "sensitivity": peak} for point, size, peak in numbered],
            "notches": [vars(n) for n in g.notches],
            "forward": g.forward,
            "mass": g.mass,
            "points_tried": g.tried,
            "beside": [
                {"size": r.size} | {k: vars(getattr(r, k)) for k in ("scheduled", "single", "sets")} for r in self.sizes
            ],
        }


def compared_drive(
    closed: ClosedDrive, task: Task, equivalent: Equivalent, gains: Gains, scheduled: Callable[[int], Controller],
    *, records: Sequence[Record] = (), bandwidth: float = 0.0, seed: int = 1, budget: Strategy = STRATEGY,
) -> ComparedDrive:  # fmt: skip
    """Tune a closed drive, and hold it beside the PD schedule.

    equivalent, gains: of the plant's friction over amplitude, where the search begins. records: measured ones, for whose modes below
    `bandwidth`, Hz, the drive's notches are; the modes limit the gains too. scheduled(lanes): the PD schedule.
    """
    response, notches = _notches_for(records, task.plant, bandwidth, closed.notches)
    begin = (gains.amplitude, gains.kp, gains.kd)
    tuned = tune_drive(closed, task, equivalent, begin, notches=notches, measured=response, seed=seed, budget=budget)
    return ComparedDrive(tuned, compare_sizes(tuned, scheduled), following_errors(tuned))


def _notches_for(
    records: Sequence[Record], plant: Plant, bandwidth: float, most: int
) -> tuple[Response | None, tuple[Notch, ...]]:
    """Return (measured response where it shows a mode, a notch for each of the modes that rise most)."""
    response, modes = all_resonances(records, plant, bandwidth)
    highest = sorted(modes, key=lambda m: -m.rise)[:most]
    return response, tuple(notch_for(m) for m in sorted(highest, key=lambda m: m.frequency))


def _worst(metrics: Metrics, task, sizes: np.ndarray, lanes: int) -> list[Arrived]:
    """Return the worst of each size, `lanes` scenarios each."""
    m = eased(metrics, task, np.repeat(sizes, lanes))
    columns = (np.max(v.reshape(-1, lanes), axis=1) for v in (m.time_1pct, m.final_error, m.overshoot))
    return [Arrived(*map(float, row)) for row in zip(*columns, strict=True)]


def compare_sizes(gains: DriveGains, scheduled: Callable[[int], Controller]) -> tuple[SizeComparison, ...]:
    """Run every size of move under all three, behind the same current loop. scheduled(lanes): the PD schedule."""
    scenarios, n = steps_of(gains.task, gains.sizes)
    last = np.repeat(gains.points[-1:], gains.sizes.size, axis=0)
    factories = (scheduled(scenarios.lanes), gains.controller(last, n), gains.controller(gains.points, n))
    found = [_worst(gains.task.run(c, scenarios), gains.task, gains.sizes, n) for c in factories]
    return tuple(SizeComparison(float(s), *row) for s, *row in zip(gains.sizes, *found, strict=True))


def following_errors(gains: DriveGains) -> tuple[float, float]:
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
