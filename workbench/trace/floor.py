"""How small the residual could be: torque noise in the band, and encoder counts seen through the derivative filter.

First version. Torque noise is read off the drive above the evaluation bandwidth and taken as white below it; the
encoder's part is the change of the required drive when the smoothed position is rounded to counts once more.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.identify.passes import Passes, required
from workbench.motion import MOTION_BAND, LowPass, motion
from workbench.plant import Plant
from workbench.record import ROLES

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


def encoder_noise(passes: Passes, plant: Plant) -> float:
    """Return the rms change of the filtered required drive when the smoothed position is rounded to counts."""
    m = passes.motion
    if m.counts <= 0:
        return 0.0
    record = m.record
    smooth = LowPass(MOTION_BAND * m.filter.bandwidth, 1 / m.dt, m.u.size)(record.channels["position"])
    rounded = np.round(smooth / m.counts) * m.counts

    def drive(position):
        seen = replace(record, channels={**record.channels, "position": position})
        return m.filter(required(Passes(motion(seen, m.filter.bandwidth)), plant))

    difference = (drive(rounded) - drive(smooth))[m.keep]
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
