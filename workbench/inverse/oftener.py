"""Operators of a motion's increments along the path between the samples of a slow log.

Where friction turns within a sample, an operator that moves from reading to reading has the turn wrong by half a sample. The path
between them is band-limited, so it is read between them, and what the operators come to along it passes a low pass to the log's rate.
"""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import partial

import numpy as np

from workbench.inverse.shift import Places
from workbench.motion import LowPass, Motion, motion
from workbench.record import Record

RATIOS = 144  # largest q of a ratio p/q of two rates at which a transform gives one from the other
SAME = 1e-6  # of a fine sample, within which two rates and their beginnings are as the ratio says
CUT = 0.4  # of the low pass before a lower rate, over that rate


def read_at(record: Record, steps: np.ndarray, low_pass: Callable[[np.ndarray], np.ndarray] | None = None) -> Record:
    """Return the record with its channels read at `steps` (m,), in samples and fractions of one, behind a low pass where they are fewer."""
    places = Places(steps)
    channels = {n: places.read(low_pass(x) if low_pass else x) for n, x in record.channels.items()}
    return replace(record, time=record.time[0] + record.dt * steps, channels=channels)


def read_oftener(record: Record, times: int) -> Record:
    """Return the record with its channels read `times` as often, by interpolation between its samples."""
    return read_at(record, np.arange((record.time.size - 1) * times + 1) / times)


def moved_oftener(m: Motion, times: int) -> Motion:
    """Return the same motion with its record read `times` as often."""
    return motion(read_oftener(m.record, times), m.filter.bandwidth)


def to_rate_of(record: Record, fine: Record) -> Callable[[np.ndarray], np.ndarray]:
    """Return what takes outputs (k, fine n) at the rate of `fine` to (k, n) at that of `record`."""
    low_pass = LowPass(CUT / record.dt, 1 / fine.dt, fine.time.size)
    ratio = Fraction(fine.dt / record.dt).limit_denominator(RATIOS)
    strays = abs(float(ratio) * record.dt - fine.dt) * fine.time.size + abs(record.time[0] - fine.time[0])
    if strays < SAME * fine.dt:
        return partial(low_pass.at_lower_rate, ratio=ratio, count=record.time.size)
    places = Places((record.time - fine.time[0]) / fine.dt)

    def coarse(outputs: np.ndarray) -> np.ndarray:
        return np.stack([places.read(x) for x in low_pass(outputs)])

    return coarse
