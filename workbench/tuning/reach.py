"""How stiff a loop may be along a line Kp/Kd = ratio: the Kp at which |S| first meets its limit, in closed form.

With L = Kp G, G(theta) = position (1 + difference/ratio), the limit |1 + Kp G| >= 1/Ms is a quadratic in Kp at each
frequency, and forbids the interval between its roots. The intervals around the border of stability, the smallest Kp at which
G crosses the negative real axis above the axis' own resonance, join to one; what lies below them is allowed. A soft loop on
an undamped spring may have further intervals of its own near Kp = 0: who asks for gains there checks them.
"""

import numpy as np

from workbench.tuning import sampled
from workbench.tuning.axis import Axis
from workbench.tuning.start import FLOOR, stable_box

LINES = 600  # frequencies; the peak between two of them is larger by 1e-4 at most
LOWEST = 1e-3  # rad a sample
JOINED = 1e-9  # relative: intervals that touch are one
ROUNDS = 60  # of joining; each takes the lowest end of all intervals that overlap


def stiffest(axis: Axis, ratio: np.ndarray, sensitivity: float) -> np.ndarray:
    """Return the largest Kp (n, m), in units of the sample, that keeps |S| <= sensitivity with Kd = Kp/ratio.

    ratio (n, m): Kp/Kd at each amplitude of the axis, per sample. The spring of the axis counts, its loss does not: it damps.
    """
    theta = np.geomspace(LOWEST, np.pi, LINES)
    motion = sampled.steps(axis.stiffness, np.full(axis.amplitude.size, axis.damping), axis.clock)
    position, rate = sampled.response(theta, motion, axis.clock), sampled.difference(theta, axis.clock)
    own = np.sqrt(axis.stiffness)
    rows = zip(position, ratio, own, strict=True)
    most = np.stack([_one(p, 1.0 + rate / r[:, None], theta > w, sensitivity) for p, r, w in rows])
    border = stable_box(axis)[0][:, None]  # of a slow loop no line may meet |S| below the Nyquist frequency
    return np.clip(np.where(np.isfinite(most), most, border), FLOOR * border, border)


def _one(position: np.ndarray, law: np.ndarray, above: np.ndarray, sensitivity: float) -> np.ndarray:
    """Return the largest Kp (m,) of one axis: position (f,), law (m, f), above (f,): frequencies beyond its resonance."""
    line = position * law
    size = np.abs(line) ** 2
    turn = line.real**2 - size * (1.0 - sensitivity**-2.0)
    forbidden = (line.real < 0.0) & (turn > 0.0)
    root = np.sqrt(np.where(forbidden, turn, 0.0))
    low = np.where(forbidden, (-line.real - root) / size, np.inf)
    high = np.where(forbidden, (-line.real + root) / size, -np.inf)
    crossing = (line.imag[:, 1:] * line.imag[:, :-1] <= 0.0) & (line.real[:, 1:] < 0.0) & above[:-1]
    most = np.where(crossing, -1.0 / line.real[:, 1:], np.inf).min(axis=1)
    most = np.where(np.isfinite(most), most, low.min(axis=1))
    for _ in range(ROUNDS):
        over = (low < most[:, None]) & (high * (1.0 + JOINED) >= most[:, None])
        lower = np.where(over, low, np.inf).min(axis=1)
        if not (lower < most).any():
            break
        most = np.minimum(most, lower)
    return most
