"""Checks of the schedule that the simulated loop ended with: margins, sensitivity between its knots, passivity, its length."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.errors import WorkbenchError
from workbench.schedule import BetweenKnots, Passivity, Schedule, between_knots, fewest_knots, passivity
from workbench.simulation import Loop
from workbench.tuning import Gains, TunedAxis, TuningGoal
from workbench.tuning.axis import Axis
from workbench.tuning.margins import margins

TOLERANCES = (0.2, 0.1, 0.05, 0.02, 0.01)


@dataclass(frozen=True)
class Length:
    """knots: the fewest with which a schedule is within `tolerance` of the tuned gains, 0 where none is. error: what it is."""

    tolerance: float
    knots: int
    error: float


@dataclass(frozen=True, eq=False)
class Checks:
    """schedule: what is checked. gain_margin (n,), ratio, and phase_margin (n,), rad, by python-control at its knots, on the
    equivalent axis of each. between: sensitivity and stability between knots. moving: passivity under the rule "following".
    lengths: fewest knots of several tolerances, for the tuned gains."""

    schedule: Schedule
    gain_margin: np.ndarray
    phase_margin: np.ndarray
    between: BetweenKnots
    moving: Passivity
    lengths: tuple[Length, ...]


def checked(
    axis: TunedAxis,
    schedule: Schedule,
    goal: TuningGoal,
    loop: Loop,
    tolerances: Sequence[float] = TOLERANCES,
) -> Checks:
    """Check a schedule on the axis whose gains were tuned at its amplitudes."""
    inertia, viscous, at = axis.rigid.inertia, axis.rigid.viscous, axis.described(loop.resolution)
    at_knots = Axis.of(at(schedule.knots), inertia, viscous, loop).behind(schedule.numbers)
    kp, kd = schedule.kp / at_knots.unit_kp, schedule.kd / at_knots.unit_kd
    gain, phase = margins(kp, kd, at_knots.steps(kp), at_knots.clock)
    between = between_knots(schedule, at, inertia, loop, viscous=viscous, sensitivity=goal.sensitivity, points=3)
    moving = passivity(replace(schedule, rule="following"), at, inertia, viscous=viscous)
    return Checks(schedule, gain, phase, between, moving, tuple(_length(axis.gains, loop, t) for t in tolerances))


def _length(gains: Gains, loop: Loop, tolerance: float) -> Length:
    """Return the shortest schedule within a tolerance of the tuned gains."""
    try:
        found = fewest_knots(gains, loop=loop, tolerance=tolerance, monotone=False, slope=(-4.0, 2.0))
    except WorkbenchError:
        return Length(tolerance, 0, float("nan"))
    return Length(tolerance, found.knots.size, float(found.interpolation_error))
