"""A sampled signal at other times: shifted by a delay, or at a finer rate."""

import math
import operator
from collections.abc import Sequence
from itertools import accumulate

import numba
import numpy as np

LAGRANGE = 8  # points of the interpolation in time; error below 1e-3 up to 0.35 of the sampling rate
# Steps a sample of a command map that integrates over dt. A command is band-limited, no ramp between samples: taken as
# one, a lag below the sample time damps 90 Hz at 1 kHz six times too much. Odd, so that the inverse of such a step,
# which rings at half its rate, rings at half the sampling rate, where the evaluation filter leaves nothing.
FINER = 7
POINTS = range(1 - LAGRANGE // 2, LAGRANGE // 2 + 1)
SCALE = np.array([1.0 / math.prod(i - j for j in POINTS if j != i) for i in POINTS])


def weights(u) -> list:
    """Return Lagrange's weights of the samples -3 to 4 about a place u in [0, 1) between the samples 0 and 1.

    Of the products over all points but one, those over the points before it and those behind it.
    """
    away = [u - j for j in POINTS]
    before = list(accumulate(away[:-1], operator.mul, initial=1.0))
    behind = list(accumulate(away[:0:-1], operator.mul, initial=1.0))[::-1]
    return [k * a * b for k, a, b in zip(SCALE, before, behind, strict=True)]


def between(x: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Return x (n,) read at `steps` (m,), in samples and fractions of one, by 8-point Lagrange interpolation.

    Beyond the ends the first or last value is held.
    """
    return _between(np.ascontiguousarray(x), np.ascontiguousarray(steps, dtype=float), SCALE)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _between(x, steps, scale):
    """Return what `between` does, with the operations of `weights` in their order, so that the bits are those of `shifted`."""
    n, half = len(scale), len(scale) // 2
    away, behind, result = np.empty(n), np.empty(n), np.empty(steps.size)
    for m in range(steps.size):
        whole = np.floor(steps[m])
        u = steps[m] - whole
        for i in range(n):
            away[i] = u - (1 - half + i)
        behind[n - 1] = 1.0
        for i in range(n - 1, 0, -1):
            behind[i - 1] = behind[i] * away[i]
        before, value = 1.0, 0.0
        for i in range(n):
            at = min(max(int(whole) + (1 - half) + i, 0), x.size - 1)
            value += scale[i] * before * behind[i] * x[at]
            before *= away[i]
        result[m] = value
    return result


class Places:
    """Where many signals are read: `steps` (m,), as of `between`, by weights that are found once."""

    def __init__(self, steps: np.ndarray):
        whole = np.floor(steps)
        self.first = whole.astype(np.int64) + (1 - LAGRANGE // 2)
        self.weights = np.stack(weights(steps - whole), axis=1)

    def read(self, x: np.ndarray) -> np.ndarray:
        """Return x (n,) there, (m,), with the bits of `between`."""
        return _read(np.ascontiguousarray(x), self.first, self.weights)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _read(x, first, weights):
    """Return the sums (m,) of weights (m, 8) times the samples of x from `first` (m,) on, those beyond the ends held."""
    result, last = np.empty(first.size), x.size - 1
    for m in range(first.size):
        value, at = 0.0, first[m]
        if at >= 0 and at + weights.shape[1] <= x.size:
            for i in range(weights.shape[1]):
                value += weights[m, i] * x[at + i]
        else:
            for i in range(weights.shape[1]):
                value += weights[m, i] * x[min(max(at + i, 0), last)]
        result[m] = value
    return result


def shifted(x: np.ndarray, delay: np.ndarray | float, dt: float) -> np.ndarray:
    """Return x(t - delay) for x (n,) sampled every dt, delay scalar or (n,) in s, by 8-point Lagrange interpolation.

    Beyond the ends the first or last value is held.
    """
    steps = -np.asarray(delay, dtype=float) / dt
    if steps.ndim and np.all(steps == steps[0]):  # one delay: the same weights everywhere
        steps = steps[0]
    if steps.ndim:
        return between(x, np.arange(x.size) + steps)
    return _beside(x, [float(steps)])


def finer(x: np.ndarray) -> np.ndarray:
    """Return x (n,) at FINER times its rate, (n FINER,), by the same interpolation; every FINER-th value is x itself."""
    return _beside(x, [k / FINER for k in range(FINER)])


def _beside(x: np.ndarray, steps: Sequence[float]) -> np.ndarray:
    """Return x (n,) read at `steps` (k,) from each of its samples, those of a sample side by side, (n k,)."""
    whole = [math.floor(s) for s in steps]
    by = np.array([weights(s - w) for s, w in zip(steps, whole, strict=True)])
    return _sums(np.ascontiguousarray(x, dtype=float), np.array(whole) + (1 - LAGRANGE // 2), by)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _sums(x, first, weights):
    """Return the sums (n k,) of weights (k, 8) times the samples of x from `first` (k,) on, counted from each; those beyond the ends held."""
    steps, size = first.size, x.size
    result = np.empty(size * steps)
    for k in range(steps):
        before = min(max(-first[k], 0), size)
        behind = max(min(size, size - first[k] - (LAGRANGE - 1)), before)
        for n in range(before, behind):  # without a branch: several at once
            value = 0.0
            for i in range(LAGRANGE):
                value += weights[k, i] * x[n + first[k] + i]
            result[n * steps + k] = value
        for ends in (range(before), range(behind, size)):
            for n in ends:
                value = 0.0
                for i in range(LAGRANGE):
                    value += weights[k, i] * x[min(max(n + first[k] + i, 0), size - 1)]
                result[n * steps + k] = value
    return result
