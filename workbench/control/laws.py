"""Three laws: fixed PD, PD scheduled over the stroke since the last reversal, and the position-velocity cascade.

The scheduled PD may slow down along a square-root profile, and may follow the joint; the cascade may take its velocity
from the motor. A profile with PI is in `profile`.
"""

from collections.abc import Sequence
from functools import cache

import numpy as np

from workbench.control.law import FEEDBACK, JOINT, Controller, Law
from workbench.control.notched import notched
from workbench.control.table import Table
from workbench.effects.elementary import absolute, clip, maximum, minimum, sign0, sqrt, where
from workbench.errors import WorkbenchError, nearest

FOLLOWING, FROZEN, ERROR, CLOSING = "following", "frozen", "error", "closing"
RULES = (FOLLOWING, FROZEN, ERROR, CLOSING)  # a binary gain file numbers them in this order: add at the end
# Reversals, of 2.5 encoder counts each: 40 counts. Shorter moves have gains of their own, longer ones end with those of that amplitude. On the
# main study the worst time over that of gains for one move alone is 1.30 to 1.46 from three seeds, at 30 counts 1.35 to 1.44, at 20
# counts 1.35 to 1.37: there is little in it.
CLOSES = 16.0

MOTOR = ("motor_vh",)  # what a law reads whose speed is the motor's


OF_MOTOR = ", speed of the motor"


def speed(s):
    """The speed that a law acts on: the motor's where it asks for that, else that of y."""
    return getattr(s, "motor_vh", s.vh)


def _fixed(s, z, p):
    return {}, p.kp * s.e - p.kd * speed(s)


_PD = Law("fixed_pd", ("kp", "kd"), _fixed)
_PD_MOTOR = Law("fixed_pd" + OF_MOTOR, _PD.parameters, _fixed, reads=MOTOR)


def fixed_pd(kp, kd, *, motor_speed: bool = False) -> Controller:
    """u = kp (r - y) - kd vh.

    kp: N*m/rad or N/m. kd: N*m*s/rad or N*s/m. Scalars, or (lanes,) arrays with a value a lane. motor_speed: of two masses,
    vh is the motor's speed whichever encoder gives y, as for every law here: it damps without the joint in between.
    """
    return Controller("fixed_pd", _PD_MOTOR if motor_speed else _PD, {"kp": kp, "kd": kd})


def _following(s, z, p):
    return {}, s.share * s.stroke


def _error_aware(s, z, p):
    return {}, s.share * minimum(s.stroke, maximum(absolute(s.e), s.count))


def _frozen(s, z, p):
    held = where(s.reversal, s.share * absolute(s.e), z.held)
    return {"held": held}, held


def _closing(s, z, p):
    begun = s.back < absolute(s.r - z.asked)
    size = where(begun, absolute(s.e), z.held)
    return {"held": size, "asked": s.r}, maximum(absolute(s.e), minimum(size, CLOSES * s.back))


def _scheduled_step(s, z, p):
    return {}, (p.scale * s.kp) * s.e - (p.scale * s.kd) * speed(s)


def _profiled_step(s, z, p):
    left = absolute(s.e)
    fastest = minimum(sqrt(2.0 * p.deceleration * left), p.speed_limit)
    wanted = minimum(s.kp * left, s.kd * fastest)
    return {}, p.scale * (sign0(s.e) * wanted - s.kd * speed(s))


def _whole(target, reading):
    return {"held": absolute(target - reading)}


# (amplitude, states, start) of each rule
_RULES = {
    FOLLOWING: (_following, (), None),
    FROZEN: (_frozen, ("held",), _whole),
    ERROR: (_error_aware, (), None),
    CLOSING: (_closing, ("held", "asked"), lambda target, reading: _whole(target, reading) | {"asked": target}),
}


@cache
def _scheduled(rule: str, follows: str, profiled: bool, motor_speed: bool) -> Law:
    amplitude, states, start = _RULES[rule]
    return Law(
        name=f"scheduled_pd, {rule}"
        + ", joint" * (follows == JOINT)
        + ", profiled" * profiled
        + OF_MOTOR * motor_speed,
        parameters=("scale", "deceleration", "speed_limit") if profiled else ("scale",),
        step=_profiled_step if profiled else _scheduled_step,
        states=states,
        columns=("kp", "kd"),
        amplitude=amplitude,
        start=start,
        reads=MOTOR if motor_speed else (),
        follows=follows,
    )


