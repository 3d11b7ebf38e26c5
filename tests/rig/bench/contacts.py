"""Contacts: bristles that slip at their own break-away distances, and the virgin curves that stand for them."""

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import norm

SPREAD, FARTHEST = 40, 12.0  # bristles of a contact, and the longest over the median


def lognormal(median: float, sigma: float, many: int = SPREAD) -> np.ndarray:
    """Bristles (many, 2) of equal shares whose break-away distances are the quantiles of a lognormal distribution."""
    quantiles = norm.ppf((np.arange(many) + 0.5) / many)
    d = median * np.minimum(np.exp(sigma * quantiles), FARTHEST)
    return np.column_stack([d, np.full(many, 1.0 / many)])


def virgin(bristles: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The force of height one along a first push to x (n,)."""
    return np.minimum(x[:, None] / bristles[:, 0], 1.0) @ bristles[:, 1]


def stretched(bristles: np.ndarray) -> tuple[float, float]:
    """Return (x0, d) of the curve 1 - exp(-(x/x0)^d) that comes nearest to a contact's virgin curve."""
    middle = float(np.median(bristles[:, 0]))
    x = middle * np.geomspace(0.02, 30.0, 120)
    h = virgin(bristles, x)
    fit = least_squares(lambda p: 1 - np.exp(-((x / middle / np.exp(p[0])) ** np.exp(p[1]))) - h, [0.0, 0.0])
    return middle * float(np.exp(fit.x[0])), float(np.exp(fit.x[1]))


def of_curve(x0: float, d: float) -> np.ndarray:
    """Bristles whose virgin curve is 1 - exp(-(x/x0)^d), in straight pieces between 60 lengths."""
    x = x0 * np.concatenate([[0.0], np.geomspace(0.01, 40.0 ** (1 / min(d, 1.0)), 60)])
    h = 1 - np.exp(-((x / x0) ** d))
    slopes = np.append(np.diff(h) / np.diff(x), 0.0)
    return np.column_stack([x[1:], x[1:] * (slopes[:-1] - slopes[1:])])
