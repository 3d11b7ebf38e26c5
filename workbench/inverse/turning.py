"""Where friction turns along a motion that is known before and after: where its speed passes zero.

A stop operator on the readings says *that* a body has turned, some counts after it has; the speed, filtered without phase, says *when*.
At 10 rad/s^2 and 1e-5 rad a count, three counts are 2.4 ms, and a Coulomb friction that turns so late leaves a tenth of itself. In a
simulation, as in firmware, the stop operator is the direction: there nobody knows what comes.
"""

import numba
import numpy as np

FULL = 1.0 - 1e-9  # of a stop operator's width: it slides


def turned(direction: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return the direction (n,), between -1 and 1, turned where the speed passes zero.

    direction: of a stop operator, dir = x/w, (n,). v: the body's speed, rad/s or m/s, (n,). Where the operator goes from one side to the
    other, the turn is put to the last moment at which the body still moved the old way, read between samples: the sample about it takes
    the mean of its own interval. What the operator does within its width stays.
    """
    return _turned(np.ascontiguousarray(direction), np.ascontiguousarray(v), FULL)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _turned(x, v, full):
    """Return what `turned` does."""
    result = x.copy()
    old, since, last = (
        0.0,
        0,
        0,
    )  # the way of a body that slides, where it turned to it, and where it was last seen to go it
    for j in range(x.size):
        if abs(x[j]) < full:
            continue
        new = 1.0 if x[j] > 0.0 else -1.0
        if old * new < 0.0:
            m = j - 1
            while m > since and old * v[m] <= 0.0:
                m -= 1
            turn = last + 0.5  # where the speed says nothing
            if old * v[m] > 0.0 >= old * v[m + 1]:
                turn = m + v[m] / (v[m] - v[m + 1])
            at = int(np.floor(turn + 0.5))
            result[min(last, at) : at] = old
            result[at] = 2.0 * old * (turn - at)
            result[at + 1 : j + 1] = new
            since = at
        old, last = new, j
    return result
