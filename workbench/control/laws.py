"""Three laws: fixed PD, PD scheduled over the stroke since the last reversal, and the position-velocity cascade."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from workbench.control.law import Controller, Law
from workbench.control.table import Table
from workbench.effects.elementary import absolute, clip, maximum, minimum, where
from workbench.errors import WorkbenchError, nearest

FOLLOWING, FROZEN, ERROR = "following", "frozen", "error"
RULES = (FOLLOWING, FROZEN, ERROR)

_PD = Law("fixed_pd", ("kp", "kd"), lambda s, z, p: ({}, p.kp * s.e - p.kd * s.vh))


def fixed_pd(kp, kd) -> Controller:
    """u = kp (r - y) - kd vh.

    kp: N*m/rad or N/m. kd: N*m*s/rad or N*s/m. Scalars, or (lanes,) arrays with a value a lane.
    """
    return Controller("fixed_pd", _PD, {"kp": kp, "kd": kd})


def _following(s, z, p):
    return {}, s.share * s.stroke


def _error_aware(s, z, p):
    return {}, s.share * minimum(s.stroke, maximum(absolute(s.e), s.count))


def _frozen(s, z, p):
    held = where(s.reversal, s.share * absolute(s.e), z.held)
    return {"held": held}, held


def _scheduled_step(s, z, p):
    return {}, (p.scale * s.kp) * s.e - (p.scale * s.kd) * s.vh


@lru_cache(maxsize=len(RULES))
def _scheduled(rule: str) -> Law:
    amplitude = {FOLLOWING: _following, ERROR: _error_aware, FROZEN: _frozen}[rule]
    return Law(
        name=f"scheduled_pd, {rule}",
        parameters=("scale",),
        step=_scheduled_step,
        states=("held",) if rule == FROZEN else (),
        columns=("kp", "kd"),
        amplitude=amplitude,
        start=(lambda target, reading: {"held": np.abs(target - reading)}) if rule == FROZEN else None,
    )


def scheduled_pd(schedule, rule: str | None = None, *, scale=1.0, table=None) -> Controller:
    """u = Kp(A) (r - y) - Kd(A) vh, A the amplitude of the equivalent motion.

    schedule: anything with knots, kp, kd (n,) and, where it has them, rule and reversal; or a sequence of such, of one
    grid of knots, of which table (lanes,) says which one a lane uses. With s the distance since the last reversal:

    - "following": A = s from rest, s/2 after a reversal: gains move with the motion.
    - "frozen": A is set at each reversal to half the error that is left, and held to the next; at the start it is the
      whole error.
    - "error": as "following", with s no more than the larger of the error and one count.

    Outside the knots gains are those of the first or last. scale, scalar or (lanes,), multiplies both gains.
    """
    schedules = list(schedule) if isinstance(schedule, Sequence) else [schedule]
    if not schedules:
        raise WorkbenchError("scheduled_pd needs a schedule.")
    rule = rule or getattr(schedules[0], "rule", None) or FOLLOWING
    if rule not in RULES:
        raise WorkbenchError(f"unknown rule '{rule}' of a schedule; {nearest(rule, RULES)}")
    tables = tuple(Table(s.knots, {"kp": s.kp, "kd": s.kd}) for s in schedules)
    reversal = getattr(schedules[0], "reversal", None)
    table = None if table is None else np.asarray(table, dtype=np.int64)
    if table is not None and (table.min() < 0 or table.max() >= len(tables)):
        raise WorkbenchError(f"scheduled_pd: table numbers must lie in 0 to {len(tables) - 1}.")
    return Controller("scheduled_pd", _scheduled(rule), {"scale": scale}, tables, table, reversal)


def _cascade(s, z, p):
    wanted = clip(p.kv * s.e, -p.speed_limit, p.speed_limit)
    error = wanted - s.vh
    command = p.kvp * error + z.integral
    # Conditional integration: not further into the limit. The integral itself never asks for more than the limit.
    free = (absolute(command) <= s.limit) + (command * error < 0.0)
    grown = clip(z.integral + (p.ki * s.dt) * error, -s.limit, s.limit)
    return {"integral": where(free, grown, z.integral)}, command


_CASCADE = Law("pi_cascade", ("kv", "kvp", "ki", "speed_limit"), _cascade, states=("integral",))


def pi_cascade(kv, kvp, ki, speed_limit) -> Controller:
    """v_r = clip(kv (r - y), +-speed_limit), u = kvp (v_r - vh) + ki integral of (v_r - vh) dt.

    kv: 1/s. kvp: N*m*s/rad or N*s/m. ki: N*m/rad or N/m. speed_limit: rad/s or m/s. Scalars or (lanes,) arrays.
    The integral stops while the command is beyond the drive's limit and the error would push it further, and is itself
    clamped to that limit.
    """
    return Controller("pi_cascade", _CASCADE, {"kv": kv, "kvp": kvp, "ki": ki, "speed_limit": speed_limit})
