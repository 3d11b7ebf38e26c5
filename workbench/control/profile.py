"""A square-root velocity profile with PI near the target, and feed-forward of what the model knows of the motion.

The speed that is asked for is the one from which a constant deceleration a comes to rest on the target, with a straight
line of slope kv through the target, to which the parabola is tangent:

    v_r = sgn(e) min(kv |e|, sqrt(2 a |e| - (a/kv)^2), speed_limit),   straight up to |e| = a/kv^2

Its slope times the measured speed is the acceleration that the profile asks for; the model says the torque for it.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from workbench.control.law import Controller, Law
from workbench.control.laws import MOTOR, OF_MOTOR, cascaded, speed
from workbench.control.table import Table
from workbench.effects.elementary import absolute, clip, maximum, minimum, sign0, sqrt, where
from workbench.errors import WorkbenchError

NUMBERS = ("kv", "kvp", "ki", "deceleration", "gate", "speed_limit")


@dataclass(frozen=True, eq=False)
class FeedForward:
    """What the model knows of the motion. mass: kg*m^2 or kg. speeds (n,): rad/s or m/s, knots of a table's grid.
    friction (n,): N*m or N when sliding at these speeds; from the first speed down it falls to zero along a line."""

    mass: float
    speeds: np.ndarray
    friction: np.ndarray

    def __post_init__(self):
        if not (np.isfinite(self.mass) and self.mass >= 0.0):
            raise WorkbenchError(f"feed-forward: the mass is {self.mass:g}; it must be finite and not negative.")

    @property
    def table(self) -> Table:
        return Table(self.speeds, {"friction": self.friction})


def _wanted(e, p):
    """Return (speed asked for, its slope over the error), both for the size of the error."""
    left = absolute(e)
    over = p.deceleration / p.kv
    parabola = sqrt(maximum(2.0 * p.deceleration * left - over * over, 0.0))
    straight = left <= over / p.kv
    free = where(straight, p.kv * left, parabola)
    slope = where(straight, p.kv, p.deceleration / maximum(parabola, over))
    limited = p.speed_limit < free
    return minimum(free, p.speed_limit), where(limited, 0.0, slope)


def _near(s, p):
    return absolute(s.e) <= p.gate


def _profile(s, z, p):
    wanted, _ = _wanted(s.e, p)
    return cascaded(s, z, p, sign0(s.e) * wanted, growing=_near(s, p))


def _fed(s, z, p):
    wanted, slope = _wanted(s.e, p)
    asked = sign0(s.e) * wanted
    sliding = s.friction * clip(asked * p.per_first, -1.0, 1.0)
    return cascaded(s, z, p, asked, sliding - p.mass * slope * speed(s), _near(s, p))


@cache
def _law(fed: bool, motor_speed: bool) -> Law:
    return Law(
        "profile_pi" + ", fed forward" * fed + OF_MOTOR * motor_speed,
        (*NUMBERS, "mass", "per_first") if fed else NUMBERS,
        _fed if fed else _profile,
        states=("integral",),
        columns=("friction",) if fed else (),
        amplitude=(lambda s, z, p: ({}, _wanted(s.e, p)[0])) if fed else None,
        reads=MOTOR if motor_speed else (),
    )


def profile_pi(
    kv, kvp, ki, deceleration, gate, speed_limit, *, feed_forward: FeedForward | None = None, motor_speed: bool = False
) -> Controller:
    """u = kvp (v_r - vh) + ki integral of (v_r - vh) dt where |r - y| <= gate, v_r along the profile of the module.

    kv: 1/s. kvp: N*m*s/rad or N*s/m. ki: N*m/rad or N/m. deceleration: rad/s^2 or m/s^2. gate: rad or m. speed_limit:
    rad/s or m/s. Scalars or (lanes,) arrays. feed_forward: adds sliding friction at v_r, and mass times the acceleration
    that the profile asks for, -(dv_r/de) vh. motor_speed: as for fixed_pd.
    """
    values = dict(zip(NUMBERS, (kv, kvp, ki, deceleration, gate, speed_limit), strict=True))
    if feed_forward is None:
        return Controller("profile_pi", _law(False, motor_speed), values)
    known = {"mass": feed_forward.mass, "per_first": 1.0 / float(feed_forward.speeds[0])}
    return Controller("profile_pi", _law(True, motor_speed), values | known, (feed_forward.table,))
