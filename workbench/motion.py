"""From a record to the signals that a plant is asked to explain, and the filter that both sides of the balance pass.

Operators with memory see the raw position behind a dead band of one count; everything else sees zero-phase filtered
motion. The low pass is 1/(1 + (f/f_c)^8), applied in the frequency domain on a record extended by odd reflection, so
that it has no phase and a record may end in motion.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import casadi as ca
import numpy as np
from scipy import fft

from workbench.errors import UnsoundRecord
from workbench.kernel.program import read
from workbench.kernel.scan import scan
from workbench.record import Record

PAD = 0.5  # s, of odd reflection at both ends
TRIM = 0.05  # s, at both ends, that no error counts, or a period of the band's edge where that is longer: what an end does passes its filter
# Samples of a record that count between its ends. Halved, a steering wheel's log of which 5 are left is read; more than doubled, a wrist's (21 of 61) is refused
COUNTED = 10
MOTION_BAND = 2.0  # band of the motion's own low pass over the evaluation bandwidth: flat (0.4 %) where errors count


@lru_cache(maxsize=256)
def fast_length(n: int) -> int:
    """Smallest length >= n with no prime factor above 5, for which the FFT is fast."""
    best = 1 << (n - 1).bit_length()
    five = 1
    while five < best:
        three = five
        while three < best:
            value = three
            while value < n:
                value *= 2
            best = min(best, value)
            three *= 3
        five *= 5
    return best


@dataclass(frozen=True)
class LowPass:
    """F = 1/(1 + (f/bandwidth)^8) without phase, for records of one rate and length.

    bandwidth, rate: Hz. n: samples. derivative: how many times the result is differentiated.
    """

    bandwidth: float
    rate: float
    n: int

    def __call__(self, x: np.ndarray, derivative: int = 0) -> np.ndarray:
        """Filter the last axis of x (..., n); returns the same shape."""
        return self._through(x, (derivative,))[0]

    def derivatives(self, x: np.ndarray, count: int) -> np.ndarray:
        """Return the filtered x and its first count - 1 derivatives, (count, ..., n), from one transform."""
        return self._through(x, range(count))

    def _through(self, x: np.ndarray, orders: Sequence[int]) -> np.ndarray:
        """Return (orders, ..., n). All go through one transform back: two rows take it as long as one."""
        extended, left = self._extended(np.asarray(x, dtype=float))
        size = extended.shape[-1]
        responses = _responses(self.bandwidth, self.rate, size, tuple(orders))
        spectra = fft.rfft(extended, axis=-1) * responses.reshape(-1, *[1] * (extended.ndim - 1), responses.shape[-1])
        return fft.irfft(spectra, size, axis=-1)[..., left : left + self.n]

    def at_lower_rate(self, x: np.ndarray, ratio: Fraction, count: int) -> np.ndarray:
        """Filter the last axis of x (..., n) and read it at `ratio` of its rate, from the first sample on: (..., count).

        The transform back is as much shorter. What lies above half the lower rate is left out, so that nothing folds.
        """
        extended, left = self._extended(np.asarray(x, dtype=float), ratio.denominator)
        size = extended.shape[-1]
        lower, first = int(size * ratio), int(left * ratio)
        kept = slice(lower // 2 + 1)
        response = _responses(self.bandwidth, self.rate, size, (0,))[0, kept] * float(ratio)
        spectra = fft.rfft(extended, axis=-1)[..., kept] * response
        return fft.irfft(spectra, lower, axis=-1)[..., first : first + count]

    def _extended(self, x: np.ndarray, multiple: int = 1) -> tuple[np.ndarray, int]:
        """Return x (..., n) with its odd reflections at both ends, and where x begins in it: both multiples of `multiple`."""
        pad = min(int(PAD * self.rate), self.n - 1)
        total = multiple * fast_length(-(-(self.n + 2 * pad) // multiple))
        left = min(pad + (total - self.n - 2 * pad) // 2, self.n - 1)
        left -= left % multiple
        right = min(total - self.n - left, self.n - 1)
        first, last = x[..., :1], x[..., -1:]
        middle = 0.5 * (first + last)
        extended = np.empty((*x.shape[:-1], total))
        extended[..., left : left + self.n] = x
        extended[..., left + self.n + right :] = middle
        extended[..., :left] = middle + (2 * first - middle - x[..., left:0:-1]) * _fading(left)[::-1]
        extended[..., left + self.n : left + self.n + right] = middle + (
            2 * last - middle - x[..., -2 : -right - 2 : -1]
        ) * _fading(right)
        return extended, left

    @property
    def trim(self) -> int:
        """Samples at each end that no error counts."""
        return int(trimmed(self.bandwidth) * self.rate)


def trimmed(bandwidth: float) -> float:
    """Return the time in s at each end of a record that no error counts behind a low pass of this bandwidth in Hz."""
    return max(TRIM, 1.0 / bandwidth)


@lru_cache(maxsize=64)
def _fading(n: int) -> np.ndarray:
    """Return one over the first half of n samples, then half a cosine to zero.

    The transform takes a record for one period. Where its ends met with a jump, and the response has not fallen off at half
    the sampling rate, the jump would ring through all of the record.
    """
    return 0.5 + 0.5 * np.cos(np.pi * np.clip(2.0 * np.arange(1, n + 1) / max(n, 1) - 1.0, 0.0, 1.0))


@lru_cache(maxsize=64)
def _responses(bandwidth: float, rate: float, size: int, orders: tuple[int, ...]) -> np.ndarray:
    """Return the low pass' response with its derivatives of these orders, (orders, size // 2 + 1)."""
    f = np.fft.rfftfreq(size, 1 / rate)
    return np.stack([(2j * np.pi * f) ** k / (1 + (f / bandwidth) ** 8) for k in orders])


