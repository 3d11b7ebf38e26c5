"""Lines of a residual's spectrum that neither the reference nor the drive has, those of the mains apart.

A line at a multiple of the mains' frequency is the supply's, and no law of an axis, whether the axis feels it or not: where a current
sensor inside a current loop hums, the loop holds its reading, so that the motor is given the hum and the report shows none.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

MAINS = (50.0, 60.0)  # Hz
# Relative distance within which a line is a multiple of these, beside half a bin that its peak is known to: grids keep to 0.4 %, while an
# induction motor of a pump or a fan slips by one to five. Halved or doubled, it changes no verdict: of some 290 axes none has another
# line of 1 % of the drive within 1 % of a multiple
NEAR = 0.005
AMONG = 101  # neighbours whose median a line stands out of; lower bins have none farther off than half their frequency
# bins, from the peak of a line behind a Hann window to the end of its main lobe, in which it has no second line
LOBE = 2


@dataclass(frozen=True, eq=False)
class Part:
    """One record's residual of the drive (n,), what is outside the loop (n, features), and when it moves (n,) of bool."""

    residual: np.ndarray
    outside: np.ndarray
    moves: np.ndarray
    way: np.ndarray
    time: np.ndarray
    dt: float
    drive: np.ndarray
    reference: np.ndarray
    bandwidth: float


@dataclass(frozen=True)
class Line:
    """share: of the residual's power, 0 where there is no line. frequency: Hz."""

    share: float = 0.0
    frequency: float = 0.0


def strongest_lines(parts: Sequence[Part], least: float) -> tuple[Line, Line]:
    """Return the strongest spectral line that is not of the mains, and the strongest that is; none where none stands out of its
    surroundings by `least` in power, or where the reference or the drive has it. A line is of all records in which one of its frequency
    stands out."""
    whole = sum(float(p.residual @ p.residual) for p in parts)
    if whole <= 0.0:
        return Line(), Line()
    standing = [list(_standing(p, least)) for p in parts]
    best = [Line(), Line()]
    for own in standing:
        for seed in own:
            alike = ([x for x in others if x.mains == seed.mains and x.near(seed)] for others in standing)
            power = sum(max(x.power for x in found) for found in alike if found)
            best[seed.mains] = max(best[seed.mains], Line(power / whole, seed.frequency), key=lambda x: x.share)
    return best[0], best[1]


@dataclass(frozen=True)
class _Standing:
    """One line of one record: frequency, Hz; width of a bin, Hz; power of the residual in it; mains: whether it is the supply's."""

    frequency: float
    width: float
    power: float
    mains: bool

    def near(self, other: "_Standing") -> bool:
        """Whether another record's line may be the same: its frequency is known to a bin of either."""
        return abs(self.frequency - other.frequency) <= self.width + other.width


def _standing(p: Part, least: float) -> Iterator[_Standing]:
    """Yield the lines of a record that stand out of their surroundings by `least`, and that neither the reference nor the drive has."""
    own, drive, reference = (_lines(x, p.dt, p.bandwidth) for x in (p.residual, p.drive, p.reference))
    if own is None:
        return
    f, power, ratio = own
    known = (drive[2] > 0.5 * ratio) | (reference[2] > least)
    mains, whole = _of_mains(f), float(p.residual @ p.residual)
    for k in np.flatnonzero(~known & _peaks(power) & (ratio >= least)):
        inside = float(power[max(k - LOBE, 0) : k + LOBE + 1].sum() / power.sum())
        yield _Standing(float(f[k]), float(f[1]), inside * whole, bool(mains[k]))


def _peaks(power: np.ndarray) -> np.ndarray:
    """Return where (k,) a spectrum is largest within the main lobe of a line: its flanks are no lines of their own."""
    from scipy.ndimage import maximum_filter1d

    return power >= maximum_filter1d(power, 2 * LOBE + 1)


def _of_mains(f: np.ndarray) -> np.ndarray:
    """Return where (k,) frequencies, Hz, evenly spaced, are multiples of the mains."""
    times = np.maximum(np.round(f[:, None] / np.array(MAINS)), 1.0)
    off = np.abs(f[:, None] - times * np.array(MAINS))
    return (off < NEAR * times * np.array(MAINS) + 0.5 * (f[1] - f[0])).any(axis=1)


def _lines(x: np.ndarray, dt: float, bandwidth: float) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Return (Hz, power, power over the median of its neighbours) in the band, or None for a record too short."""
    power = np.abs(np.fft.rfft((x - x.mean()) * np.hanning(x.size))) ** 2
    f = np.fft.rfftfreq(x.size, dt)
    power, f = power[f <= bandwidth], f[f <= bandwidth]
    if f.size < 200:
        return None
    ratio = power / _median_around(power)
    ratio[: 4 * LOBE] = 0.0  # too few neighbours, and periods: a level that wanders is the business of bench time
    return f, power, ratio


def _median_around(power: np.ndarray) -> np.ndarray:
    """Return the median (k,) of a spectrum's neighbours, lower ones' no farther off than half their frequency: noise that falls with
    frequency is no line at its low end."""
    from scipy.ndimage import median_filter

    around = median_filter(power, AMONG)
    for k in range(4 * LOBE, min(AMONG, power.size)):
        around[k] = np.median(power[k - k // 2 : k + k // 2 + 1])
    return np.maximum(around, 1e-300)
