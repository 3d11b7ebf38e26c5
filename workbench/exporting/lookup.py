"""The look-up in float32, as NumPy: the same operations in the same order as the C header, hence the same bits."""

from os import PathLike

import numpy as np

from workbench.errors import WorkbenchError
from workbench.exporting.document import load, tables_of
from workbench.schedule.tables import Tables, tables

# Of the larger of a segment's two gains: one half unit in the last place (2^-24) each for the two gains held, the slope,
# the product and the sum. A - knot is exact (Sterbenz), since a segment spans at most an octave.
BOUND = 2.4e-7  # >= 4 * 2^-24


def lookup32(source, amplitudes, drive: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Return (kp, kd), float32, at `amplitudes`, equal bit for bit to `wb_<name>_lookup` of the C header.

    K(A) = K_i + slope_i (A - A_i) on A_i <= A < A_(i+1), clipped at both ends, in float32 without fused operations. i is
    read off the bits of A. A NaN and a negative amplitude take the first knot's gains.

    source: a Schedule, a document returned by `load`, or the path of one. amplitudes: rad or m, rounded to float32.
    drive: return the gains in the drive's units. From K(A) in float64 the result differs by at most BOUND = 2.4e-7 of the
    larger of the segment's two gains, where these have one sign. Raises WorkbenchError where the source holds no gains in
    the drive's units.
    """
    t = _held(source)
    if drive and "kp_drive" not in t.rows:
        raise WorkbenchError("the table holds no gains in the drive's units; export it with a scale.")
    with np.errstate(over="ignore", invalid="ignore"):
        a = np.asarray(amplitudes).astype(np.float32)
    knots = t.rows["knots"]
    above = a > knots[0]  # False for a NaN
    inside = above & (a < knots[-1])
    key = (a.view(np.uint32) >> np.uint32(t.shift)).astype(np.int64) - t.first
    i = np.where(inside, key, np.where(above, t.count - 1, 0))
    beyond = np.where(inside, a, knots[i]) - knots[i]
    suffix = "_drive" if drive else ""
    kp, kd = (t.rows[n + suffix][i] + t.rows[f"{n}{suffix}_slope"][i] * beyond for n in ("kp", "kd"))
    return kp, kd


def _held(source) -> Tables:
    """Return the tables of a schedule, a document or a path."""
    if isinstance(source, str | PathLike):
        source = load(source)
    if isinstance(source, dict):
        return tables_of(source)
    return tables(source.per_octave, source.knots, source.kp, source.kd)
