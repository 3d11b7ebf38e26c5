"""Gains over amplitude on a grid even in log2, looked up by the leading bits of the floating-point number.

Knots lie at 2^e (1 + j/m), j = 0 .. m-1, m = 2^b. For a positive double that number's bits, shifted right by 52 - b,
are an integer that grows by one from knot to knot: the segment is that integer less the one of the first knot. (In
single precision the shift is 23 - b.) Between knots a gain is a + b A; beyond the ends it is that of the end.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import frexp

import numpy as np

from workbench.errors import WorkbenchError

MANTISSA = 52
FINEST = 12  # largest b: 4096 knots an octave


def grid(first: float, last: float, per_octave: int = 4) -> np.ndarray:
    """Return the knots 2^e (1 + j/m), m = per_octave a power of two, from the last at or below `first` to the first at
    or above `last`."""
    if not 0.0 < first < last or per_octave not in (1 << b for b in range(FINEST + 1)):
        raise WorkbenchError(
            f"knots from {first:g} to {last:g} with {per_octave} an octave: 0 < first < last and a power of two are needed."
        )
    octaves = range(frexp(first)[1] - 1, frexp(last)[1] + 1)
    knots = np.array([2.0**e * (1.0 + j / per_octave) for e in octaves for j in range(per_octave)])
    low = np.searchsorted(knots, first, side="right") - 1
    return knots[low : np.searchsorted(knots, last) + 1]


def _step_bits(knots: np.ndarray) -> int:
    """Return b of a grid of knots; WorkbenchError where the knots are not such a grid."""
    bits = np.ascontiguousarray(knots, dtype=np.float64).view(np.int64)
    for b in range(FINEST + 1):
        shift = MANTISSA - b
        if not (bits & ((1 << shift) - 1)).any() and (np.diff(bits >> shift) == 1).all():
            return b
    raise WorkbenchError("the knots of a gain table must lie at 2^e (1 + j/m), m a power of two, without a gap.")


@dataclass(frozen=True, eq=False)
class Table:
    """knots (n,): amplitudes in SI, a grid. columns: name -> (n,) values at the knots."""

    knots: np.ndarray
    columns: dict[str, np.ndarray]

    def __post_init__(self):
        knots = np.asarray(self.knots, dtype=float)
        if knots.ndim != 1 or not knots.size or not (np.diff(knots) > 0).all() or not knots[0] > 0:
            raise WorkbenchError("a gain table needs knots that are positive and increasing.")
        object.__setattr__(self, "knots", knots)
        object.__setattr__(self, "columns", {n: np.asarray(c, dtype=float) for n, c in self.columns.items()})
        for name, column in self.columns.items():
            if column.shape != knots.shape or not np.isfinite(column).all():
                raise WorkbenchError(f"gain table: '{name}' needs one finite value for each of the {knots.size} knots.")
        self.shift  # noqa: B018 - refuse other knots now

    @cached_property
    def shift(self) -> int:
        """Right shift that leaves the segment's number."""
        return MANTISSA - _step_bits(self.knots)

    @cached_property
    def offset(self) -> int:
        """The shifted bits of the first knot."""
        return int(self.knots[:1].view(np.int64)[0]) >> self.shift

    @property
    def grid(self) -> tuple[int, int, int]:
        return self.shift, self.offset, self.knots.size

    @cached_property
    def rows(self) -> np.ndarray:
        """(n, 2 columns): a and b of each column in each segment; the last is flat."""
        parts = []
        for column in self.columns.values():
            slope = np.append(np.diff(column) / np.diff(self.knots), 0.0)
            parts += [column - slope * self.knots, slope]
        return np.stack(parts, axis=1)


def look_up(
    rows: np.ndarray, shift: int, offset: int, base: np.ndarray | int, amplitude: np.ndarray
) -> list[np.ndarray]:
    """Return each column at amplitudes (lanes,) that lie within the knots: the arithmetic that kernels and C repeat.

    rows: as Table.rows, of several tables one below the other; base: first row of each lane's table.
    """
    amplitude = np.ascontiguousarray(amplitude, dtype=np.float64)
    row = rows[base + ((amplitude.view(np.int64) >> shift) - offset)]
    return [row[..., 2 * j] + row[..., 2 * j + 1] * amplitude for j in range(rows.shape[1] // 2)]


def gains_at(table: Table, amplitude) -> list[np.ndarray]:
    """Return each column of one table at any amplitudes, clipped at both ends."""
    clipped = np.clip(np.atleast_1d(np.asarray(amplitude, dtype=float)), table.knots[0], table.knots[-1])
    return look_up(table.rows, table.shift, table.offset, 0, clipped)


def stacked(tables: Sequence[Table]) -> np.ndarray:
    """Rows of several tables of one grid, one below the other."""
    return np.concatenate([t.rows for t in tables])
