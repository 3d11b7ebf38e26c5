"""[loop], [axis], [tuning], [schedule], [ladder], [task] and [export] of study.toml: what a controller runs on, is tuned for, and is judged by."""

from dataclasses import dataclass, replace
from math import isfinite

import numpy as np

from workbench.control.laws import ERROR, RULES
from workbench.design.tabled import RUNS
from workbench.errors import WorkbenchError
from workbench.plant import Plant
from workbench.readers.declaration import Table
from workbench.simulation import Criteria, Loop
from workbench.task.task import Task, Weights
from workbench.tuning import TuningGoal
from workbench.units import effect_unit
from workbench.verification.assumed import COUNTS, Shown, lasting

RANGE = ("lowest", "highest", "count")  # of [tuning]
AMPLITUDES = 24  # at which gains are tuned, where a study states no other number
LEAST = 1e-5  # of the step: the lowest amplitude where the encoder has no counts


@dataclass(frozen=True, eq=False)
class Control:
    """loop: of the controller. goal and amplitudes (n,): of tuning. per_octave, slope, tolerance, rule: of the schedule.

    raised: whether the lowest amplitude may be, to where any gains keep the goal. task: on a plant that is set later. load: torque
    or force of the ladder, or None. seeds: of the searches. notch: whether the gain table has one among its numbers.
    speed_limit: of the axis, rad/s or m/s. scale: of exported gains, or None.
    """

    loop: Loop
    goal: TuningGoal
    amplitudes: np.ndarray
    raised: bool
    per_octave: int
    tolerance: float
    rule: str
    task: Task
    speed_limit: float
    scale: dict | None
    load: float | None
    seeds: tuple[int, ...]
    notch: bool = True

    def limited(self, plant: Plant) -> Plant:
        """Return the plant with the axis' speed limit where the campaign states none."""
        return _limited(plant, self.speed_limit)


def control_of(top: Table, plant: Plant, shown: Shown | None = None) -> Control:
    """Return the control part of a study; WorkbenchError names file and key.

    shown: what the records say of all that the study leaves out; without it, loop, amplitudes and move have to be stated.
    """
    x = plant.displacement
    axis = top.table("axis", optional=("speed_limit",))
    speed = axis.quantity("speed_limit", f"{x}/s", above=0.0) if "speed_limit" in axis else plant.limits.speed
    speed = shown.speed if shown and not isfinite(speed) else speed
    loop = _loop(top, x, shown)
    task = _task(top, _limited(plant, speed), loop, shown)
    tuning = top.table("tuning", () if shown else RANGE, (*RANGE, "overshoot", "error", "sensitivity", "seeds"))
    goal = TuningGoal(
        overshoot=tuning.number("overshoot", 0.008, above=0.0),
        drive=plant.limits.drive,
        speed=speed,
        error=tuning.number("error", 1.0, above=0.0),
        sensitivity=tuning.number("sensitivity", 2.0, above=1.0),
    )
    one = top.table("ladder", optional=("load",)) if "ladder" in top else ()
    schedule = top.table("schedule", optional=("per_octave", "tolerance", "rule", "notch"))
    return Control(
        loop=loop,
        goal=goal,
        amplitudes=_amplitudes(tuning, x, COUNTS * loop.resolution or LEAST * task.step, task.step),
        raised="lowest" not in tuning,
        per_octave=int(schedule.number("per_octave", 2, above=0)),
        tolerance=schedule.number("tolerance", 0.02, above=0.0),
        rule=schedule.choice("rule", RULES, "rule") if "rule" in schedule else ERROR,
        task=replace(task, weights=replace(task.weights, sensitivity=goal.sensitivity)),
        speed_limit=speed,
        scale=dict(top.values["export"]).get("scale") if "export" in top else None,
        load=one.quantity("load", plant.effort, above=0.0) if "load" in one else None,
        notch=schedule.flag("notch", True),
        seeds=tuple(int(s) for s in tuning.numbers("seeds", RUNS)),
    )


def _limited(plant: Plant, speed: float) -> Plant:
    """Return the plant with a limit of speed, rad/s or m/s, where its own is no lower."""
    return replace(plant, limits=replace(plant.limits, speed=min(plant.limits.speed, speed)))


def _loop(top: Table, x: str, shown: Shown | None) -> Loop:
    """Return [loop]; that of the records where it states no sample time."""
    known = () if shown else ("sample_time", "resolution")
    one = top.table("loop", known, ("sample_time", "resolution", "substeps", "delay", "velocity_filter"))
    base = shown.loop if shown and "sample_time" not in one else Loop(one.quantity("sample_time", "s", above=0.0))
    counts = base.resolution if shown is None else shown.loop.resolution

    def seconds(key: str) -> float:
        return one.quantity(key, "s") if key in one else getattr(base, key)

    return Loop(
        sample_time=base.sample_time,
        substeps=int(one.number("substeps", base.substeps, above=0)),
        delay=seconds("delay"),
        velocity_filter=seconds("velocity_filter"),
        resolution=one.quantity("resolution", x, above=0.0) if "resolution" in one else counts,
    )


def _amplitudes(tuning: Table, x: str, lowest: float, highest: float) -> np.ndarray:
    """Return the amplitudes of [tuning], even in the logarithm; between these where it states none."""
    count = int(tuning.number("count", AMPLITUDES, above=1))
    if not 20 <= count <= 40:
        raise WorkbenchError(f"{tuning.path('count')} is {count}; gains are tuned at 20 to 40 amplitudes.")
    lowest, highest = (
        tuning.quantity(key, x, above=0.0) if key in tuning else otherwise
        for key, otherwise in (("lowest", lowest), ("highest", highest))
    )
    if lowest >= highest:
        raise WorkbenchError(f"{tuning.path('lowest')} is {lowest:g} {x}, not below 'highest', {highest:g} {x}.")
    return np.geomspace(lowest, highest, count)


def _task(top: Table, plant: Plant, loop: Loop, shown: Shown | None) -> Task:
    """Return [task]; half of the records' travel, for as long as it takes, where it states no step and no duration."""
    x, known = plant.displacement, ("step", "duration")
    further = (
        "loads",
        "frictions",
        "inertias",
        "noise",
        "phases",
        "overshoot",
        "ripple",
        "error_weight",
        "counts",
        "hold",
    )
    one = top.table("task", () if shown else known, (*known, *further))
    weights = Weights(
        error=one.number("error_weight", Weights.error, above=0.0),
        overshoot=one.number("overshoot", Weights.overshoot, above=0.0),
        ripple=one.number("ripple", Weights.ripple, above=0.0),
    )
    criteria = Criteria(
        counts=one.number("counts", Criteria.counts, above=0.0),
        hold=one.quantity("hold", "s", above=0.0) if "hold" in one else Criteria.hold,
    )
    task = Task(
        plant=plant,
        loop=loop,
        step=one.quantity("step", x, above=0.0) if "step" in one else shown.step,
        duration=one.quantity("duration", "s", above=0.0) if "duration" in one else 0.0,
        load_inertias=one.numbers("loads", (0.0,), effect_unit("F*s^2/x", plant.rotary)),
        frictions=one.numbers("frictions", (1.0,)),
        inertias=one.numbers("inertias", (1.0,)),
        noise=one.quantity("noise", plant.effort) if "noise" in one else 0.0,
        phases=int(one.number("phases", 2, above=0)),
        weights=weights,
        criteria=criteria,
        start=shown.start if "step" not in one else 0.0,
    )
    return task if "duration" in one else replace(task, duration=lasting(task))
