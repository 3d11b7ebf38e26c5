"""What does not repeat: how far a residual differs where the same motion is met again.

A model whose force is a function of the motion gives the same force in the same state (position, velocity, acceleration),
so what differs between two visits of one state is what no such model explains: noise of the drive and its sensor, and
friction that is another one from visit to visit. It needs no band that is quiet, so it holds where signals were filtered
before they were logged.
"""

from dataclasses import dataclass

import numpy as np

from workbench.motion import Motion

REACH = {"q": 1e-3, "v": 1e-2, "a": 3e-2}  # of their largest size: how far apart two visits of one state may be
NORMAL = 0.6745  # median of |x| of a standard normal


@dataclass(frozen=True)
class Repeats:
    """rms: of the part that does not repeat. robust: the same from the median, for a normal one. Both as the residual.

    share: of the samples that met their state again; pairs: how many. Both rms are NaN where there is none.
    """

    rms: float
    robust: float
    share: float
    pairs: int


def _states(motion: Motion, scale: dict[str, float]) -> np.ndarray:
    """Return (n, 3) the states of the samples that count, in units of how far apart two visits may be."""
    return np.column_stack([getattr(motion, n)[motion.keep] / (REACH[n] * scale[n]) for n in REACH])


def _scales(*motions: Motion) -> dict[str, float]:
    """Return the largest size of position (its travel), velocity and acceleration over the motions."""
    inside = [{n: getattr(m, n)[m.keep] for n in REACH} for m in motions]
    size = {
        n: max(max(float(np.ptp(s[n])) if n == "q" else float(np.abs(s[n]).max()), 0.0) for s in inside) for n in REACH
    }
    return {n: x or 1.0 for n, x in size.items()}


def _summary(difference: np.ndarray, count: int) -> Repeats:
    """Return the Repeats of differences between visits, each visit with noise of its own."""
    if difference.size == 0:
        return Repeats(float("nan"), float("nan"), 0.0, 0)
    rms = float(np.sqrt(np.mean(difference**2) / 2.0))
    robust = float(np.median(np.abs(difference)) / NORMAL / np.sqrt(2.0))
    return Repeats(rms, robust, difference.size / count, difference.size)


def repeats(motion: Motion, residual: np.ndarray, apart: float = 0.5) -> Repeats:
    """Return what of a residual (n,) does not repeat within one record: rms of d/sqrt(2), d between two visits.

    Each sample is paired with that of the nearest state at least `apart` seconds away. Take the residual of the best model
    at hand, filtered as it is judged: what a model explains does not then vary within REACH.

    Limits. Slow drift counts as what does not repeat. Hidden states (where friction with memory came from) are held to be
    the same, which periodic motion makes true. Where few samples meet their state again (`share`), it speaks of those
    alone. What varies within REACH and is not in the model is counted too, so that it is an upper bound there.
    """
    from scipy.spatial import cKDTree

    points, r, t = _states(motion, _scales(motion)), residual[motion.keep], motion.t[motion.keep]
    distance, index = np.full(t.size, np.inf), np.zeros(t.size, int)
    step = max(1, int(apart / motion.dt))
    for first in range(0, t.size, step):  # a tree for each stretch, of what lies `apart` from all of it
        part = np.arange(first, min(first + step, t.size))
        other = np.flatnonzero((t < t[part[0]] - apart) | (t > t[part[-1]] + apart))
        if other.size:
            d, i = cKDTree(points[other]).query(points[part])
            distance[part], index[part] = d, other[i]
    met = distance <= 1.0
    return _summary(r[met] - r[index[met]], t.size)


def between(one: Motion, first: np.ndarray, other: Motion, second: np.ndarray) -> Repeats:
    """Return what of residual `second` (n,) on `other` is not what residual `first` was on `one` in the same state.

    rms of the whole difference, not divided by sqrt(2): the least that is left on `other` by whoever knows `one` alone, as
    measured, noise of both included.
    """
    from scipy.spatial import cKDTree

    size = _scales(one, other)
    distance, index = cKDTree(_states(one, size)).query(_states(other, size))
    met = distance <= 1.0
    found = _summary(second[other.keep][met] - first[one.keep][index[met]], distance.size)
    return Repeats(found.rms * np.sqrt(2.0), found.robust * np.sqrt(2.0), found.share, found.pairs)
