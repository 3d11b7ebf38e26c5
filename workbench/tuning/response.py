"""Step response of the linear axis in closed form: y/y_end over tau = w_n t, which only its damping ratio shapes.

    y/y_end = 1 - exp(-zeta tau) (cos(wd t) + zeta tau sinc(wd t)),   (wd t)^2 = tau^2 (1 - zeta^2)

cos and sinc are entire functions of (wd t)^2, so that one formula holds below, at and above zeta = 1.
"""

import numpy as np


def damping_for(overshoot: float) -> float:
    """Return the damping ratio whose step response overshoots by this share: exp(-pi zeta/sqrt(1 - zeta^2))."""
    depth = -np.log(overshoot)
    return float(depth / np.hypot(np.pi, depth))


def overshoot(zeta: np.ndarray) -> np.ndarray:
    """Return the overshoot of a damping ratio, as a share of the final value; 0 where zeta >= 1."""
    zeta = np.asarray(zeta, dtype=float)
    below = np.minimum(zeta, 1.0)
    with np.errstate(divide="ignore"):
        return np.where(zeta < 1.0, np.exp(-np.pi * below / np.sqrt(1.0 - below**2)), 0.0)


def remainder(zeta: np.ndarray, tau: np.ndarray) -> np.ndarray:
    """Return 1 - y/y_end at tau = w_n t; arrays of one shape."""
    zeta, tau = np.broadcast_arrays(np.asarray(zeta, dtype=float), np.asarray(tau, dtype=float))
    fast = np.sqrt(np.maximum(zeta**2 - 1.0, 0.0)) * tau
    turn = np.sqrt(np.maximum(1.0 - zeta**2, 0.0)) * tau
    with np.errstate(invalid="ignore", divide="ignore"):
        slowest = np.exp(
            -tau / (zeta + np.sqrt(np.maximum(zeta**2 - 1.0, 0.0)))
        )  # exp(-(zeta tau - fast)), digits kept
        over = (
            slowest
            * (1.0 + np.exp(-2.0 * fast) + zeta * tau * np.where(fast > 1e-9, -np.expm1(-2 * fast) / fast, 2.0))
            / 2
        )
        under = np.exp(-zeta * tau) * (np.cos(turn) + zeta * tau * np.sinc(turn / np.pi))
    return np.where(zeta < 1.0, under, over)


def enter_time(zeta: np.ndarray, band: float = 0.01) -> np.ndarray:
    """Return tau = w_n t at which the response first enters the band, by bisection; it stays if overshoot <= band."""
    zeta = np.asarray(zeta, dtype=float)
    turn = np.sqrt(np.maximum(1.0 - zeta**2, 0.0))
    slow = (zeta + np.sqrt(np.maximum(zeta**2 - 1.0, 0.0))) * (2.0 - np.log(band)) + 10.0
    low, high = np.zeros_like(zeta), np.where(turn > 0.0, np.minimum(slow, np.pi / np.maximum(turn, 1e-9)), slow)
    for _ in range(60):
        middle = (low + high) / 2.0
        inside = remainder(zeta, middle) <= band
        low, high = np.where(inside, low, middle), np.where(inside, middle, high)
    return high


def speed_ratio(zeta: np.ndarray) -> np.ndarray:
    """Return the peak speed of the step response over y_end w_n: exp(-zeta acos(zeta)/sqrt(1 - zeta^2))."""
    zeta = np.asarray(zeta, dtype=float)
    root = np.sqrt(np.abs(1.0 - zeta**2))
    with np.errstate(invalid="ignore", divide="ignore"):
        angle = np.where(zeta < 1.0, np.arccos(np.minimum(zeta, 1.0)), np.arccosh(np.maximum(zeta, 1.0))) / root
    return np.exp(-zeta * np.where(root < 1e-6, 1.0, angle))
