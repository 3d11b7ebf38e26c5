"""How stiff a loop may be along a line Kp/Kd = ratio: the Kp at which |S| first meets its limit, in closed form.

With L = Kp G, G(theta) = position (1 + difference/ratio), the limit |1 + Kp G| >= 1/Ms is a quadratic in Kp at each
frequency, and forbids the interval between its roots. The intervals around the border of stability, the smallest Kp at which
G crosses the negative real axis above the axis' own resonance, join to one; what lies below them is allowed. A soft loop on
an undamped spring may have further intervals of its own near Kp = 0: who asks for gains there checks them.
"""

import numba
import numpy as np

from workbench.tuning import sampled
from workbench.tuning.axis import Axis
from workbench.tuning.start import FLOOR, stable_box

LINES = 600  # frequencies; the peak between two of them is larger by 1e-4 at most
LOWEST = 1e-3  # rad a sample
JOINED = 1e-9  # relative: intervals that touch are one


def stiffest(axis: Axis, ratio: np.ndarray, sensitivity: float) -> np.ndarray:
    """Return the largest Kp (n, m), in units of the sample, that keeps |S| <= sensitivity with Kd = Kp/ratio.

    ratio (n, m): Kp/Kd at each amplitude of the axis, per sample. The spring of the axis counts, its loss does not: it damps.
    """
    theta = np.geomspace(LOWEST, np.pi, LINES)
    motion = sampled.steps(axis.stiffness, np.full(axis.amplitude.size, axis.damping), axis.clock)
    position, rate = sampled.response(theta, motion, axis.clock), sampled.difference(theta, axis.clock)
    own = np.sqrt(axis.stiffness)
    rows = zip(position, ratio, own, strict=True)
    most = np.stack([stiffest_along(p[None], rate, r, (theta > w)[None], sensitivity) for p, r, w in rows])
    border = stable_box(axis)[0][:, None]  # of a slow loop no line may meet |S| below the Nyquist frequency
    return np.clip(np.where(np.isfinite(most), most, border), FLOOR * border, border)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def stiffest_along(position, rate, ratio, above, sensitivity):
    """Return the largest Kp (m,), the smallest over axes, that keeps |S| <= sensitivity with Kd = Kp/ratio.

    position (axes, f), rate (f,): responses from torque to position, with all that is behind the law, and of the filtered difference.
    ratio (m,). above (axes, f): frequencies beyond an axis' own resonance. Infinite where no frequency limits Kp.
    """
    out = np.full(ratio.size, np.inf)
    low, high = np.empty(rate.size), np.empty(rate.size)
    for i in range(len(position)):
        for j in range(ratio.size):
            least, most, before = np.inf, np.inf, 0.0
            for k in range(rate.size):
                line = position[i, k] * (1.0 + rate[k] / ratio[j])
                size = line.real**2 + line.imag**2
                turn = line.real**2 - size * (1.0 - sensitivity**-2.0)
                forbidden = line.real < 0.0 and turn > 0.0
                root = np.sqrt(turn) if forbidden else 0.0
                low[k] = (-line.real - root) / size if forbidden else np.inf
                high[k] = (-line.real + root) / size if forbidden else -np.inf
                least = min(least, low[k])
                if k and line.imag * before <= 0.0 and line.real < 0.0 and above[i, k - 1]:
                    most = min(most, -1.0 / line.real)
                before = line.imag
            most = most if most < np.inf else least
            joined = most < np.inf
            while joined:  # the lower end of all intervals that overlap
                joined = False
                for k in range(rate.size - 1, -1, -1):
                    if low[k] < most and high[k] * (1.0 + JOINED) >= most:
                        most, joined = low[k], True
            out[j] = min(out[j], most)
    return out
