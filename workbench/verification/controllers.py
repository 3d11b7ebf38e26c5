"""The controllers of one-mass axis that a contest holds: their families, from one description, schedule and model."""

from dataclasses import dataclass

import numpy as np

from workbench.control import FeedForward, grid
from workbench.control.laws import ERROR, FOLLOWING, FROZEN
from workbench.description.friction import friction_of
from workbench.design.design import BRAKING, DEEP, LEADS, REACHED, linear_of
from workbench.design.families.family import (
    Family,
    cascade_family,
    pd_family,
    profile_family,
    scheduled_family,
    soft_gains,
)
from workbench.design.families.gain_table import BEGUN
from workbench.design.families.linear import Linear
from workbench.design.families.shaped import shaped
from workbench.plant import Plant
from workbench.schedule import Schedule, fit_schedule
from workbench.task.bound import sliding_torque
from workbench.task.task import Task
from workbench.tuning import TunedAxis, TuningGoal, tuned_axis

SLOWEST = 1e-3  # of the speed limit: first knot of the friction that is fed forward


@dataclass(frozen=True, eq=False)
class Controllers:
    """axis: described and tuned at its amplitudes. schedule: through these gains. linear: what sensitivities are asked of.
    feed_forward: of the model. families: of every controller that is tuned. notched: the same with a notch among their numbers."""

    plant: Plant
    goal: TuningGoal
    axis: TunedAxis
    schedule: Schedule
    linear: Linear
    feed_forward: FeedForward
    families: tuple[Family, ...]
    notched: tuple[Family, ...]

    def family(self, name: str, notch: bool = False) -> Family:
        return next(f for f in (self.notched if notch else self.families) if f.name == name)


def feed_forward_of(plant: Plant, counts: float) -> FeedForward:
    """Return what the model of a one-mass axis knows of its motion: mass, and friction when sliding, by speed."""
    _, mass, _ = friction_of(plant)
    speeds = grid(SLOWEST * plant.limits.speed, plant.limits.speed, 1)
    return FeedForward(mass, speeds, sliding_torque(plant, speeds, counts))


def controllers_of(
    plant: Plant, amplitudes: np.ndarray, goal: TuningGoal, task: Task, *, per_octave: int = 2, tolerance: float = 0.1
) -> Controllers:
    """Describe the plant, tune gains at amplitudes (n,), fit the schedule, and make the families of all controllers."""
    loop, step = task.loop, task.step
    axis = tuned_axis(plant, amplitudes, goal, loop)
    gains = axis.gains
    schedule = fit_schedule(
        gains,
        per_octave=per_octave,
        lowest=float(amplitudes[0]),
        highest=float(amplitudes[-1]),
        tolerance=tolerance,
        plant_digest=plant.digest,
        plant_lines=plant.digest_lines(),
        loop=loop,
    )
    linear = linear_of(axis.rigid, axis.equivalent, loop)
    speed = REACHED * plant.limits.speed
    middle = int(np.argmin(np.abs(np.log(amplitudes / (1e-2 * step)))))
    kp, kd = float(gains.kp[middle]), float(gains.kd[middle])
    kv = kp / kd
    ki = 0.1 * kv * kd
    braking = BRAKING * plant.limits.drive / linear.inertia
    soft = soft_gains(linear.inertia, plant.limits.drive, plant.limits.speed)
    known = feed_forward_of(plant, loop.resolution)
    makers = (
        *(
            lambda j, rule=rule: scheduled_family(j, schedule, rule, (kp, kd), soft=soft)
            for rule in (FROZEN, FOLLOWING, ERROR)
        ),
        lambda j: scheduled_family(j, schedule, "error", (kp, kd), braking, speed),
        lambda j: pd_family(j, (kp, kd)),
        lambda j: cascade_family(j, (kv, kd, ki), speed),
        lambda j: profile_family(j, (kv, kd, ki, braking), speed, step),
        lambda j: profile_family(j, (kv, kd, ki, braking), speed, step, known),
    )
    dt = loop.sample_time
    # the paper's laws have no notch
    families, notched = (tuple(shaped(m, linear, BEGUN * dt, n) for m in makers) for n in (None, (LEADS / dt, DEEP)))
    return Controllers(plant, goal, axis, schedule, linear, known, families, notched)
