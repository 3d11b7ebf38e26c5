"""Controllers with free numbers: how a point of a search becomes one controller a lane, and what its linearisations say.

Points are arrays (points, numbers), on a logarithmic scale. Every family obeys the same limit on the sensitivity of its
sampled loop: on the bare inertia (gross sliding), on the stiffest presliding spring and, where gains are scheduled, on the
spring of each amplitude.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workbench.control import Controller, FeedForward, fixed_pd, pi_cascade, profile_pi, scheduled_pd
from workbench.control.law import FEEDBACK, JOINT
from workbench.design.families.linear import Judge

MOST = (
    2.5,
    1.6,
)  # of the tuned gains, Kp and Kd: on the presliding spring they are as stiff as |S| allows with the loop's
# velocity filter; with none Kd may be 1.3 and Kp 1.7 times as large
MOST_JOINT = (
    1.5,
    4.0,
)  # over the relative displacement, which is as small while the axis slides: it may have to be damped by more
SOFT_SCALE = 0.5  # of the tuned gains beside gains of a soft arrival, where a search begins
CASCADE_RANGE = np.array([(0.05, 0.02, 0.001), (5.0, 10.0, 100.0)])  # of kv, kvp, ki over their start


@dataclass(frozen=True, eq=False)
class Family:
    """name: as the report says it. numbers: names of what is searched. lower, upper, start: on the natural scale.

    controller(points, lanes): one controller whose numbers vary over points, each repeated for `lanes` scenarios.
    sensitivity(points): largest Ms over linearisations, (points,). settled(points): points whose numbers all act. soft: another
    start, from which a large step arrives softly. about: how far from a start a search begins, over what it takes, each number.
    """

    name: str
    numbers: tuple[str, ...]
    lower: np.ndarray
    upper: np.ndarray
    start: np.ndarray
    controller: Callable[[np.ndarray, int], Controller]
    sensitivity: Callable[[np.ndarray], np.ndarray]
    settled: Callable[[np.ndarray], np.ndarray] = lambda points: points
    soft: np.ndarray | None = None
    about: np.ndarray | float = 1.0


class OfFamily:
    """What a point of a family is called, and made into. Whoever inherits has family and point (numbers,)."""

    family: Family
    point: np.ndarray

    @property
    def numbers(self) -> dict[str, float]:
        """Name -> value, SI."""
        return dict(zip(self.family.numbers, map(float, self.point), strict=True))

    def controller(self, lanes: int = 1) -> Controller:
        """Return the controller, the same in every one of `lanes` scenarios."""
        return self.family.controller(self.point[None, :], lanes)


def _repeated(values: np.ndarray, lanes: int) -> np.ndarray:
    return np.repeat(values, lanes)


def pd_family(linear: Judge, start: tuple[float, float], *, motor_speed: bool = False) -> Family:
    """Fixed PD: kp, kd."""
    start = np.array(start)

    def controller(points, lanes):
        return fixed_pd(_repeated(points[:, 0], lanes), _repeated(points[:, 1], lanes), motor_speed=motor_speed)

    def sensitivity(points):
        return linear.peak(points[:, :1], points[:, 1:2])

    return Family("fixed PD", ("kp", "kd"), start / 100, start * 100, start, controller, sensitivity)


def integrating(theta: np.ndarray, kvp, ki, dt: float):
    """Response of a PI controller of speed, error to command, whose integral acts one sample later."""
    back = np.exp(-1j * theta)
    return kvp + ki * dt * back / (1.0 - back)


def _over_speed(linear: Judge, mass: float = 0.0) -> Callable[[np.ndarray], np.ndarray]:
    """Return the sensitivity of points (n, 3 or more) kv, kvp, ki: position P over velocity PI. mass: of what is fed forward."""
    dt = linear.loop.sample_time

    def sensitivity(points):
        kv, kvp, ki = (points[:, k : k + 1] for k in range(3))
        inner = integrating(linear.theta, kvp, ki, dt)
        return linear.peak(inner * kv, inner + mass * kv, integrators=1)

    return sensitivity


def cascade_family(
    linear: Judge,
    start: tuple[float, float, float],
    speed_limit: float,
    *,
    motor_speed: bool = False,
    motor_position: bool = False,
    name: str = "PI cascade",
) -> Family:
    """Position P over velocity PI with a velocity limit: kv, kvp, ki."""
    start = np.array(start)

    def controller(points, lanes):
        values = (_repeated(points[:, k], lanes) for k in range(3))
        return pi_cascade(*values, speed_limit, motor_speed=motor_speed, motor_position=motor_position)

    low, high = start * CASCADE_RANGE
    return Family(name, ("kv", "kvp", "ki"), low, high, start, controller, _over_speed(linear))


def profile_family(
    linear: Judge,
    start: tuple[float, float, float, float],
    speed_limit: float,
    step: float,
    feed_forward: FeedForward | None = None,
    *,
    motor_speed: bool = False,
) -> Family:
    """Square-root profile with PI near the target: kv, kvp, ki, deceleration, gate. step: the motion's, rad or m."""
    start = np.array([*start, 1e-2 * step])
    mass = feed_forward.mass if feed_forward else 0.0

    def controller(points, lanes):
        values = (_repeated(points[:, k], lanes) for k in range(5))
        return profile_pi(*values, speed_limit, feed_forward=feed_forward, motor_speed=motor_speed)

    lower, upper = start * (0.1, 0.02, 0.001, 0.3, 1e-3), start * (5.0, 10.0, 100.0, 2.0, 10.0)
    name = "profile with PI, fed forward" if feed_forward else "profile with PI"
    return Family(
        name, ("kv", "kvp", "ki", "deceleration", "gate"), lower, upper, start, controller, _over_speed(linear, mass)
    )


