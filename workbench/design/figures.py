"""Figures of one step of the ladder, by its trajectory: time into the band about the own final value, error, overshoot."""

import numba
import numpy as np

COUNTS = 2.0  # of the encoder: what no error, overshoot or band is asked to be below
BAND = 0.01  # of a step: its band, and where that is less than COUNTS counts, these
LAST = 0.1  # of a step's time, over which the error is the largest that is left
# Of a step that a response has to go: one that hardly moves is in the band of its own final value at once.
ANSWERED = 0.5
FIGURES = ("time", "error", "overshoot")


def step_figures(q: np.ndarray, target: float, size: float, count: float, dt: float) -> np.ndarray:
    """Return (n, 3) of a step of a signed size: time into the band about the own final value to stay, the largest error at the end, and the
    overshoot beyond the own final value over the size, of a step of which BAND is less than COUNTS counts over one of which it is as much.

    Own final value: the middle of what a step ends in."""
    with np.errstate(all="ignore"):
        samples, each = len(q), np.arange(q.shape[1])
        way, band = float(np.sign(size)), max(BAND * abs(size), COUNTS * count)
        end = max(int(LAST * samples), 1)
        # the middle of what is left at the end: of a loop that plays within a count, one sample would be wherever it is just then
        final = 0.5 * (q[-end:].max(axis=0) + q[-end:].min(axis=0))
        last, beyond, error, finite = _along(q, np.ascontiguousarray(final), way, float(band), float(target), end)
        after = np.minimum(last + 1, samples - 1)
        outer, inner = (np.abs(q[k, each] - final) for k in (last, after))
        time = (last + np.clip((outer - band) / np.maximum(outer - inner, 1e-300), 0.0, 1.0)) * dt
        over = BAND * beyond / band
        answered = way * (final - q[0]) >= ANSWERED * abs(size)
        fine = finite & (last < samples - end) & answered
        return np.stack([np.where(fine, v, np.inf) for v in (time, error, over)], axis=1)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _along(q, final, way, band, target, end):
    """Return, of each column of q (samples, n), the last sample out of the band about `final` (n,) or 0, how far it goes beyond, the largest
    |target - q| over the last `end` samples, and whether all is finite: in one pass, where NumPy takes eight."""
    samples, n = q.shape
    last, beyond, error = np.zeros(n, np.int64), np.zeros(n), np.zeros(n)
    finite = np.ones(n, np.bool_)
    for k in range(samples):
        for j in range(n):
            left = q[k, j] - final[j]
            last[j] = k if abs(left) > band else last[j]
            beyond[j] = max(beyond[j], way * left)
            finite[j] = finite[j] and np.isfinite(left)
    for k in range(samples - end, samples):
        for j in range(n):
            error[j] = max(error[j], abs(target - q[k, j]))
    return last, beyond, error, finite
