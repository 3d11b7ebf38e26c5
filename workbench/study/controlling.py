"""What study.toml says of the controller: the loop it runs on, what it is tuned for, and the task it is judged by."""

from dataclasses import dataclass, replace

import numpy as np

from workbench.errors import WorkbenchError
from workbench.plant import Plant
from workbench.readers.declaration import Table
from workbench.simulate import Criteria, Loop
from workbench.tune import TuningGoal
from workbench.units import effect_unit
from workbench.verify.task import Task, Weights

RULES = ("following", "frozen")


@dataclass(frozen=True, eq=False)
class Control:
    """loop: of the controller. goal and amplitudes (n,): of tuning. per_octave, slope, tolerance, rule: of the schedule.

    task: on a plant that is set later. speed_limit: of the axis, rad/s or m/s. scale: of exported gains, or None.
    """

    loop: Loop
    goal: TuningGoal
    amplitudes: np.ndarray
    per_octave: int
    tolerance: float
    rule: str
    task: Task
    speed_limit: float
    scale: dict | None
    seed: int

    def limited(self, plant: Plant) -> Plant:
        """Return the plant with the axis' speed limit where the campaign states none."""
        return replace(plant, limits=replace(plant.limits, speed=min(plant.limits.speed, self.speed_limit)))


def control_of(top: Table, plant: Plant) -> Control:
    """Return the control part of a study; WorkbenchError names file and key."""
    x, f = plant.displacement, plant.effort

    def unit(template: str) -> str:
        return effect_unit(template, plant.rotary)

    loop = top.table("loop", ("sample_time", "resolution"), ("substeps", "delay", "velocity_filter"))

    def seconds(key: str) -> float:
        return loop.quantity(key, "s") if key in loop else 0.0

    made = Loop(
        sample_time=loop.quantity("sample_time", "s", above=0.0),
        substeps=int(loop.number("substeps", 2, above=0)),
        delay=seconds("delay"),
        velocity_filter=seconds("velocity_filter"),
        resolution=loop.quantity("resolution", x, above=0.0),
    )
    axis = top.table("axis", optional=("speed_limit", "actuator_limit"))
    speed = axis.quantity("speed_limit", f"{x}/s", above=0.0) if "speed_limit" in axis else plant.limits.speed
    tuning = top.table("tuning", ("lowest", "highest", "count"), ("overshoot", "error", "sensitivity", "seed"))
    count = int(tuning.number("count", above=1))
    if not 20 <= count <= 40:
        raise WorkbenchError(f"{tuning.path('count')} is {count}; gains are tuned at 20 to 40 amplitudes.")
    lowest, highest = (tuning.quantity(k, x, above=0.0) for k in ("lowest", "highest"))
    if lowest >= highest:
        raise WorkbenchError(f"{tuning.path('lowest')} is {lowest:g} {x}, not below 'highest', {highest:g} {x}.")
    goal = TuningGoal(
        overshoot=tuning.number("overshoot", 0.008, above=0.0),
        drive=plant.limits.drive,
        speed=speed,
        error=tuning.number("error", 1.0, above=0.0),
        sensitivity=tuning.number("sensitivity", 2.0, above=1.0),
    )
    schedule = top.table("schedule", optional=("per_octave", "tolerance", "rule"))
    task = top.table(
        "task",
        ("step", "duration"),
        ("loads", "frictions", "inertias", "noise", "phases", "overshoot", "ripple", "error_weight", "counts", "hold"),
    )
    weights = Weights(
        error=task.number("error_weight", Weights.error, above=0.0),
        overshoot=task.number("overshoot", Weights.overshoot, above=0.0),
        ripple=task.number("ripple", Weights.ripple, above=0.0),
        sensitivity=goal.sensitivity,
    )
    criteria = Criteria(
        counts=task.number("counts", Criteria.counts, above=0.0),
        hold=task.quantity("hold", "s", above=0.0) if "hold" in task else Criteria.hold,
    )
    return Control(
        loop=made,
        goal=goal,
        amplitudes=np.geomspace(lowest, highest, count),
        per_octave=int(schedule.number("per_octave", 2, above=0)),
        tolerance=schedule.number("tolerance", 0.02, above=0.0),
        rule=schedule.choice("rule", RULES, "rule") if "rule" in schedule else RULES[0],
        task=Task(
            plant=plant,
            loop=made,
            step=task.quantity("step", x, above=0.0),
            duration=task.quantity("duration", "s", above=0.0),
            load_inertias=numbers(task, "loads", (0.0,), unit("F*s^2/x")),
            frictions=numbers(task, "frictions", (1.0,)),
            inertias=numbers(task, "inertias", (1.0,)),
            noise=task.quantity("noise", f) if "noise" in task else 0.0,
            phases=int(task.number("phases", 2, above=0)),
            weights=weights,
            criteria=criteria,
        ),
        speed_limit=speed,
        scale=dict(top.values["export"]).get("scale") if "export" in top else None,
        seed=int(tuning.number("seed", 1)),
    )


def numbers(table: Table, key: str, default: tuple[float, ...], unit: str | None = None) -> tuple[float, ...]:
    """Return a list of numbers, or { values = [...], unit = "..." } where the numbers have one."""
    if key not in table:
        return default
    if unit is not None:
        from workbench.units import to_si

        inner = table.table(key, ("values", "unit"))
        return tuple(to_si(v, inner.text("unit"), unit, inner.path("unit")) for v in numbers(inner, "values", ()))
    values = table.values[key]
    if (
        not isinstance(values, list)
        or not values
        or any(isinstance(v, bool) or not isinstance(v, (int, float)) for v in values)
    ):
        raise WorkbenchError(f"{table.path(key)} must be a list of numbers, such as [1.0, 1.5].")
    return tuple(float(v) for v in values)