@dataclass(frozen=True, eq=False)
class Blend:
    """A schedule as the look-up takes it: knots, kp, kd (m,), rule, reversal."""

    knots: np.ndarray
    kp: np.ndarray
    kd: np.ndarray
    rule: str
    reversal: float


def _two_mode_gains(schedule, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (kp, kd) (points, m) of points (kp scale, kd scale, switch, gross kp, gross kd, ...) at the schedule's knots.

    Up to the switching amplitude the tuned gains, each times its scale; beyond it, in gross sliding, one pair of gains.
    """
    kp_scale, kd_scale, switch, kp, kd = (points[:, k : k + 1] for k in range(5))
    gross = schedule.knots > switch
    return (
        np.where(gross, kp, np.asarray(schedule.kp) * kp_scale),
        np.where(gross, kd, np.asarray(schedule.kd) * kd_scale),
    )


def blended(schedule, point: np.ndarray, rule: str) -> Blend:
    """Return the two-mode schedule of one point; see two_mode_gains."""
    kp, kd = _two_mode_gains(schedule, np.asarray(point)[None, :])
    return Blend(schedule.knots, kp[0], kd[0], rule, schedule.reversal)


def _two_mode_start(schedule, gross: tuple[float, float], deceleration: float | None, follows: str) -> np.ndarray:
    """Return where a search begins: the tuned gains, and `gross` beyond the switch; of a deceleration, that too."""
    scales = [1.0, 1.0]
    if (
        follows == JOINT
    ):  # the joint is as little wound in motion as at rest: gains of motion are those of the first knots
        scales = [g / float(np.max(known)) for g, known in zip(gross, (schedule.kp, schedule.kd), strict=True)]
    presliding = [*scales, min(3e-3, 0.5 * schedule.knots[-1])]  # inside its range: a search does not begin on a bound
    return np.array([*presliding, *gross, *([deceleration] if deceleration else [])])


def _two_mode_box(schedule, start: np.ndarray, most: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return (lower, upper) of the numbers of two modes about a start. most: of the scales of Kp and Kd."""
    lower = np.array([0.04, 0.2, schedule.knots[0], *(start[3:5] / 100), *(0.3 * start[5:])])
    upper = np.array([*most, schedule.knots[-1], *(start[3:5] * 100), *(2.0 * start[5:])])
    return lower, upper


def scheduled_family(
    linear: Judge,
    schedule,
    rule: str,
    start: tuple[float, float],
    deceleration: float | None = None,
    speed_limit: float | None = None,
    *,
    motor_speed: bool = False,
    follows: str = FEEDBACK,
    soft: tuple[float, float] | None = None,
    most: tuple[float, float] | None = None,
) -> Family:
    """Scheduled PD in two modes: two scales, switch, gains of gross sliding; with a start of the deceleration, that too.

    follows: what the stroke is of: the position that is controlled, or, JOINT, the relative displacement of two masses. soft: gains
    of gross sliding of another start. most: of the scales of Kp and Kd.
    """
    start = _two_mode_start(schedule, start, deceleration, follows)

    def controller(points, lanes):
        tables = [blended(schedule, p, rule) for p in points]
        profile = {}
        if deceleration:
            profile = {"deceleration": _repeated(points[:, 5], lanes), "speed_limit": speed_limit}
        which = np.repeat(np.arange(len(points)), lanes)
        return scheduled_pd(tables, rule, table=which, motor_speed=motor_speed, follows=follows, **profile)

    def sensitivity(points):
        return linear.scheduled_peak(schedule.knots, *_two_mode_gains(schedule, points))

    over = "relative displacement" if follows == JOINT else rule
    lower, upper = _two_mode_box(schedule, start, most or (MOST_JOINT if follows == JOINT else MOST))
    start = np.clip(start, lower, upper)
    return Family(
        f"scheduled PD ({over}{', profile' if deceleration else ''})",
        ("kp scale", "kd scale", "switch", "gross kp", "gross kd", "deceleration")[: start.size],
        lower,
        upper,
        start,
        controller,
        sensitivity,
        soft=np.clip([*(SOFT_SCALE * start[:2]), start[2], *soft, *start[5:]], lower, upper) if soft else None,
    )


def soft_gains(mass: float, drive: float, speed: float) -> tuple[float, float]:
    """Return (kp, kd) under which a bare mass arrives on a double pole at p = 2 drive/(mass speed), the slope of the speed over
    the way at which braking from full speed begins: Kd = 2 m p, Kp = m p^2."""
    pole = 2.0 * drive / (mass * speed)
    return mass * pole**2, 2.0 * mass * pole
