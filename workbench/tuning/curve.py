"""The damping ratio that enters the band at tau = w_n t, as a polynomial in log tau: free final time, without an equation.

1 - y(tau, zeta)/y_end = band has one solution zeta for each tau, smooth through zeta = 1. Interpolated once for a goal at
Chebyshev points of log tau, log zeta is right to 1e-6 and the log of the peak speed as well; the solution is made exact
afterwards (`solve`).
"""

from functools import cache

import numpy as np

from workbench.tuning import response

DEGREE = 32
SLUGGISH = 30.0  # the largest damping ratio that is considered


def damping_at(tau: np.ndarray, band: float, least: float) -> np.ndarray:
    """Return zeta >= least of the response that enters the band at tau, by bisection on log zeta; shape of tau."""
    low, high = np.full(np.shape(tau), np.log(least) - 0.1), np.full(np.shape(tau), np.log(SLUGGISH) + 0.1)
    for _ in range(52):
        middle = (low + high) / 2.0
        late = response.remainder(np.exp(middle), tau) > band
        low, high = np.where(late, low, middle), np.where(late, middle, high)
    return np.exp((low + high) / 2.0)


@cache
def curve(band: float, least: float) -> tuple[np.ndarray, np.ndarray]:
    """Return (range, coefficients): range (2,) of log tau for zeta from `least` to SLUGGISH, and the Chebyshev coefficients
    (2, DEGREE + 1) of log zeta and log(peak speed/(y_end w_n)) over it."""
    ends = np.log(response.enter_time(np.array([least, SLUGGISH]), band))
    points = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    zeta = damping_at(np.exp(ends.mean() + np.diff(ends) / 2.0 * points), band, least)
    values = np.stack([np.log(zeta), np.log(response.speed_ratio(zeta))], axis=1)
    return ends, np.polynomial.chebyshev.chebfit(points, values, DEGREE).T.copy()


def clenshaw(coefficients, x):
    """Return sum_k c_k T_k(x) of a sequence of coefficients; works on SX as on floats."""
    ahead, after = 0.0, 0.0
    for k in range(DEGREE, 0, -1):
        ahead, after = coefficients[k] + 2.0 * x * ahead - after, ahead
    return coefficients[0] + x * ahead - after
