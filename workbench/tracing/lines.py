"""Lines of a residual's spectrum that neither the reference nor the drive has, nor are hum of the mains in the reported drive."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

MAINS = (50.0, 60.0)  # Hz
NEAR = 0.005  # relative distance within which a line is a multiple of these: grids keep to 0.4 %
# Power of what the model asks for over the residual's, in such a line, below which the axis does not feel it: a force that a drive
# knows nothing of asks for as much. Halved or doubled, as NEAR, it changes no line of 232 axes; three have hum, of 0.3 to 28 % of what is left
FELT = 0.25


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


def strongest_line(parts: Sequence[Part], least: float) -> tuple[float, float]:
    """Return (share of the residual's power, Hz) of the strongest spectral line; zeros where none stands out of its
    surroundings by `least` in power, or where the reference or the drive has it."""
    whole = sum(float(p.residual @ p.residual) for p in parts)
    best = (0.0, 0.0)
    for p in parts:
        own, drive, reference = (_lines(x, p.dt, p.bandwidth) for x in (p.residual, p.drive, p.reference))
        if own is None:
            continue
        f, power, ratio = own
        asked = _lines(p.drive - p.residual, p.dt, p.bandwidth)[1]
        known = (drive[2] > 0.5 * ratio) | (reference[2] > least) | _hum(f, power, drive[1], asked)
        ratio = np.where(known, 0.0, ratio)
        k = int(np.argmax(ratio))
        if ratio[k] < least or whole <= 0.0:
            continue
        inside = power[max(k - 2, 0) : k + 3].sum() / power.sum() * float(p.residual @ p.residual) / whole
        best = max(best, (float(inside), float(f[k])))
    return best


def _hum(f: np.ndarray, power: np.ndarray, drive: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """Return where (k,) a multiple of the mains is in the reported drive and the motion does not answer it, by power at f, Hz."""
    cycles = f[:, None] / np.array(MAINS)
    near = (np.abs(cycles - np.round(cycles)) < NEAR * np.round(cycles)).any(axis=1)
    return near & (drive > 0.5 * power) & (asked < FELT * power)


def _lines(x: np.ndarray, dt: float, bandwidth: float) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Return (Hz, power, power over the median of 101 neighbours) in the band, or None for a record too short."""
    from scipy.ndimage import median_filter

    power = np.abs(np.fft.rfft((x - x.mean()) * np.hanning(x.size))) ** 2
    f = np.fft.rfftfreq(x.size, dt)
    power, f = power[f <= bandwidth], f[f <= bandwidth]
    if f.size < 200:
        return None
    ratio = power / np.maximum(median_filter(power, 101), 1e-300)
    ratio[f < 1.0] = 0.0  # slow changes are the business of bench time
    return f, power, ratio
