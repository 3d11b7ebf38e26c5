"""Controllers with free numbers: how a point of a search becomes one controller a lane, and what its linearisations say.

Points are arrays (points, numbers), on a logarithmic scale. Every family obeys the same limit on the sensitivity of its
sampled loop, on the bare inertia (gross sliding) and on the stiffest presliding spring.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workbench.control import Controller, fixed_pd, pi_cascade, scheduled_pd
from workbench.simulate import Loop
from workbench.tune import sampled
from workbench.tune.sampled import Clock

LOWEST = 1e-3  # rad a sample: sensitivities are looked for from here to the Nyquist frequency
GRID = 160


@dataclass(frozen=True, eq=False)
class Family:
    """name: as the report says it. numbers: names of what is searched. lower, upper, start: on the natural scale.

    controller(points, lanes): one controller whose numbers vary over points, each repeated for `lanes` scenarios.
    sensitivity(points): largest Ms over linearisations, (points,).
    """

    name: str
    numbers: tuple[str, ...]
    lower: np.ndarray
    upper: np.ndarray
    start: np.ndarray
    controller: Callable[[np.ndarray, int], Controller]
    sensitivity: Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True, eq=False)
class Linear:
    """Linearisations of an axis: inertia (kg*m^2 or kg) with springs (n,) to ground, in the sampled loop."""

    loop: Loop
    inertia: float
    viscous: float
    stiffnesses: np.ndarray

    @property
    def clock(self) -> Clock:
        return Clock.of(self.loop)

    def plant(self) -> tuple[np.ndarray, np.ndarray]:
        """Return (theta (f,), response (n, f)) from torque to position, with the zero-order hold and the delay."""
        theta = np.geomspace(LOWEST, np.pi, GRID)
        unit = self.loop.sample_time**2 / self.inertia
        damping = np.full(self.stiffnesses.size, self.viscous * self.loop.sample_time / self.inertia)
        motion = sampled.steps(self.stiffnesses * unit, damping, self.clock)
        return theta, sampled.response(theta, motion, self.clock) * unit

    def peak(self, law: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
        """Return Ms (points,) of laws C(theta, filtered difference per second) (points, f), the largest over the springs."""
        theta, plant = self.plant()
        rate = sampled.difference(theta, self.clock) / self.loop.sample_time
        c = law(theta, rate)
        return np.max([np.max(1.0 / np.abs(1.0 + c * p), axis=1) for p in plant], axis=0)


def repeated(values: np.ndarray, lanes: int) -> np.ndarray:
    return np.repeat(values, lanes)


def pd_family(linear: Linear, start: tuple[float, float]) -> Family:
    """Fixed PD: kp, kd."""
    start = np.array(start)

    def controller(points, lanes):
        return fixed_pd(repeated(points[:, 0], lanes), repeated(points[:, 1], lanes))

    def sensitivity(points):
        return linear.peak(lambda theta, rate: points[:, :1] + points[:, 1:2] * rate)

    return Family("fixed PD", ("kp", "kd"), start / 100, start * 100, start, controller, sensitivity)


def cascade_family(linear: Linear, start: tuple[float, float, float], speed_limit: float) -> Family:
    """Position P over velocity PI with a velocity limit: kv, kvp, ki."""
    start = np.array(start)
    dt = linear.loop.sample_time

    def controller(points, lanes):
        kv, kvp, ki = (repeated(points[:, k], lanes) for k in range(3))
        return pi_cascade(kv, kvp, ki, speed_limit)

    def sensitivity(points):
        kv, kvp, ki = (points[:, k : k + 1] for k in range(3))

        def law(theta, rate):
            back = np.exp(-1j * theta)
            return (kvp + ki * dt * back / (1.0 - back)) * (kv + rate)

        return linear.peak(law)

    return Family(
        "PI cascade", ("kv", "kvp", "ki"), start * (0.05, 0.02, 0.001), start * (5.0, 10.0, 100.0), start,
        controller, sensitivity,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Blend:
    """A schedule as the look-up takes it: knots, kp, kd (m,), rule, reversal."""

    knots: np.ndarray
    kp: np.ndarray
    kd: np.ndarray
    rule: str
    reversal: float


def blended(schedule, point: np.ndarray, rule: str) -> Blend:
    """Return the two-mode schedule of a point (scale, switch, gross kp, gross kd).

    Up to the switching amplitude the tuned gains, slowed by `scale` (kp by its square, kd by itself: the same damping);
    beyond it, in gross sliding, one pair of gains.
    """
    scale, switch, kp, kd = point
    gross = schedule.knots > switch
    return Blend(
        schedule.knots,
        np.where(gross, kp, np.asarray(schedule.kp) * scale**2),
        np.where(gross, kd, np.asarray(schedule.kd) * scale),
        rule,
        schedule.reversal,
    )


def scheduled_family(linear: Linear, schedule, rule: str, start: tuple[float, float]) -> Family:
    """Scheduled PD in two modes: scale, switch, and the gains of gross sliding."""
    presliding = np.array([1.0, 3e-3 if schedule.knots[-1] > 3e-3 else schedule.knots[-1]])
    start = np.concatenate([presliding, start])

    def controller(points, lanes):
        tables = [blended(schedule, p, rule) for p in points]
        return scheduled_pd(tables, rule, table=np.repeat(np.arange(len(points)), lanes))

    def sensitivity(points):
        return linear.peak(lambda theta, rate: points[:, 2:3] + points[:, 3:4] * rate)

    lower = np.concatenate([[0.2, schedule.knots[0]], start[2:] / 100])
    upper = np.concatenate([[1.0, schedule.knots[-1]], start[2:] * 100])
    return Family(
        f"scheduled PD ({rule})",
        ("scale", "switch", "gross kp", "gross kd"),
        lower,
        upper,
        start,
        controller,
        sensitivity,
    )