def scheduled_pd(
    schedule,
    rule: str | None = None,
    *,
    scale=1.0,
    table=None,
    deceleration=None,
    speed_limit=None,
    follows: str = FEEDBACK,
    motor_speed: bool = False,
) -> Controller:
    """u = Kp(A) (r - y) - Kd(A) vh, A the amplitude of the equivalent motion.

    schedule: anything with knots, kp, kd (n,) and, where it has them, rule, reversal, velocity_filter, notch with sample_time; or a sequence of such, of one
    grid of knots, of which table (lanes,) says which one a lane uses. With s the distance since the last reversal:

    - "following": A = s from rest, s/2 after a reversal: gains move with the motion.
    - "frozen": A is set at each reversal to half the error that is left, and held to the next; at the start it is the
      whole error.
    - "error": as "following", with s no more than the larger of the error and one count.
    - "closing": A is the error, and no less than the size of the move up to CLOSES reversals: a short move keeps gains of its
      own, and longer ones end with those of that amplitude. A move begins where the target jumps by more than a reversal.

    Outside the knots gains are those of the first or last. scale, scalar or (lanes,), multiplies both gains.
    deceleration (rad/s^2 or m/s^2) and speed_limit (rad/s or m/s), together: Kp |e| is no more than Kd times
    min(sqrt(2 deceleration |e|), speed_limit), so that gross motion ends along a parabola. follows: "joint" lets s be the
    relative displacement of two encoders since its own reversal, and A too; rule "following" alone makes sense of it.
    """
    schedules = list(schedule) if isinstance(schedule, Sequence) else [schedule]
    if not schedules:
        raise WorkbenchError("scheduled_pd needs a schedule.")
    rule = rule or getattr(schedules[0], "rule", None) or FOLLOWING
    if rule not in RULES:
        raise WorkbenchError(f"unknown rule '{rule}' of a schedule; {nearest(rule, RULES)}")
    if follows == JOINT and rule != FOLLOWING:
        raise WorkbenchError(
            f"a schedule over the relative displacement has the rule '{FOLLOWING}'; '{rule}' compares it with the error "
            "of the load, which is another thing."
        )
    if (deceleration is None) != (speed_limit is None):
        raise WorkbenchError("scheduled_pd: a profile needs both a deceleration and a speed_limit.")
    tables = tuple(Table(s.knots, {"kp": s.kp, "kd": s.kd}) for s in schedules)
    reversal = getattr(schedules[0], "reversal", None)
    table = None if table is None else np.asarray(table, dtype=np.int64)
    if table is not None and (table.min() < 0 or table.max() >= len(tables)):
        raise WorkbenchError(f"scheduled_pd: table numbers must lie in 0 to {len(tables) - 1}.")
    profile = {} if deceleration is None else {"deceleration": deceleration, "speed_limit": speed_limit}
    law = _scheduled(rule, follows, bool(profile), motor_speed)
    made = Controller(
        "scheduled_pd", law, {"scale": scale, **profile}, tables, table, reversal, _own(schedules[0], "velocity_filter")
    )
    notch = _own(schedules[0], "notch")
    return made if notch is None else notched(made, notch, schedules[0].sample_time)


def _own(schedule, name: str):
    """Return what a schedule was tuned with besides its gains, or None."""
    return getattr(schedule, name, None)


def cascaded(s, z, p, wanted, more=0.0, growing=1.0):
    """Return the step of a PI controller of speed: u = kvp (wanted - vh) + integral + more.

    growing: where the integral may move. It stops while the command is beyond the drive's limit and the error would push it
    further, and never asks for more than the limit itself.
    """
    error = wanted - speed(s)
    command = p.kvp * error + z.integral + more
    free = growing * ((absolute(command) <= s.limit) + (command * error < 0.0))
    grown = clip(z.integral + (p.ki * s.dt) * error, -s.limit, s.limit)
    return {"integral": where(free, grown, z.integral)}, command


def _cascade(s, z, p):
    return cascaded(s, z, p, clip(p.kv * s.e, -p.speed_limit, p.speed_limit))


def _cascade_on_motor(s, z, p):
    return cascaded(s, z, p, clip(p.kv * (s.r - s.motor_y), -p.speed_limit, p.speed_limit))


_CASCADE = Law("pi_cascade", ("kv", "kvp", "ki", "speed_limit"), _cascade, states=("integral",))
_DUAL = Law("pi_cascade" + OF_MOTOR, _CASCADE.parameters, _cascade, ("integral",), reads=MOTOR)
_ON_MOTOR = Law(
    "pi_cascade, on the motor", _CASCADE.parameters, _cascade_on_motor, ("integral",), reads=("motor_y", *MOTOR)
)


def pi_cascade(kv, kvp, ki, speed_limit, *, motor_speed: bool = False, motor_position: bool = False) -> Controller:
    """v_r = clip(kv (r - y), +-speed_limit), u = kvp (v_r - vh) + ki integral of (v_r - vh) dt.

    kv: 1/s. kvp: N*m*s/rad or N*s/m. ki: N*m/rad or N/m. speed_limit: rad/s or m/s. Scalars or (lanes,) arrays.
    The integral stops while the command is beyond the drive's limit and the error would push it further, and is itself
    clamped to that limit. motor_speed: as for fixed_pd.
    motor_position: y is the motor's too, whichever encoder closes the loop: a cascade that does not see the load.
    """
    values = {"kv": kv, "kvp": kvp, "ki": ki, "speed_limit": speed_limit}
    law = _ON_MOTOR if motor_position else _DUAL if motor_speed else _CASCADE
    return Controller("pi_cascade", law, values)
