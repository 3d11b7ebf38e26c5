"""What the data say of a column: whether it is a clock, in which unit, its encoder step, and how it drives a position."""

from dataclasses import dataclass

import numpy as np

from workbench.motion import LowPass

RATES = (100.0, 50_000.0)  # Hz: drives and their scopes log within these
CLOCKS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
EVEN = 0.9  # share of time steps within 20 % of the median in a clock: samples may be dropped
WHOLE = 0.98  # share of increments that must be whole multiples of an encoder's step
ABOVE_NOISE = 4.0  # 6 dB: a position's spectrum this far above its floor is motion
HIGHEST = 0.15  # evaluation bandwidth over the sampling rate: the motion's low pass then ends at 0.3 of it


def is_clock(values: np.ndarray) -> bool:
    """Whether a column increases, and by nearly even steps."""
    steps = np.diff(values)
    step = float(np.median(steps))
    return bool(step > 0 and np.all(steps > 0) and np.mean(np.abs(steps - step) <= 0.2 * step) >= EVEN)


def clock_unit(values: np.ndarray) -> tuple[str, float]:
    """Return (unit, rate in Hz) of a clock: the first of s, ms, us, ns in which a drive could have logged this fast."""
    step = float(np.median(np.diff(values)))
    rates = {unit: 1.0 / (step * size) for unit, size in CLOCKS.items()}
    likely = [u for u, rate in rates.items() if RATES[0] <= rate <= RATES[1]]
    unit = likely[0] if likely else min(rates, key=lambda u: abs(np.log(rates[u] / 1000.0)))
    return unit, rates[unit]


def quantum(values: np.ndarray) -> float:
    """Return the step that all increments of a signal are whole multiples of, 0 where there is none."""
    moved = np.abs(np.diff(values))
    size = float(np.max(np.abs(values), initial=0.0))
    still = np.mean(moved <= 1e-12 * size)
    moved = moved[moved > 1e-12 * size]
    if moved.size < 10:
        return 0.0
    step = float(np.min(moved))
    for reach in (1.5, 3.5, 10.5):  # decimals are rounded: the more counts, the more exactly they say the step
        few = moved[moved < reach * step]
        counts = np.round(few / step)
        step = float(few @ counts / (counts @ counts))
    few = moved[moved < 10.5 * step]
    counts = np.round(few / step)
    several = np.unique(counts).size > 1 or still > 0.1  # a constant speed has equal increments, too
    whole = np.mean(np.abs(few / step - counts) < 0.1) >= WHOLE and few.size > 0.05 * moved.size
    return step if whole and several else 0.0


@dataclass(frozen=True)
class Relation:
    """How far a drive signal is explained by a position's motion: d = J a + b v + c sgn(v) + d0.

    explained: share of its power. inertia: J in the columns' own units. work: sum of d v over sum of |d v|.
    """

    explained: float
    inertia: float
    work: float

    @property
    def reversed(self) -> bool:
        """Whether drive and position count in opposite directions: negative inertia, and an axis that gives work away."""
        return self.inertia < 0 and self.work < 0


def relation(position: np.ndarray, drive: np.ndarray, rate: float, band: float) -> Relation:
    """Return how `drive` (n,) relates to `position` (n,), below `band` Hz."""
    _, v, a = LowPass(band, rate, position.size).derivatives(position, 3)
    force = LowPass(band, rate, drive.size)(drive)
    slow = 0.02 * float(np.max(np.abs(v), initial=0.0))
    columns = np.column_stack([a, v, np.tanh(v / max(slow, 1e-300)), np.ones(v.size)])
    edge = max(2, int(0.05 * rate))
    columns, force, v = columns[edge:-edge], force[edge:-edge], v[edge:-edge]
    norms = np.sqrt(np.sum(columns**2, axis=0))
    if force.size < 20 or not np.all(norms > 0) or not np.ptp(force) > 0:
        return Relation(0.0, 0.0, 0.0)
    c = np.linalg.lstsq(columns / norms, force, rcond=1e-9)[0]
    left = force - (columns / norms) @ c
    whole = force - np.mean(force)
    power = (force - np.mean(force)) * v
    explained = 1.0 - float(left @ left) / max(float(whole @ whole), 1e-300)
    return Relation(explained, float(c[0] / norms[0]), float(np.sum(power) / max(np.sum(np.abs(power)), 1e-300)))


def motion_band(position: np.ndarray, rate: float) -> float:
    """Return the frequency in Hz up to which the spectrum of a position stands above its own noise floor.

    The floor is the median of the spectrum's last quarter. At most 0.15 of the sampling rate.
    """
    from scipy import signal

    n = min(position.size, max(256, int(rate)))
    f, power = signal.welch(position - position[0], rate, "hann", n, detrend="linear")
    floor = float(np.median(power[f >= 0.375 * rate]))
    above = f[(power > ABOVE_NOISE * floor) & (f > 0)]
    gap = np.flatnonzero(np.diff(above, prepend=0.0) > 8 * (f[1] - f[0]))  # single lines far above are interference
    last = above[gap[0] - 1] if gap.size and gap[0] > 0 else (above[-1] if above.size else 0.0)
    return float(np.clip(last, min(10.0, HIGHEST * rate), HIGHEST * rate))


def resting(position: np.ndarray, rate: float, band: float) -> np.ndarray:
    """Return |v| (n,) over its largest value, by which an axis is seen to rest."""
    speed = np.abs(LowPass(band, rate, position.size)(position, 1))
    return speed / max(float(np.max(speed)), 1e-300)
