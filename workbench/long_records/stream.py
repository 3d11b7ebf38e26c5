"""Weights of hysteresis operators from a long record: operators are run in blocks, and no regressor is stored.

y ~ sum_i w_i O_i[x] + sum_j c_j column_j, O_i play or stop operators of given thresholds (a Maxwell-slip element is a stop
operator, its slip the threshold). The Gram matrix of [columns, operators, y] is all that the least squares needs of the
samples, and it is summed over blocks that stay in the second-level cache. Error of the weights relative to a tall solver:
about 1e-16 times the condition of the scaled Gram matrix. Above `ILL_CONDITIONED` the record is read a second time, for
a triangular factor by orthogonal transformations, whose error goes with the square root of that condition.

Sources: Krasnosel'skii and Pokrovskii 1989 (play and stop); Lawson and Hanson 1974 (non-negative least squares, and the
accumulated triangular factor).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain

import numba
import numpy as np

from workbench.errors import WorkbenchError
from workbench.threads import one_thread

BLOCK = 2048  # samples: with 22 columns 360 kB, half a second-level cache, and long enough for BLAS to be at its best
# Condition of the scaled Gram matrix above which the triangular factor is accumulated instead, four times as long: the
# weights then agree with a tall solver's to 1e-8 throughout (by Cholesky they are off by 7e-10 at 4e6, 4e-7 at 4e9).
ILL_CONDITIONED = 1e7
KINDS = {"stop": (1.0, -1.0), "play": (0.0, 1.0)}  # output = first * x + second * play(x); x - play = stop, exactly

Column = Callable[[np.ndarray, int], np.ndarray]


@dataclass(frozen=True, eq=False)
class Weights:
    """Weights of operators.

    weights (m,), in y per x; columns (k,): factors of the extra columns. condition: of the Gram matrix of all columns
    scaled to unit length. method: "cholesky" or "qr". residual: rms of y less the model, in y; by Cholesky it is not
    resolved below about 1e-8 of the rms of y.
    """

    weights: np.ndarray
    condition: float
    method: str
    residual: float
    columns: np.ndarray


@numba.njit(cache=True, nogil=True, error_model="numpy")
def advance(x, start, radii, plays, lead, sign, out):
    """Write lead * x + sign * play_i(x) of each operator to out[:, i], x less `start`; `plays` (m,) moves along.

    The plays are kept, not the stops: clip(p, x - r, x + r) sums nothing up, so that nothing drifts over a long record.
    """
    for n in range(x.size):
        at = x[n] - start
        for i in range(radii.size):
            p = max(at - radii[i], min(at + radii[i], plays[i]))
            plays[i] = p
            out[n, i] = lead * at + sign * p


class Blocks:
    """Blocks (b, k + m + 1) of [columns, operators, y] of one record, as often as asked; each overwrites the last."""

    def __init__(self, x, y, radii: np.ndarray, kind: str, columns: Sequence[Column], size: int, counts: slice):
        self.x, self.y, self.radii, self.columns = x, y, radii, columns
        self.first, self.last, _ = counts.indices(len(x))
        self.lead, self.sign = KINDS[kind]
        self.size = size
        self.width = len(columns) + radii.size + 1

    @property
    def rows(self) -> int:
        """Samples that count."""
        return max(self.last - self.first, 0)

    def __iter__(self):
        buffer = np.empty((min(self.size, len(self.x)), self.width))
        plays, k = np.zeros(self.radii.size), len(self.columns)
        start = float(self.x[0])
        for a in range(0, len(self.x), self.size):
            x = np.ascontiguousarray(self.x[a : a + self.size], dtype=float)
            block = buffer[: x.size]
            for j, column in enumerate(self.columns):
                block[:, j] = column(x, a)
            advance(x, start, self.radii, plays, self.lead, self.sign, block[:, k:-1])
            block[:, -1] = self.y[a : a + self.size]
            block[: max(self.first - a, 0)] = 0.0  # the operators have seen these samples; the least squares does not
            block[max(self.last - a, 0) :] = 0.0
            yield block


def _gram_of(records: Sequence[Blocks]) -> np.ndarray:
    """Return the Gram matrix (width, width) of all columns and y, over all records."""
    total = np.zeros((records[0].width,) * 2)
    for block in chain.from_iterable(records):
        total += block.T @ block
    return total


def _triangle_of(records: Sequence[Blocks], norms: np.ndarray) -> np.ndarray:
    """Return the triangular factor R (width, width) of all columns and y, each divided by its norm, R'R their Gram matrix."""
    r = np.zeros((records[0].width,) * 2)
    for block in chain.from_iterable(records):
        r = np.linalg.qr(np.vstack([r, block / norms]), mode="r")
    return r


def _solved(r: np.ndarray, b: np.ndarray, free: int, cone: np.ndarray | None) -> np.ndarray:
    """Return c of min |R c - b|, R upper triangular, with c = cone s, s >= 0, behind the first `free` entries.

    cone: (m, m); without it c is free. R's upper left part has no say in the entries behind it: they are solved first, on
    the lower right part alone.
    """
    if cone is None:
        return np.linalg.lstsq(r, b, rcond=1e-13)[0]
    from scipy.optimize import nnls

    c = np.empty(b.size)
    c[free:] = cone @ nnls(r[free:, free:] @ cone, b[free:])[0] if free < b.size else 0.0
    c[:free] = np.linalg.lstsq(r[:free, :free], b[:free] - r[:free, free:] @ c[free:], rcond=1e-13)[0]
    return c


