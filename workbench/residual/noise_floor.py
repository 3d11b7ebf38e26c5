"""How small the residual could be: torque noise in the band, and encoder counts seen through the derivative filter.

Torque noise is read off the drive above the evaluation bandwidth and taken as white below it, where it is white there. The encoders' part is the
change of the required drive when a motion that runs between their counts is read in counts.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isfinite

import numpy as np

from workbench.inverse.balances import required
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import MOTION_BAND, LowPass, motion
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, ROLES, VALIDATION, Record

ENCODERS = ("position", "load_position")
COLOURED = 0.7  # n of a noise whose power goes with f^-n above the band, from which it is not white
SEGMENT = 0.25  # s, in which the residual's steady part is looked for
BANDS = 12  # of frequency, for it
QUIET = (1.6, 0.42)  # band read for noise: from this times the evaluation bandwidth to this times the sampling rate

# Share of a floor, that a model may leave of what it was not fitted to before the model is doubted instead of the floor. Of 129 campaigns and axes two,
# whose causes are right, left 0.71 and 0.84 of it, the others 1.009 and more. Halved, nothing changes; doubled, no floor is lowered, and these two
# are doubted; a prediction that had seen the drive would leave next to nothing
REFUTES = 0.5
# Values fitted over independent samples, below which a fit takes next to nothing of their noise (half of that in rms). Of 174 campaigns and axes two
# left less of identification than the floor that is read (0.98 and 0.88 of it), with 0.0035 and 0.0021 values a sample: halved or doubled, no change
FEW = 0.01
TOLD = 0.9  # of a floor, from which an error below it is no alarm


def _quiet_spectrum(inverses: InverseDynamics) -> tuple[np.ndarray, np.ndarray] | None:
    """Return (frequencies, power of the drive) above the evaluation band, or None where no quiet band is left."""
    m = inverses.motion
    spectrum = np.abs(np.fft.rfft(m.u - m.filter(m.u))) ** 2
    f = np.fft.rfftfreq(m.u.size, m.dt)
    band = (f > QUIET[0] * m.filter.bandwidth) & (f < QUIET[1] / m.dt)
    if np.count_nonzero(band) < 50:
        return None
    unseen = (1 - 1 / (1 + (f[band] / m.filter.bandwidth) ** 8)) ** 2
    return f[band], spectrum[band] / np.maximum(unseen, 1e-3)


def _drive_noise(inverses: InverseDynamics) -> float:
    """Return the rms of the drive's noise behind the evaluation filter, or 0 where no quiet band is left to read it."""
    found = _quiet_spectrum(inverses)
    if found is None:
        return 0.0
    m = inverses.motion
    _, power = found
    response = 1 / (1 + (np.fft.rfftfreq(m.u.size, m.dt) / m.filter.bandwidth) ** 8)
    density = np.median(power) / np.log(2)  # median of a chi-square of two degrees of freedom
    return float(np.sqrt(2 * density * np.sum(response**2))) / m.u.size


