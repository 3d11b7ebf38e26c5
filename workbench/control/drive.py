"""The cascade of a closed drive: P on the position, PI on the speed, feed-forward of speed and acceleration, notches.

    v_r = clip(kv (r - y) + forward r', +-speed_limit)
    w = kvp (v_r - vh) + ki integral of (v_r - vh) dt + mass r''
    u = N_n(z) ... N_1(z) w,   N(z) = (b0 + b1 z^-1 + b2 z^-2)/(1 + b1 z^-1 + a2 z^-2)

r' and r'' are differences over a sample. Each notch is Tustin's image of (s^2 + 2 depth damping w s + w^2)/(s^2 + 2 damping w s + w^2),
prewarped at its centre w, as drives compute them (Franklin, Powell, Workman 1998, section 6.1.2).
"""

from collections.abc import Sequence
from functools import cache
from math import pi, tan

import numpy as np

from workbench.control.law import Controller, Law
from workbench.control.laws import cascaded
from workbench.effects.elementary import clip
from workbench.errors import WorkbenchError

NUMBERS = ("kv", "kvp", "ki", "speed_limit", "forward", "mass")
COEFFICIENTS = ("b0", "b1", "b2", "a2")
MOST = 4  # notches


def coefficients(notch, sample_time: float) -> tuple[float, float, float, float]:
    """Return (b0, b1, b2, a2) of a notch with centre (Hz), damping and depth; a1 is b1.

    Raises WorkbenchError where its centre is not below half the sampling rate.
    """
    if not 0.0 < notch.centre < 0.5 / sample_time:
        raise WorkbenchError(
            f"a notch at {notch.centre:g} Hz cannot be computed every {1e3 * sample_time:g} ms: its centre has to lie below "
            f"{0.5 / sample_time:g} Hz."
        )
    w = 2.0 * pi * notch.centre
    k = w / tan(0.5 * w * sample_time)
    wide, deep = 2.0 * notch.damping * w * k, 2.0 * notch.depth * notch.damping * w * k
    whole = k * k + wide + w * w
    return (k * k + deep + w * w) / whole, 2.0 * (w * w - k * k) / whole, (k * k - deep + w * w) / whole, (k * k - wide + w * w) / whole  # fmt: skip


def response(notches: Sequence, theta: np.ndarray, sample_time: float) -> np.ndarray:
    """Return the product of the sampled notches' responses at theta (f,), rad a sample; 1 where there is none."""
    back, out = np.exp(-1j * theta), np.ones(theta.size, dtype=complex)
    for notch in notches:
        b0, b1, b2, a2 = coefficients(notch, sample_time)
        out *= (b0 + b1 * back + b2 * back**2) / (1.0 + b1 * back + a2 * back**2)
    return out


def _step(s, z, p, count: int):
    rate = (s.r - z.asked) / s.dt
    asked = clip(p.kv * s.e + p.forward * rate, -p.speed_limit, p.speed_limit)
    after, u = cascaded(s, z, p, asked, p.mass * (rate - z.asked_rate) / s.dt)
    after |= {"asked": s.r, "asked_rate": rate}
    for i in range(1, count + 1):
        b0, b1, b2, a2 = (getattr(p, f"{n}_{i}") for n in COEFFICIENTS)
        first, second = getattr(z, f"first_{i}"), getattr(z, f"second_{i}")
        through = b0 * u + first
        after |= {f"first_{i}": b1 * u - b1 * through + second, f"second_{i}": b2 * u - a2 * through}
        u = through
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
