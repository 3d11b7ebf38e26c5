"""Gaps of a log that are longer than the evaluation band allows: what the axis did in them is not known, and no balance counts there.

A record with samples missing is put on one rate by straight lines. Of a motion within a third of a period of the band's edge such a line
leaves nearly half, and an axis that turns there leaves a moment of a size that no disturbance has.
"""

import numpy as np

from workbench.motion import Motion

# Periods of the evaluation bandwidth, from which a gap hides what is judged. A slide on air bearings whose log of 70 Hz misses 8 ms at a turn left 20 N
# of a drive of 110 there, and its complete model was "unknown". Halved or doubled, that one and 28 more axes with such gaps keep their verdicts
HIDES = 0.3
ABOUT = 0.5  # the same, for how long on either side a gap shows behind the filter. Halved or doubled, these 29 keep their verdicts, too
# Of a record, up to which it is not counted for its gaps: of one that would be left out there is nothing better. No axis that was seen has so many
MOST = 0.5


def counting(motion: Motion, counts: np.ndarray | None) -> np.ndarray | None:
    """Return where (2, n) the balances of a motion count: as `counts` says, everywhere where it is None, and about no gap that hides what is judged."""
    period, t = 1.0 / motion.filter.bandwidth, motion.record.time
    hidden = np.zeros(t.size, dtype=bool)
    for a, b in motion.record.unseen:
        if b - a > HIDES * period:
            hidden[np.searchsorted(t, a - ABOUT * period) : np.searchsorted(t, b + ABOUT * period, "right")] = True
    if not hidden.any() or hidden.mean() > MOST:
        return counts
    return np.stack([~hidden, ~hidden]) if counts is None else counts & ~hidden
