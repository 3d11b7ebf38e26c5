"""Linear least squares over blocks of records, from the blocks' Gram matrices: solved, left out one by one, held out."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

DETERMINED = 1e-10  # eigenvalue of the scaled normal equations, over the largest, above which a direction counts


@dataclass(frozen=True)
class Interval:
    """A value with its 95 % interval."""

    value: float
    low: float
    high: float

    @property
    def sure(self) -> bool:
        """Whether zero lies outside."""
        return self.low > 0.0 or self.high < 0.0

    def __add__(self, more: float) -> "Interval":
        return Interval(self.value + more, self.low + more, self.high + more)


class Blocks:
    """y (N,) = columns (N, p) w, in blocks of rows. parts: the blocks' slices."""

    def __init__(self, columns: np.ndarray, y: np.ndarray, parts: Sequence[slice]):
        self.norms = np.maximum(np.sqrt(np.einsum("ij,ij->j", columns, columns)), 1e-300)
        scaled = columns / self.norms
        self.grams = np.array([scaled[b].T @ scaled[b] for b in parts])
        self.moments = np.array([scaled[b].T @ y[b] for b in parts])
        self.powers = np.array([y[b] @ y[b] for b in parts])

    def __len__(self) -> int:
        return len(self.powers)

    def solved(self, rows: np.ndarray | None = None, held: dict[int, float] | None = None) -> np.ndarray:
        """Return w (p,) of the blocks `rows`, all where None. held: columns whose w is given."""
        rows = np.arange(len(self)) if rows is None else rows
        gram, moment = self.grams[rows].sum(axis=0), self.moments[rows].sum(axis=0)
        w = np.zeros(self.norms.size)
        for k, value in (held or {}).items():
            w[k] = value * self.norms[k]
        free = [k for k in range(w.size) if k not in (held or {})]
        part = gram[np.ix_(free, free)]
        w[free] = np.linalg.pinv(part, rcond=DETERMINED, hermitian=True) @ (moment - gram @ w)[free]
        return w / self.norms

    def errors(self, w: np.ndarray, rows: np.ndarray) -> float:
        """Return the squared error of w over the blocks `rows`."""
        w = w * self.norms
        gram, moment = self.grams[rows].sum(axis=0), self.moments[rows].sum(axis=0)
        return max(float(self.powers[rows].sum() - 2.0 * w @ moment + w @ gram @ w), 0.0)

    def half_widths(self, rows: np.ndarray | None = None, held: dict[int, float] | None = None) -> np.ndarray:
        """Return the half widths (p,) of 95 % intervals by the jackknife over blocks (Efron and Tibshirani 1993, ch. 11);
        infinite of fewer than two blocks."""
        rows = np.arange(len(self)) if rows is None else rows
        if rows.size < 2:
            return np.full(self.norms.size, np.inf)
        each = np.array([self.solved(np.delete(rows, i), held) for i in range(rows.size)])
        spread = (rows.size - 1) / rows.size * np.sum((each - each.mean(axis=0)) ** 2, axis=0)
        return float(stdtrit(rows.size - 1, 0.975)) * np.sqrt(spread)
