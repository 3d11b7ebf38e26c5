"""Records at the lowest rate that keeps what is judged: a search over candidates looks at these, final fits at the whole.

Errors count below the evaluation bandwidth only. A record is low-passed without phase below its new Nyquist rate, so that
quantisation and noise do not fold into the band, and read at the new rate: a ratio p/q of the old one, so that a log of
1 kHz with a band of 150 Hz is kept at 600 Hz. Both sides of the balance pass the same filter, so a model that is right on the
record is right on the decimated one.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import ceil

import numpy as np

from workbench.definition import FORCE
from workbench.inverse.bodies import CHANNEL
from workbench.inverse.dynamics import InverseDynamics
from workbench.inverse.oftener import CUT, read_at, to_rate_of
from workbench.motion import LowPass, motion
from workbench.plant import Plant
from workbench.record import Record

LEAST = 4.0  # kept rate over the evaluation bandwidth, at least
FRACTIONS = 12  # largest q of the ratio p/q
WINDOW = (
    0.05  # s, in which an axis at rest stays within one count: half and twice it change no share at rest by a tenth
)
UNSEEN = 1e-6  # of the travel: stands for a count where none is known
# Rate over the evaluation bandwidth at which operators of the motion's increments run, at least. Halved, a trace takes a quarter less, and every verdict
# and cause of c, d, six measured axes and 59 others' campaigns is the same; but of 96 more one cause is another, and one axis that sticks is not seen to
FINE = 16.0


def ratio(rate: float, bandwidth: float, least: float = LEAST) -> Fraction:
    """Return the kept rate over `rate`: the least p/q, q up to FRACTIONS or p = 1, with `least`; 1 where nothing is to gain."""
    least = least * bandwidth / rate
    if least >= 1.0:
        return Fraction(1)
    whole = Fraction(1, int(1.0 / least))
    return min([whole, *(Fraction(ceil(least * q - 1e-9), q) for q in range(1, FRACTIONS + 1))])


def decimated(record: Record, bandwidth: float, least: float = LEAST) -> Record:
    """Return the record at the lowest rate that is `least` times the band; itself where that is its own."""
    kept = ratio(1 / record.dt, bandwidth, least)
    if kept == 1:
        return record
    low_pass = LowPass(CUT * float(kept) / record.dt, 1 / record.dt, record.time.size)
    steps = np.arange(int((record.time.size - 1) * kept) + 1) * (kept.denominator / kept.numerator)
    return read_at(record, steps, low_pass)


def decimate(
    inverses: Sequence[InverseDynamics], plant: Plant | None = None, least: float = LEAST
) -> list[InverseDynamics]:
    """Return the inverse dynamics over the decimated records; the same objects where nothing changes. least: kept rate over the band.

    plant: as declared; where it holds dry friction without memory at a body, that body's balance does not count at rest.
    """
    return [thin_one(p, plant, least) for p in inverses]


def thin_one(p: InverseDynamics, plant: Plant | None = None, least: float = LEAST) -> InverseDynamics:
    """Return the inverse dynamics over one decimated record, whose operators run at FINE times the band."""
    band = p.motion.filter.bandwidth
    record = decimated(p.motion.record, band, least)
    at_rest = {place: still(p, place, WINDOW) for place in dry(plant)} if plant is not None else {}
    counts = _counting(p, record, at_rest)
    if record is p.motion.record:
        return p if counts is None else InverseDynamics(p.motion, p.fine, p.coarse, counts, p.times)
    finer = p.fine if p.times > 1 else _finer(p, decimated(p.motion.record, band, max(FINE, least)))
    return InverseDynamics(motion(record, band), finer, to_rate_of(record, finer.motion.record), counts)


def _finer(p: InverseDynamics, fine: Record) -> InverseDynamics:
    """Return the inverse dynamics over the record at the rate at which operators run."""
    return p if fine is p.motion.record else InverseDynamics(motion(fine, p.motion.filter.bandwidth))


def dry(plant: Plant) -> list[str]:
    """Return the places of a plant where friction has a direction and no memory: at rest it holds whatever it has to."""
    given = {e.at for e in plant.effects if e.provides}
    return sorted({e.at for e in plant.effects if e.port == FORCE and e.reads == ("dir",)} - given)


def rubs(plant: Plant) -> bool:
    """Whether a plant has friction that holds at rest or remembers its turns."""
    return any(e.port == FORCE and {"dq", "dir"} & {*e.reads} for e in plant.effects)


def still(p: InverseDynamics, place: str, window: float, about: float = 0.0) -> np.ndarray:
    """Return where (n,) the encoder of a place stays within one count for `window` s about a sample, or does within `about` s of it."""
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    m, channel = p.motion, CHANNEL[place]
    if channel not in m.record.channels:
        return np.zeros(m.u.size, dtype=bool)
    x = m.record.channels[channel]
    width = max(2 * round(0.5 * window / m.dt) + 1, 3)
    count = p.bodies.counts(channel) or UNSEEN * float(np.ptp(x))
    rests = maximum_filter1d(x, width) - minimum_filter1d(x, width) <= 1.01 * count
    return maximum_filter1d(rests.view(np.uint8), 2 * round(about / m.dt) + 1).view(bool) if about > 0.0 else rests


def _counting(p: InverseDynamics, kept: Record, at_rest: Mapping[str, np.ndarray]) -> np.ndarray | None:
    """Return (2, n) of bool on the kept record: where the drive's and the load's balance count; None where all of them do."""
    record = p.motion.record
    if p.counts is None and not any(x.any() for x in at_rest.values()):
        return None
    nearest = np.rint((kept.time - record.time[0]) / record.dt).astype(int).clip(0, record.time.size - 1)
    counts = np.ones((2, kept.time.size), dtype=bool) if p.counts is None else p.counts[:, nearest]
    for place, x in at_rest.items():
        counts[int(place == "load")] &= ~x[nearest]
    return counts
