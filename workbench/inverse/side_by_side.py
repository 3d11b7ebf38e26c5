"""The balances of a record as one vector of the samples in which errors count, those of a sample side by side."""

import numpy as np


def stacked(balances: np.ndarray, keep: slice, counts: np.ndarray | None = None) -> np.ndarray:
    """Return (rows, n) as one vector of the samples kept, the balances of a sample side by side.

    counts: (rows or more, n) of bool, where a sample's balance counts; all where absent. Elsewhere it is zero.
    """
    if counts is not None:
        balances = np.where(counts[: len(balances)], balances, 0.0)
    if len(balances) == 1:
        return balances[0, keep]
    rows = len(balances)
    found = np.empty(rows * (keep.stop - keep.start))
    for r, balance in enumerate(balances):
        found[r::rows] = balance[keep]
    return found


def entered(outputs: np.ndarray, lever: np.ndarray) -> np.ndarray:
    """Return outputs (columns, n) as they enter the balances, (columns, rows, n). lever: (rows, n or 1)."""
    return outputs[:, None, :] * lever


def entering(
    column: np.ndarray, lever: np.ndarray, mean: float, keep: slice, counts: np.ndarray | None = None
) -> np.ndarray:
    """Return a force's column (n,) as it enters the balances by a lever (rows, 1) that does not change in time, as `stacked` does.

    mean: of the force, unfiltered, where the joint's mean torque closes the load's balance (`zeros.closed`), 0 else.
    """
    rows, inside = len(lever), column[keep]
    if rows == 1:
        found = inside * lever[0, 0]
        return found if counts is None else np.where(counts[0, keep], found, 0.0)
    found, closing = np.empty(rows * inside.size), mean * lever[1, 0]
    for r, sign in enumerate((1.0, -1.0)):
        values = inside * lever[r, 0] + sign * closing
        found[r::rows] = values if counts is None else np.where(counts[r, keep], values, 0.0)
    return found