def _monotone_cone(radii: np.ndarray, kind: str) -> np.ndarray:
    """Return (m, m) of weights = cone slopes: slopes s >= 0 of the virgin curve between neighbouring thresholds.

    Beyond x a virgin curve rises by the sum of the weights of plays with r <= x, or of stops with r > x; each weight is
    the difference of two such sums.
    """
    order = np.argsort(radii, kind="stable")
    order = order if kind == "play" else order[::-1]
    cone = np.zeros((radii.size, radii.size))
    cone[order, np.arange(radii.size)] = 1.0
    cone[order[1:], np.arange(radii.size - 1)] = -1.0
    return cone


def _checked(x, y, thresholds, kind: str) -> np.ndarray:
    """Return the thresholds as an array (m,); WorkbenchError where the arguments do not fit together."""
    radii = np.array(thresholds, dtype=float)
    if kind not in KINDS:
        raise WorkbenchError(f"operators are {' or '.join(KINDS)}, not '{kind}'.")
    if radii.ndim != 1 or not np.all(np.isfinite(radii) & (radii > 0.0)):
        raise WorkbenchError("thresholds of operators must be a list of numbers above 0.")
    if np.ndim(x) != 1 or np.shape(x) != np.shape(y) or len(x) == 0:
        raise WorkbenchError(f"positions {np.shape(x)} and targets {np.shape(y)} must be as many, and at least one.")
    return radii


def fit_operators(
    x: np.ndarray, y: np.ndarray, thresholds: Sequence[float], kind: str = "stop", columns: Sequence[Column] = (),
    non_negative: bool = True, block: int = BLOCK, *, monotone: bool = False, conditioned: float = ILL_CONDITIONED,
) -> Weights:  # fmt: skip
    """Return the weights of least squares of operators on positions x (n,) that start unstrained at x[0], for y (n,).

    thresholds (m,): radius of each play or stop, or slip of each Maxwell-slip element, in x. columns: further linear
    columns, each called with a block of x (b,) and the index of its first sample, returning (b,); their factors may have
    any sign. non_negative: weights of operators >= 0, so that a bank of stops takes up energy on every closed path.
    monotone: instead, no slope of the virgin curve below 0, so that more motion never means less output. block: samples
    a block; it changes no more than rounding. conditioned: of the scaled Gram matrix, up to which it is solved. x and y may be memory-mapped. Memory besides them: one block.
    WorkbenchError where a number is not finite.
    """
    blocks = Blocks(x, y, _checked(x, y, thresholds, kind), kind, columns, block, slice(None))
    return weights_of([blocks], kind, non_negative=non_negative, monotone=monotone, conditioned=conditioned)


@one_thread
def weights_of(
    records: Sequence[Blocks],
    kind: str,
    *,
    non_negative: bool = True,
    monotone: bool = False,
    conditioned: float = ILL_CONDITIONED,
) -> Weights:
    """Return the weights that serve all records, of the same operators and columns; see `fit_operators`."""
    radii, k = records[0].radii, len(records[0].columns)
    gram = _gram_of(records)
    if not np.all(np.isfinite(gram)):
        raise WorkbenchError("positions, targets and columns must all be finite numbers; some are not.")
    norms = np.sqrt(np.diag(gram))
    moved = norms[:-1] > 0.0  # an operator that never moves has no say, and weight zero
    norms = np.where(norms > 0.0, norms, 1.0)
    keep = np.append(moved, True)
    scaled = (gram / np.outer(norms, norms))[np.ix_(keep, keep)]
    condition = float(np.linalg.cond(scaled[:-1, :-1])) if moved.any() else 1.0
    if condition <= conditioned:
        method, r = "cholesky", np.linalg.cholesky(scaled[:-1, :-1]).T
        b = np.linalg.solve(r.T, scaled[:-1, -1])
        beyond = max(scaled[-1, -1] - b @ b, 0.0)
    else:
        method = "qr"
        # what is left of the zero columns are zeros: without them the factor has to be made triangular once more
        whole = np.linalg.qr(_triangle_of(records, norms)[:, keep], mode="r")
        r, b, beyond = whole[:-1, :-1], whole[:-1, -1], whole[-1, -1] ** 2
    free = int(np.count_nonzero(moved[:k]))
    of = moved[k:]
    cone = np.eye(int(of.sum())) if non_negative else None
    if monotone:
        # in units of the scaled columns; whatever never moved is left out, and its weight stays zero
        cone = _monotone_cone(radii[of], kind) * (norms[k:-1][of] / norms[-1])[:, None]
    c = _solved(r, b, free, cone)
    left = np.sqrt((beyond + np.sum((r @ c - b) ** 2)) / max(sum(r.rows for r in records), 1)) * norms[-1]
    natural = np.zeros(moved.size)
    natural[moved] = c * norms[-1] / norms[:-1][moved]
    return Weights(natural[k:], condition, method, float(left), natural[:k])
