"""Moments at which the level of a residual jumps and stays: a coupling that slipped, counts that were lost between two encoders.

What is left after such a jump is everywhere, and yet it has few causes, each at its moment. ChangePoints are found one after another,
each where a step of the level takes away most, with all levels and the model fitted anew in between (binary segmentation with
refits: Vostrikova 1981); those that the others made needless are taken out again.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.identification.cross_validation import Deviations

LEAST = 0.005  # of the excess that a jump must take away
CERTAIN = 50.0  # times the floor's power of one sample that it must take away, too
MOST = 60  # jumps
PAUSE = 0.25  # s without samples that parts records


@dataclass(frozen=True, eq=False)
class ChangePoints:
    """times: of each jump, s. residual (N,): what is left of a model whose level jumps there, and from record to record."""

    times: tuple[float, ...]
    residual: np.ndarray


def change_points(
    residual: np.ndarray, t: np.ndarray, drive: np.ndarray, floor: np.ndarray, model: Deviations
) -> ChangePoints:
    """Return the jumps of the level of a residual (N,).

    t, drive, floor: (N,), time, whether a row is the drive's balance, rms of the floor. What joins two bodies enters the
    drive's balance and, the other way, the load's.
    """
    rows, starts = _records(t, drive)
    edges = [*starts, rows.size]
    enough = max(
        LEAST * float(np.sum(residual[rows] ** 2 - floor[rows] ** 2)), CERTAIN * float(np.mean(floor[rows] ** 2))
    )

    levels = PiecewiseOffset(residual, drive, model)

    def fitted(found: list[int]) -> tuple[np.ndarray, np.ndarray]:
        return levels.fitted(rows[np.sort([*starts, *found])])

    found: list[int] = []
    while len(found) < MOST:
        gain, at = _best_split(fitted(found)[0][rows], sorted([*edges, *found]))
        if not gain > enough:
            break
        found.append(at)
    while found:  # what an early step did for others is needless when they are there
        faintest, at = _least_step(fitted(found)[1], sorted([*edges, *found]), set(found))
        if faintest > enough:
            break
        found.remove(at)
    return ChangePoints(tuple(sorted(float(t[rows[k]]) for k in found)), fitted(found)[0])


def _records(t: np.ndarray, drive: np.ndarray) -> tuple[np.ndarray, list[int]]:
    """Return the rows of the drive's balance, and where records begin among them."""
    rows = np.flatnonzero(drive)
    return rows, [0, *(np.flatnonzero(np.diff(t[rows]) > PAUSE) + 1).tolist()]


def with_change_points(
    residual: np.ndarray, t: np.ndarray, drive: np.ndarray, model: Deviations, times: Sequence[float]
) -> np.ndarray:
    """Return what a model leaves of a residual (N,) where its level may jump at these times, s, and from record to record; after
    the last sample nothing jumps."""
    rows, starts = _records(t, drive)
    at = np.searchsorted(t[rows], times)
    return PiecewiseOffset(residual, drive, model).fitted(rows[np.unique([*starts, *at[at < rows.size]])])[0]


class PiecewiseOffset:
    """Fits of a model whose level may differ from segment to segment, from running sums of its columns.

    residual, drive: (N,), as of `change_points`.
    """

    def __init__(self, residual: np.ndarray, drive: np.ndarray, model: Deviations):
        self.residual, self.columns = residual, model.columns
        self.sign = np.where(drive, 1.0, -1.0)
        self.gram, self.moment = model.columns.T @ model.columns, model.columns.T @ residual
        signed = np.column_stack([model.columns, residual]) * self.sign[:, None]
        self.sums = np.vstack([np.zeros(signed.shape[1]), np.cumsum(signed, axis=0)])

    def fitted(self, begins: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what the model with a level of its own in each segment leaves, and the levels. begins: first rows of segments."""
        edges = np.array([0, *begins[1:], self.residual.size])
        counts, within = np.diff(edges), np.diff(self.sums[edges], axis=0)
        gram = np.block([[self.gram, within[:, :-1].T], [within[:, :-1], np.diag(counts)]])
        gram[np.diag_indices_from(gram)] += 1e-9 * np.trace(gram) / len(gram)
        d = np.linalg.solve(gram, np.concatenate([self.moment, within[:, -1]]))
        deviation, levels = np.split(d, [len(self.gram)])
        return self.residual - self.columns @ deviation - self.sign * np.repeat(levels, counts), levels


def _best_split(x: np.ndarray, edges: list[int]) -> tuple[float, int]:
    """Return (power that it takes away, first sample after it) of the best step of the level within a segment of x (n,)."""
    best, at = 0.0, 0
    for a, b in zip(edges[:-1], edges[1:], strict=True):
        if b - a < 2:
            continue
        sums = np.cumsum(x[a:b])
        n = np.arange(1, b - a)
        before, after = sums[:-1], sums[-1] - sums[:-1]
        gains = before**2 / n + after**2 / (b - a - n) - sums[-1] ** 2 / (b - a)
        k = int(np.argmax(gains))
        if gains[k] > best:
            best, at = float(gains[k]), a + k + 1
    return best, at


def _least_step(levels: np.ndarray, edges: list[int], found: set[int]) -> tuple[float, int]:
    """Return (power that it takes away, where it is) of the least step between levels (segments,) at one of `found`."""
    counts = np.diff(edges)
    steps = [
        (float((levels[k] - levels[k - 1]) ** 2 * counts[k] * counts[k - 1] / (counts[k] + counts[k - 1])), edges[k])
        for k in range(1, len(counts))
        if edges[k] in found
    ]
    return min(steps)
