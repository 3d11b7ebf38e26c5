"""How small the residual could be: torque noise in the band, and encoder counts seen through the derivative filter.

Torque noise is read off the drive above the evaluation bandwidth and taken as white below it. The encoders' part is the
change of the required drive when a motion that runs between their counts is read in counts.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.identify.passes import Passes, required
from workbench.motion import MOTION_BAND, LowPass, motion
from workbench.plant import Plant
from workbench.record import ROLES

ENCODERS = ("position", "load_position")
QUIET = (1.6, 0.42)  # band read for noise: from this times the evaluation bandwidth to this times the sampling rate


def drive_noise(passes: Passes) -> float:
    """Return the rms of the drive's noise behind the evaluation filter, or 0 where no quiet band is left to read it."""
    m = passes.motion
    rate = 1 / m.dt
    spectrum = np.abs(np.fft.rfft(m.u - m.filter(m.u))) ** 2
    f = np.fft.rfftfreq(m.u.size, m.dt)
    band = (f > QUIET[0] * m.filter.bandwidth) & (f < QUIET[1] * rate)
    if np.count_nonzero(band) < 50:
        return 0.0
    response = 1 / (1 + (f / m.filter.bandwidth) ** 8)
    unseen = (1 - response[band]) ** 2
    density = np.median(spectrum[band] / np.maximum(unseen, 1e-3)) / np.log(2)  # median of a chi-square of two degrees
    return float(np.sqrt(2 * density * np.sum(response**2))) / m.u.size


def between_counts(x: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return a position (n,) that a quantised reading x (n,) may have come from: straight from step to step of the count.

    Between two steps nothing but their places is known; a low pass alone would keep the stairs of a slow motion.
    """
    steps = np.flatnonzero(np.diff(x))
    if steps.size < 2:
        return np.array(x)
    times = np.concatenate([t[:1], 0.5 * (t[steps] + t[steps + 1]), t[-1:]])
    return np.interp(t, times, np.concatenate([x[:1], 0.5 * (x[steps] + x[steps + 1]), x[-1:]]))


def encoder_noise(passes: Passes, plant: Plant) -> float:
    """Return the rms change of the filtered required drive when motion between counts is read in counts.

    All encoders at once, through the derivative filter and through operators with memory alike: what the fit would be
    left with on a drive without noise.
    """
    m = passes.motion
    record = m.record
    counts = {n: c for n, c in record.resolution.items() if n in ENCODERS and n in record.channels and c > 0}
    if not counts:
        return 0.0
    smooth = LowPass(MOTION_BAND * m.filter.bandwidth, 1 / m.dt, m.u.size)
    true = {n: smooth(between_counts(record.channels[n], m.t)) for n in counts}
    read = {n: np.round(x / counts[n]) * counts[n] for n, x in true.items()}

    def drive(positions, resolution):
        seen = replace(record, channels={**record.channels, **positions}, resolution=resolution)
        return m.filter(required(Passes(motion(seen, m.filter.bandwidth)), plant))

    exact = {**record.resolution, **dict.fromkeys(counts, 0.0)}
    difference = (drive(read, record.resolution) - drive(true, exact))[m.keep]
    return float(np.sqrt(np.mean(difference**2)))


def floor(passes: Sequence[Passes], plant: Plant) -> dict[str, float]:
    """Return role -> the nrmse that drive noise and encoder counts alone would leave.

    The noise belongs to the drive, not to the motion: the quietest record tells it, because steps of the command look
    like noise above the band.
    """
    result = {}
    heard = [n for n in (drive_noise(p) for p in passes) if n > 0]
    quietest = min(heard, default=0.0)
    for role in ROLES:
        noise = power = 0.0
        for p in sorted(passes, key=lambda p: p.motion.record.name):
            if p.motion.record.role == role:
                n = p.motion.keep.stop - p.motion.keep.start
                noise += n * (quietest**2 + encoder_noise(p, plant) ** 2)
                power += float(np.sum(p.motion.filter(p.motion.u)[p.motion.keep] ** 2))
        result[role] = float(np.sqrt(noise / power)) if power > 0 else float("nan")
    return result
