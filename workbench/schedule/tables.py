"""The float32 tables that a drive runs on, and the checks that make the look-up in them exact.

Rows, each of one entry a knot, in the order of the payload: knots, kp, kd, kp_slope, kd_slope and, where a scale to the
drive's units is given, kp_drive, kd_drive, kp_drive_slope, kd_drive_slope. A slope is (next - this)/(next knot - this
knot) of the rounded entries, so that the look-up meets each knot; the last is zero, so that the table ends flat.
"""

import zlib
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from workbench.errors import WorkbenchError

ROWS = ("knots", "kp", "kd", "kp_slope", "kd_slope")
DRIVE_ROWS = ("kp_drive", "kd_drive", "kp_drive_slope", "kd_drive_slope")
MANTISSA = 23  # bits of a float32 below the leading one
FINEST = 4096  # knots an octave; more would crowd the float32 values between two knots
# Sizes that knots and gains may have: slopes between any two then stay clear of float32's ends (2^-126 ... 2^127).
KNOTS = (2.0**-40, 2.0**40)
GAINS = (2.0**-60, 2.0**60)


@dataclass(frozen=True, eq=False)
class Tables:
    """rows: name -> (m,) float32, read-only. per_octave: knots an octave, a power of two."""

    per_octave: int
    rows: Mapping[str, np.ndarray]

    @property
    def count(self) -> int:
        """Number of knots m."""
        return self.rows["knots"].size

    @property
    def shift(self) -> int:
        """Mantissa bits below the segment: (bits of A) >> shift counts knots on the grid 2^e (1 + j/per_octave)."""
        return MANTISSA - (self.per_octave.bit_length() - 1)

    @property
    def first(self) -> int:
        """The first knot's (bits >> shift), which the segment index is counted from."""
        return int(self.rows["knots"].view(np.uint32)[0]) >> self.shift

    @property
    def payload(self) -> bytes:
        """The rows one after the other, little-endian float32."""
        return b"".join(row.astype("<f4").tobytes() for row in self.rows.values())

    @property
    def crc(self) -> int:
        """CRC-32 (IEEE 802.3, reflected; "123456789" gives 0xCBF43926) of the payload."""
        return zlib.crc32(self.payload)


def slopes(knots: np.ndarray, gains: np.ndarray) -> np.ndarray:
    """Return the slope of each segment, gain per rad or m, as float32 (m,); the last is zero."""
    rise, run = np.diff(gains.astype(float)), np.diff(knots.astype(float))
    return np.append(rise / run, 0.0).astype(np.float32)


def grid(knots, per_octave, where: str) -> np.ndarray:
    """Return knots as float32; WorkbenchError unless they are consecutive on 2^e (1 + j/per_octave)."""
    fine = isinstance(per_octave, int | np.integer) and 1 <= per_octave <= FINEST and per_octave & (per_octave - 1) == 0
    if not fine:
        raise WorkbenchError(f"{where}: per_octave is {per_octave}; a power of two from 1 to {FINEST} is needed.")
    exact = np.asarray(knots, dtype=float)
    if exact.ndim != 1 or exact.size == 0 or not np.all((exact >= KNOTS[0]) & (exact <= KNOTS[1])):
        raise WorkbenchError(
            f"{where}: knots have to be a list of numbers, at least one, from {KNOTS[0]:.3g} to {KNOTS[1]:.3g}."
        )
    rounded = exact.astype(np.float32)
    place, rest = np.divmod(rounded.view(np.uint32).astype(np.int64), 2**MANTISSA // int(per_octave))
    off = (rounded != exact) | (rest != 0)
    if np.any(off):
        i = int(np.argmax(off))
        raise WorkbenchError(
            f"{where}: knots[{i}] is {float(exact[i])!r}; a number 2^e (1 + j/{per_octave}) is needed."
        )
    gap = np.diff(place) != 1
    if np.any(gap):
        i = int(np.argmax(gap))
        raise WorkbenchError(
            f"{where}: knots[{i + 1}] is {float(exact[i + 1])!r}; the number 2^e (1 + j/{per_octave}) that follows"
            f" {float(exact[i])!r} is needed."
        )
    return rounded


def _gain_row(values, count: int, name: str, where: str) -> np.ndarray:
    """Return one row of gains as float32; WorkbenchError unless there is one a knot, zero or of a size float32 holds."""
    exact = np.asarray(values, dtype=float)
    if exact.shape != (count,):
        raise WorkbenchError(
            f"{where}: {name} has shape {exact.shape}; one gain for each of the {count} knots is needed."
        )
    wrong = ~((exact == 0.0) | ((np.abs(exact) >= GAINS[0]) & (np.abs(exact) <= GAINS[1])))
    if np.any(wrong):
        i = int(np.argmax(wrong))
        raise WorkbenchError(
            f"{where}: {name}[{i}] is {float(exact[i])!r}; a finite gain is needed, zero or of a"
            f" size from {GAINS[0]:.3g} to {GAINS[1]:.3g}, so that float32 holds it and its slope."
        )
    return exact.astype(np.float32)


def tables(
    per_octave: int, knots, kp, kd, drive: Mapping[str, np.ndarray] | None = None, where: str = "schedule"
) -> Tables:
    """Return the tables of a schedule.

    knots: amplitudes in rad or m. kp, kd: SI gains, one a knot. drive: {"kp", "kd"} in the drive's units, or None.
    Raises WorkbenchError, naming `where`, for knots off the grid or gains that float32 does not hold.
    """
    x = grid(knots, per_octave, where)
    rows = {"knots": x}
    for suffix, gains in (("", {"kp": kp, "kd": kd}), ("_drive", drive)):
        if gains is not None:
            held = {name: _gain_row(gains[name], x.size, name + suffix, where) for name in ("kp", "kd")}
            rows |= {name + suffix: row for name, row in held.items()}
            rows |= {f"{name}{suffix}_slope": slopes(x, row) for name, row in held.items()}
    for row in rows.values():
        row.flags.writeable = False
    return Tables(int(per_octave), rows)
