"""Records at the lowest rate that keeps what is judged: a search over candidates looks at these, final fits at the whole.

Errors count below the evaluation bandwidth only. A record is low-passed without phase below its new Nyquist rate, so that
quantisation and noise do not fold into the band, and read at the new rate: a ratio p/q of the old one, so that a log of
1 kHz with a band of 150 Hz is kept at 600 Hz. Both sides of the balance pass the same filter, so a model that is right on the
record is right on the thinned one.
"""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import ceil

import numpy as np

from workbench.identification.passes import Passes
from workbench.identification.shift import between
from workbench.motion import LowPass, motion
from workbench.record import Record

LEAST = 4.0  # kept rate over the evaluation bandwidth, at least
CUT = 0.4  # of the low pass, over the kept rate
FRACTIONS = 12  # largest q of the ratio p/q
FINE = 16.0  # rate over the evaluation bandwidth at which operators of the motion's increments run, at least


def ratio(rate: float, bandwidth: float, least: float = LEAST) -> Fraction:
    """Return the kept rate over `rate`: the least p/q, q up to FRACTIONS or p = 1, with `least`; 1 where nothing is to gain."""
    least = least * bandwidth / rate
    if least >= 1.0:
        return Fraction(1)
    whole = Fraction(1, int(1.0 / least))
    return min([whole, *(Fraction(ceil(least * q - 1e-9), q) for q in range(1, FRACTIONS + 1))])


def thinned(record: Record, bandwidth: float, least: float = LEAST) -> Record:
    """Return the record at the lowest rate that is `least` times the band; itself where that is its own."""
    kept = ratio(1 / record.dt, bandwidth, least)
    if kept == 1:
        return record
    low_pass = LowPass(CUT * float(kept) / record.dt, 1 / record.dt, record.time.size)
    steps = np.arange(int((record.time.size - 1) * kept) + 1) * (kept.denominator / kept.numerator)
    channels = {n: between(low_pass(x), steps) for n, x in record.channels.items()}
    return replace(record, time=record.time[0] + record.dt * steps, channels=channels)


def thin(passes: Sequence[Passes], least: float = LEAST) -> list[Passes]:
    """Return passes over the thinned records; the same objects where nothing is thinned. least: kept rate over the band."""
    return [thin_one(p, least) for p in passes]


def thin_one(p: Passes, least: float = LEAST, of: type[Passes] = Passes) -> Passes:
    """Return passes, `of` this class, over one thinned record, whose operators run at FINE times the band."""
    band = p.motion.filter.bandwidth
    record = thinned(p.motion.record, band, least)
    if record is p.motion.record:
        return p
    fine = thinned(p.motion.record, band, max(FINE, least))
    finer = p if fine is p.motion.record else Passes(motion(fine, band))
    low_pass = LowPass(CUT / record.dt, 1 / fine.dt, fine.time.size)
    steps = (record.time - fine.time[0]) / fine.dt

    def coarse(outputs: np.ndarray) -> np.ndarray:
        return np.stack([between(x, steps) for x in low_pass(outputs)])

    return of(motion(record, band), finer, coarse)
