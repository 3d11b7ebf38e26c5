"""Frequency response of an axis, drive to acceleration, from one record: over periods where it repeats, else by Welch.

Acceleration is the second difference of the raw position, over (2 sin(w dt/2)/(w dt))^2: no phase, and what a slow motion
under a small excitation leaks is smaller by the square of the frequency. In a closed loop with a record that does not
repeat, the estimate leans towards minus the inverse of the controller where the coherence is low.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from workbench.errors import WorkbenchError
from workbench.frequency.modes import Modes, fit_modes
from workbench.frequency.spectra import densities
from workbench.notebook import page
from workbench.record import Record

AVERAGES = (
    8  # segments side by side of a record that does not repeat; half overlapped, nearly twice as many are averaged
)
REPEATS = 0.9  # correlation of a record with itself a period later, from which on it is taken to repeat
LEAST = 3  # periods, beside the first, which is left out for its transient
EXCITED = 10.0  # of a line's amplitude over its standard error, from which on it counts as excited
STRONG, FAINT = (
    20,
    1e-3,
)  # lines of the drive that tell how strong it shakes, and the share of their density that still does
HIGHEST = 0.4  # of the sampling rate, up to which a response is given
BAND = (0.05, 0.6)  # of the evaluation bandwidth, in which a record is looked at for what shakes it
EFFECTIVE = 9.0 / 11.0  # independent averages per segment of Hann's window with half overlap (Welch 1967)


@dataclass(frozen=True, eq=False)
class Response:
    """Acceleration over drive, (rad/s^2)/(N*m) or (m/s^2)/N, at frequency (n,) Hz.

    value (n,): complex. coherence (n,): 0 to 1. deviation (n,): standard deviation of the real and of the imaginary part.
    resolution: Hz between independent lines. method: "periods" or "Welch". averages: how many enter a line.
    """

    record: str
    frequency: np.ndarray
    value: np.ndarray
    coherence: np.ndarray
    deviation: np.ndarray
    resolution: float
    method: str
    averages: float

    @property
    def spread(self) -> float:
        """Standard deviation in Hz of the frequencies that one line averages: 1/(sqrt(3) T) of Hann's window, else 0."""
        return self.resolution / 1.5 / 3.0**0.5 if self.method == "Welch" else 0.0

    @property
    def omega(self) -> np.ndarray:
        return 2 * np.pi * self.frequency

    @property
    def receptance(self) -> np.ndarray:
        """Position over drive, (n,)."""
        return -self.value / self.omega**2

    @property
    def frd(self):
        """Position over drive as python-control's FrequencyResponseData."""
        import control

        return control.FrequencyResponseData(self.receptance, self.omega)

    @cached_property
    def modes(self) -> Modes:
        """The modes of this response, fitted (frequency.fit_modes)."""
        return fit_modes(self)

    def _repr_html_(self) -> str:
        """The modes as a table, and gain and coherence as a drawing."""
        sentence = (
            f"Frequency response of record '{self.record}', {self.frequency[0]:.3g} to {self.frequency[-1]:.3g} Hz."
        )
        try:
            found = self.modes.modes
        except WorkbenchError as too_little:
            found, sentence = (), f"{sentence} No modes: {too_little}"
        rows = [(m.frequency, m.frequency_half, m.damping, m.damping_half) for m in found]
        head = ("mode, Hz", "±", "damping ratio", "±")
        return page(sentence, head, rows, lambda axes: self._draw(axes, bool(found)), graphs=2)

    def _draw(self, axes, modes: bool) -> None:
        above, below = axes
        above.loglog(self.frequency, np.abs(self.value), ".", ms=2, label="measured")
        if modes:
            above.loglog(self.frequency, np.abs(self.modes.at(self.frequency)), lw=0.9, label="modes")
        above.set_ylabel("acceleration over drive, SI")
        above.legend()
        below.semilogx(self.frequency, self.coherence, ".", ms=2)
        below.set_ylabel("coherence")
        below.set_xlabel("frequency, Hz")

    def where(self, keep: np.ndarray) -> "Response":
        """Return the response at some of its lines; keep (n,): which."""
        return Response(
            self.record, self.frequency[keep], self.value[keep], self.coherence[keep], self.deviation[keep],
            self.resolution, self.method, self.averages,
        )  # fmt: skip


