"""Records at the lowest rate that keeps what is judged: a search over candidates looks at these, final fits at the whole.

Errors count below the evaluation bandwidth only. A record is low-passed without phase below its new Nyquist rate, so that
quantisation and noise do not fold into the band, and every k-th sample is kept. Both sides of the balance pass the same
filter, so a model that is right on the record is right on the thinned one.
"""

from collections.abc import Sequence
from dataclasses import replace

from workbench.identify.passes import Passes
from workbench.motion import LowPass, motion
from workbench.record import Record

LEAST = 4.0  # kept rate over the evaluation bandwidth
CUT = 0.4  # of the low pass, over the kept rate


def factor(rate: float, bandwidth: float) -> int:
    """Return k, the samples of which one is kept."""
    return max(1, int(rate / (LEAST * bandwidth)))


def thinned(record: Record, bandwidth: float) -> Record:
    """Return the record at 1/k of its rate; itself where k is 1."""
    k = factor(1 / record.dt, bandwidth)
    if k == 1:
        return record
    low_pass = LowPass(CUT / (k * record.dt), 1 / record.dt, record.time.size)
    channels = {n: low_pass(x)[::k].copy() for n, x in record.channels.items()}
    return replace(record, time=record.time[::k].copy(), channels=channels)


def thin(passes: Sequence[Passes]) -> list[Passes]:
    """Return passes over the thinned records; the same objects where nothing is thinned."""
    found = []
    for p in passes:
        band = p.motion.filter.bandwidth
        record = thinned(p.motion.record, band)
        found.append(p if record is p.motion.record else Passes(motion(record, band)))
    return found
