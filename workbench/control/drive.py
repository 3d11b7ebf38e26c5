"""The cascade of a closed drive: P on the position, PI on the speed, feed-forward of speed and acceleration, notches.

    v_r = clip(kv (r - y) + forward r', +-speed_limit)
    w = kvp (v_r - vh) + ki integral of (v_r - vh) dt + mass r''
    u = N_n(z) ... N_1(z) w

r' and r'' are differences over a sample; the notches N are those of `notched`.
"""

from collections.abc import Sequence
from functools import cache

from workbench.control.law import Controller, Law
from workbench.control.laws import cascaded
from workbench.control.notched import COEFFICIENTS, coefficients, passed
from workbench.effects.elementary import clip
from workbench.errors import WorkbenchError

NUMBERS = ("kv", "kvp", "ki", "speed_limit", "forward", "mass")
MOST = 4  # notches


def _step(s, z, p, count: int):
    rate = (s.r - z.asked) / s.dt
    asked = clip(p.kv * s.e + p.forward * rate, -p.speed_limit, p.speed_limit)
    after, u = cascaded(s, z, p, asked, p.mass * (rate - z.asked_rate) / s.dt)
    after |= {"asked": s.r, "asked_rate": rate}
    for i in range(1, count + 1):
        own = (getattr(p, f"{n}_{i}") for n in COEFFICIENTS)
        u, first, second = passed(u, own, getattr(z, f"first_{i}"), getattr(z, f"second_{i}"))
        after |= {f"first_{i}": first, f"second_{i}": second}
    return after, u


@cache
def _law(count: int) -> Law:
    each = range(1, count + 1)
    return Law(
        "drive_cascade" + f", notches: {count}" * (count > 0),
        (*NUMBERS, *(f"{n}_{i}" for i in each for n in COEFFICIENTS)),
        lambda s, z, p: _step(s, z, p, count),
        states=("integral", "asked", "asked_rate", *(f"{n}_{i}" for i in each for n in ("first", "second"))),
        start=lambda target, reading: {"asked": target},
    )


def drive_cascade(
    kv, kvp, ki, speed_limit, *, sample_time: float, notches: Sequence = (), forward=0.0, mass=0.0
) -> Controller:
    """The cascade of the module. kv: 1/s. kvp: N*m*s/rad or N*s/m. ki: N*m/rad or N/m. speed_limit: rad/s or m/s.

    Scalars or (lanes,) arrays. notches: up to four, each with centre (Hz), damping, depth. sample_time: s, of the loop that runs
    it. forward: share of the reference's speed. mass: kg*m^2 or kg, of its acceleration. Raises WorkbenchError for more notches.
    """
    if len(notches) > MOST:
        raise WorkbenchError(f"a drive's cascade has up to {MOST} notches; {len(notches)} are given.")
    values = dict(zip(NUMBERS, (kv, kvp, ki, speed_limit, forward, mass), strict=True))
    for i, notch in enumerate(notches, 1):
        values |= {f"{n}_{i}": c for n, c in zip(COEFFICIENTS, coefficients(notch, sample_time), strict=True)}
    return Controller("drive_cascade", _law(len(notches)), values)