def shaken(records: Sequence[Record], bandwidth: float) -> Record:
    """Return the record whose drive shakes the axis most evenly: the largest geometric mean of its density in the BAND.

    Steps and feedback make motions coherent with the drive too, but there the drive answers to the motion.
    """

    def density(r: Record) -> float:
        size = min(max(r.drive.size // AVERAGES, 8), r.drive.size)
        f, power, *_ = densities(r.drive, r.drive, 1 / r.dt, size)
        inside = (f > BAND[0] * bandwidth) & (f < BAND[1] * bandwidth)
        return float(np.mean(np.log(power[inside] + 1e-300))) if inside.any() else -np.inf

    free = [r for r in records if not r.locked] or list(records)
    return max(free, key=density)


def response_of(record: Record, *, channel: str = "position", seconds: float | None = None) -> Response:
    """Return the frequency response of a record. channel: whose motion. seconds: length of a segment, where none repeats.

    WorkbenchError where the record is too short for an average.
    """
    u, a = record.drive[1:-1], np.diff(record.channels[channel], 2) / record.dt**2
    period = period_of(u) if seconds is None else 0
    if period:
        found = _over_periods(record, u, a, period)
    else:
        size = round(seconds / record.dt) if seconds else u.size // AVERAGES
        if not 64 <= size <= u.size // 2:
            raise WorkbenchError(
                f"record '{record.name}' has {u.size} samples, and a segment {size}; a frequency response needs segments of "
                "64 samples and two of them."
            )
        found = _by_welch(record, u, a, size)
    inside = (found.frequency > 0.0) & (found.frequency <= HIGHEST / record.dt) & np.isfinite(found.value)
    return found.where(inside & np.isfinite(found.deviation))


def period_of(u: np.ndarray) -> int:
    """Return the samples after which a signal repeats, or 0. Its differences are compared, so that drift does not hide it."""
    x = np.diff(u)
    x = x - x.mean()
    size = 1 << (2 * x.size - 1).bit_length()
    correlation = np.fft.irfft(np.abs(np.fft.rfft(x, size)) ** 2, size)[: x.size]
    if correlation[0] <= 0.0:
        return 0
    lags = np.arange(1, x.size // (LEAST + 1) + 1)
    same = correlation[lags] / correlation[0] * x.size / (x.size - lags)
    fell = int(np.argmax(same < 0.5))  # beyond the lobe about zero
    if not (same < 0.5).any() or same[fell:].max() < REPEATS:
        return 0
    best = same[fell:].max()
    first = fell + int(np.argmax(same[fell:] > 0.97 * best))
    return int(lags[first + int(np.argmax(same[first : first + 3]))])


def _gain_of_difference(f: np.ndarray, dt: float) -> np.ndarray:
    """Return what the second difference over dt^2 makes of a true second derivative, (2 sin(w dt/2)/(w dt))^2."""
    return np.sinc(f * dt) ** 2


def _over_periods(record: Record, u: np.ndarray, a: np.ndarray, period: int) -> Response:
    """Average the transforms of whole periods but the first; only lines that are excited are given."""
    count = u.size // period - 1
    parts = [x[-count * period :].reshape(count, period) for x in (u, a)]
    drive, motion = (np.fft.rfft(x, axis=1) for x in parts)
    f = np.fft.rfftfreq(period, record.dt)
    mean_u, mean_a = drive.mean(axis=0), motion.mean(axis=0)
    error_u = drive.std(axis=0, ddof=1) / count**0.5
    excited = np.abs(mean_u) > EXCITED * error_u
    excited &= np.abs(mean_u) > 1e-3 * np.abs(mean_u).max()
    f, mean_u, mean_a, drive, motion = (
        f[excited],
        mean_u[excited],
        mean_a[excited],
        drive[:, excited],
        motion[:, excited],
    )
    value = mean_a / mean_u
    left = motion - value * drive  # what a period's motion has beside the response to its own drive
    deviation = np.sqrt(np.sum(np.abs(left) ** 2, axis=0) / (count - 1) / count / 2.0) / np.abs(mean_u)
    both = np.abs(np.sum(motion * drive.conj(), axis=0)) ** 2
    coherence = both / (np.sum(np.abs(drive) ** 2, axis=0) * np.sum(np.abs(motion) ** 2, axis=0))
    scale = _gain_of_difference(f, record.dt)
    step = float(np.median(np.diff(f))) if f.size > 1 else 1.0 / (period * record.dt)
    return Response(record.name, f, value / scale, coherence, deviation / scale, step, "periods", count)


def _by_welch(record: Record, u: np.ndarray, a: np.ndarray, size: int) -> Response:
    """Welch's averages over half overlapped segments of `size` samples, Hann's window."""
    rate = 1 / record.dt
    f, power, motion, cross = densities(u, a, rate, size)
    averages = EFFECTIVE * (2 * (u.size // size) - 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        value = cross / power
        coherence = np.abs(cross) ** 2 / (power * motion)
        # Bendat and Piersol 2010: relative random error of a gain, of each part
        deviation = np.abs(value) * np.sqrt((1.0 - coherence) / (2.0 * coherence * averages))
    scale = _gain_of_difference(f, record.dt)
    found = Response(record.name, f, value / scale, coherence, deviation / scale, 1.5 * rate / size, "Welch", averages)
    return found.where(_shakes(power))


def _shakes(power: np.ndarray) -> np.ndarray:
    """Return the lines at which the drive has a density of FAINT or more of its STRONG strongest lines' (n,).

    Elsewhere the drive only answers to the encoder, through the controller: coherent, and no response of the axis.
    """
    strong = np.sort(power[1:])[::-1][: STRONG + 1][-1]
    return power > FAINT * strong