@lru_cache(maxsize=1)
def _dead_band():
    """Program of the play operator z+ = clip(z, q - r, q + r), output z+ - z."""
    s, z = ca.SX.sym("s", 2), ca.SX.sym("z")
    q, r = s[0], s[1]
    after = ca.fmin(ca.fmax(z, q - r), q + r)
    return read(ca.Function("dead_band", [s, z, ca.SX(0, 1)], [after, after - z]))


def increments(position: np.ndarray, resolution: float | np.ndarray) -> np.ndarray:
    """Return increments (n,) of the position behind a dead band one count wide, starting from zero at the first sample.

    resolution: the count; (n,) where it is not the same all the time.
    """
    radius = 0.5 * np.broadcast_to(resolution, position.shape)
    return scan(_dead_band(), np.stack([position, radius]), position[:1], np.zeros(0))[0]


@dataclass(frozen=True, eq=False)
class Motion:
    """One record as signals. u: drive as reported; q, v, a: filtered position and its derivatives; dq: raw increments.

    filter: F of the evaluation bandwidth. counts: encoder resolution in SI (0 where unknown).
    """

    record: Record
    u: np.ndarray
    q: np.ndarray
    dq: np.ndarray
    v: np.ndarray
    a: np.ndarray
    filter: LowPass
    counts: float

    @property
    def t(self) -> np.ndarray:
        return self.record.time

    @property
    def dt(self) -> float:
        return self.record.dt

    @property
    def keep(self) -> slice:
        """The samples in which errors count."""
        first = int(np.searchsorted(self.t, self.record.counts_from))
        return slice(max(self.filter.trim, first), self.u.size - self.filter.trim)


def motion(record: Record, bandwidth: float) -> Motion:
    """Return the motion of a record; its first increment holds what lay before it. bandwidth: evaluation bandwidth in Hz.

    Raises UnsoundRecord of a record too short for its filter.
    """
    position = record.channels["position"]
    counts = record.resolution.get("position", 0.0)
    smooth = LowPass(MOTION_BAND * bandwidth, 1 / record.dt, position.size)
    q, v, a = smooth.derivatives(position, 3)
    dq = increments(position, counts)
    dq[0] += (record.history or 0.0) + (record.found or 0.0)
    made = Motion(
        record=record,
        u=record.drive,
        q=q,
        dq=dq,
        v=v,
        a=a,
        filter=LowPass(bandwidth, 1 / record.dt, position.size),
        counts=counts,
    )
    left = made.keep.stop - made.keep.start
    if left < COUNTED:
        raise UnsoundRecord(
            f"{record.source.path}: the record lasts {record.time[-1] - record.time[0]:.3g} s, and of it {max(left, 0)} samples count: "
            f"{trimmed(bandwidth):.3g} s at each end pass the filter of the evaluation_bandwidth of {bandwidth:g} Hz; at least "
            f"{COUNTED} are needed, so measure longer, or leave the record out.",
            "short record",
            record.name,
        )
    return made