def _between_counts(x: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return a position (n,) that a quantised reading x (n,) may have come from: straight from step to step of the count.

    Between two steps nothing but their places is known; a low pass alone would keep the stairs of a slow motion.
    """
    steps = np.flatnonzero(np.diff(x))
    if steps.size < 2:
        return np.array(x)
    times = np.concatenate([t[:1], 0.5 * (t[steps] + t[steps + 1]), t[-1:]])
    return np.interp(t, times, np.concatenate([x[:1], 0.5 * (x[steps] + x[steps + 1]), x[-1:]]))


def _in_counts(x: np.ndarray, count: float) -> np.ndarray:
    """Return a position (n,) as an encoder reads it.

    Where it moves by a count a sample or more, the error of each sample is its own, evenly spread over a count: the jitter of
    a real axis sees to that, while a smooth motion would be rounded in a pattern.
    """
    read = np.round(x / count) * count
    fast = np.abs(np.diff(x, append=x[-1])) >= count
    spread = np.random.default_rng(0).uniform(-0.5, 0.5, x.size)
    return np.where(fast, x + count * spread, read)


def _read_again(inverses: InverseDynamics) -> tuple[Record, Record] | None:
    """Return (a record of a motion that runs between the counts, that motion as its encoders read it); None without counts."""
    m = inverses.motion
    record = m.record
    counts = {n: c for n, c in record.resolution.items() if n in ENCODERS and n in record.channels and c > 0}
    if not counts:
        return None
    smooth = LowPass(MOTION_BAND * m.filter.bandwidth, 1 / m.dt, m.u.size)
    true = {n: smooth(_between_counts(record.channels[n], m.t)) for n in counts}
    read = {n: _in_counts(x, counts[n]) for n, x in true.items()}
    return tuple(replace(record, channels={**record.channels, **positions}) for positions in (true, read))


def _encoder_noise(inverses: InverseDynamics, plant: Plant) -> float:
    """Return the rms change of the filtered required drive when motion between counts is read in counts.

    All encoders at once, through the derivative filter and through operators with memory alike: what the fit would be
    left with on a drive without noise. Where the drive's balance counts: at a rest that does not, friction that turns within a
    count has it flicker by its whole level.
    """
    records = _read_again(inverses)
    if records is None:
        return 0.0
    m = inverses.motion
    true, read = (m.filter(required(InverseDynamics(motion(r, m.filter.bandwidth)), plant)) for r in records)
    left = (read - true)[m.keep]
    left = left if inverses.counts is None else left[inverses.counts[0, m.keep]]
    return float(np.sqrt(np.mean(left**2))) if left.size else 0.0


def _coloured(inverses: Sequence[InverseDynamics]) -> bool:
    """Whether the drive's noise falls with frequency above the band, so that it says nothing of the noise inside.

    Its power goes with f^-n; n from the medians of the quiet band's first and last third, of the record where it is least:
    steps of the command fall with frequency too.
    """
    falls = []
    for p in inverses:
        found = _quiet_spectrum(p)
        if found is not None:
            (low, _, high), (below, _, above) = (np.array_split(x, 3) for x in found)
            ratio = np.median(below) / max(np.median(above), 1e-300)
            falls.append(float(np.log(max(ratio, 1e-300)) / np.log(np.mean(high) / np.mean(low))))
    return not falls or min(falls) > COLOURED


def stationary_rms(residuals: Sequence[np.ndarray], dt: float, bandwidth: float) -> float:
    """Return the rms of a residual's steady part: in each band of frequency, what its quietest quarter of time holds.

    residuals: (n,) each, behind the evaluation filter. Power in segments of SEGMENT s; of the segments the lower quartile,
    over that of as many degrees of freedom of white noise (Wilson and Hilferty 1931). What comes and goes with place, speed
    or moment stands out of it; what is there all the time does not, and counts as noise.
    """
    n = round(SEGMENT / dt)
    starts = [r[i : i + n] for r in residuals for i in range(0, r.size - n + 1, n // 2)]
    if len(starts) < 8:
        return 0.0
    parts = np.array(starts)
    taper = np.hanning(n)
    power = np.abs(np.fft.rfft((parts - parts.mean(axis=1, keepdims=True)) * taper, axis=1)) ** 2
    f = np.fft.rfftfreq(n, dt)
    inside = np.flatnonzero((f > 0) & (f < 1.5 * bandwidth))
    total = 0.0
    for group in np.array_split(inside, min(BANDS, inside.size)):
        freedom = 2.0 * group.size / 1.5  # neighbouring lines of a Hann taper share a third
        quartile = (1 - 2 / (9 * freedom) - 0.6745 * np.sqrt(2 / (9 * freedom))) ** 3
        lines = group.size + (1 if group[0] == 1 else 0)  # the mean was taken off: as much as beside it
        total += lines * float(np.quantile(power[:, group].mean(axis=1), 0.25)) / quartile
    return float(np.sqrt(2 * total / (n * np.sum(taper**2))))


def noise_rms(inverses: Sequence[InverseDynamics], plant: Plant, steady: float = 0.0) -> dict[str, float]:
    """Return record -> the rms of the filtered residual, in N*m or N, that drive noise and encoder counts alone would leave.

    The noise belongs to the drive, not to the motion: the quietest record tells it, because steps of the command look like
    noise above the band. steady: as `with_stationary` takes it.
    """
    heard = [n for n in (_drive_noise(p) for p in inverses) if n > 0]
    quietest = min(heard, default=0.0)
    found = {p.motion.record.name: float(np.hypot(quietest, _encoder_noise(p, plant))) for p in inverses}
    return with_stationary(found, inverses, steady)


def with_stationary(level: dict[str, float], inverses: Sequence[InverseDynamics], steady: float) -> dict[str, float]:
    """Return levels that are no lower than the steady part of a residual, where the drive's noise is coloured.

    steady: `stationary_rms` of the residual of the model with what was added. Coloured noise (or a signal that was filtered before it
    was logged) says nothing above the band of what is inside.
    """
    if steady > 0.0 and _coloured(inverses):
        return {name: max(x, steady) for name, x in level.items()}
    return level


def floor(inverses: Sequence[InverseDynamics], level: Mapping[str, float]) -> dict[str, float]:
    """Return role -> the nrmse that residuals of these levels make."""
    result = {}
    for role in ROLES:
        noise = power = 0.0
        for p in sorted(inverses, key=lambda p: p.motion.record.name):
            if p.motion.record.role == role:
                n = p.motion.keep.stop - p.motion.keep.start
                noise += n * level[p.motion.record.name] ** 2
                power += float(np.sum(p.motion.filter(p.motion.u)[p.motion.keep] ** 2))
        result[role] = float(np.sqrt(noise / power)) if power > 0 else float("nan")
    return result


def refuted(level: Mapping[str, float], left: Mapping[str, float], values: float = 1.0) -> dict[str, float]:
    """Return role -> nrmse of a floor that is no higher than what a model leaves of what it was not fitted to, in both roles by the same share.

    left: what it leaves, by role; of validation NaN where there is no such record. values: that were fitted, over the independent samples of the
    identification records (`fitted`): below FEW these records are as good as not fitted. No model leaves less than noise of a record that it was
    not fitted to, so that noise was read too high: a controller's answer to the counts of its encoder stands above the band like noise, and
    moves the axis; at a constant speed counts are rounded in a pattern that is no noise in the band. What leaves less than REFUTES of a floor refutes
    itself. Within TOLD of what then is left of a role, that is its floor.
    """
    judges = ROLES if values < FEW else (VALIDATION,)
    share = min((left[r] / level[r] for r in judges if level[r] > 0.0 and isfinite(left[r])), default=1.0)
    if not REFUTES <= share < 1.0:
        return dict(level)
    lower = {role: x * share for role, x in level.items()}
    return {role: min(x, max(left[role], TOLD * x)) for role, x in lower.items()}


def fitted(values: int, inverses: Sequence[InverseDynamics]) -> float:
    """Return how many values were fitted, over the independent samples of the identification records: 2 B T of a band B over T seconds."""
    known = (p.motion for p in inverses if p.motion.record.role == IDENTIFICATION)
    samples = sum(2.0 * m.filter.bandwidth * m.dt * (m.keep.stop - m.keep.start) for m in known)
    return values / samples if samples > 0.0 else 1.0
