"""Counts that an encoder loses: its reading shifts by a whole piece within one sample, again and again, and stays shifted.

The increments of a reading are predicted from the ORDER before them by least squares, a_1 ... a_p over the record. What is not
predicted of a level that shifts by s is s (1, -a_1, ..., -a_p); of a push that the body felt s (1, 0, ...); of a glitch of one sample
the difference of two shifts. Whichever has the largest t statistic is what it is (Chen and Liu 1993, J. Am. Stat. Assoc. 88, 284-297).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.record import Record

ENCODERS = ("position", "load_position")
# What halving and doubling does is of 232 campaigns and axes of seven sources, of which two hold an encoder that loses counts.
ORDER = 8  # increments that predict the next one; neither changes any
BLOCK = 64  # samples over which the scale of what is not predicted is taken: a chirp's is not its beginning's; neither changes any
PLAIN = 10.0  # t statistic of a shift. Halved, two logs of one robot lose counts, too; doubled, no change
LEAST = 2.5  # counts of the encoder: two readings and their dither add up to less. Doubled, a disc that loses 1 to 5 is not found; halved, no change
# Power of its t statistic over that of a push, and of a glitch. At most 1 + a_1^2 + ... + a_p^2 can come out, of a slow axis 2 to 3:
# from 1.0 to 1.75 no campaign changes, at 0.75 (and halved) four sound axes lose counts, at 2.0 (and doubled) neither of the two does
RATHER = 1.3
APART = 12  # samples within which one event is one event. Halved, an axis that knocks loses counts; doubled, no change
# An axis that knocks, and a log that slips once, show up to two a record
OFTEN, EACH = 6, 2.0  # shifts of one encoder in all, and in the mean record; neither halved nor doubled changes any


@dataclass(frozen=True)
class Shift:
    """sample: the first behind it. time: s. size: rad or m by which the reading goes on elsewhere."""

    sample: int
    time: float
    size: float


@dataclass(frozen=True, eq=False)
class LostCounts:
    """What one encoder lost. channel: its name. shifts: record -> the shifts there, in time. count: rad or m, 0 where unknown."""

    channel: str
    shifts: Mapping[str, tuple[Shift, ...]]
    count: float

    @property
    def all(self) -> list[Shift]:
        """Every shift, record after record."""
        return [s for found in self.shifts.values() for s in found]

    def mended(self, record: Record) -> Record:
        """Return a record with what was lost put back: later samples are moved by each shift."""
        found = self.shifts.get(record.name, ())
        if not found:
            return record
        x = record.channels[self.channel].copy()
        for s in found:
            x[s.sample :] -= s.size
        return replace(record, channels={**record.channels, self.channel: x})


def lost_counts(records: Sequence[Record]) -> LostCounts | None:
    """Return what the encoder that loses most often lost in the records, None where none does so plainly."""
    found = [lost for channel in ENCODERS if (lost := _lost_by(channel, records))]
    return max(found, key=lambda lost: len(lost.all), default=None)


def _lost_by(channel: str, records: Sequence[Record]) -> LostCounts | None:
    seen = [r for r in records if channel in r.channels and not r.locked]
    shifts = {r.name: shifts_of(r, channel) for r in seen}
    total = sum(map(len, shifts.values()))
    if total < max(OFTEN, EACH * len(seen)):
        return None
    return LostCounts(channel, shifts, max(r.resolution.get(channel, 0.0) for r in seen))


def shifts_of(record: Record, channel: str) -> tuple[Shift, ...]:
    """Return where the reading of a channel shifts within one sample and stays there."""
    d = np.diff(record.channels[channel])
    if d.size < 4 * BLOCK or np.ptp(d) == 0.0:
        return ()
    finest = float(np.min(np.abs(d[d != 0.0])))  # what is declared may be another encoder's
    count = max(record.resolution.get(channel, 0.0), finest)
    before = np.lib.stride_tricks.sliding_window_view(d[:-1], ORDER)[:, ::-1]
    law = np.linalg.lstsq(before, d[ORDER:], rcond=None)[0]
    rest = d[ORDER:] - before @ law
    scale = _scale(rest, count)
    level = np.concatenate([[1.0], -law])
    size, t = _fitted(rest, level, scale)
    _, glitch = _fitted(rest, np.convolve(level, [1.0, -1.0]), scale)
    other = np.maximum(np.abs(rest / scale), np.abs(glitch))
    kept: list[int] = []
    seen = np.zeros(t.size, bool)
    for k in np.argsort(-np.abs(t), kind="stable"):
        if abs(t[k]) < PLAIN:
            break
        if seen[k]:
            continue
        seen[max(k - APART, 0) : k + APART + 1] = True
        rival = float(np.max(other[max(k - 2, 0) : k + 3]))
        if abs(size[k]) >= LEAST * count and t[k] ** 2 >= RATHER * rival**2:
            kept.append(int(k))
    return tuple(Shift(k + ORDER + 1, float(record.time[k + ORDER + 1]), float(size[k])) for k in sorted(kept))


def _scale(rest: np.ndarray, count: float) -> np.ndarray:
    """Return the robust scale (n,) about each sample, the largest of its block and the two beside it; at least a third of a count."""
    blocks = rest[: rest.size // BLOCK * BLOCK].reshape(-1, BLOCK)
    own = 1.4826 * np.median(np.abs(blocks), axis=1)
    padded = np.pad(own, 1, mode="edge")
    widest = np.maximum(np.maximum(padded[:-2], padded[1:-1]), padded[2:])
    each = np.repeat(widest, BLOCK)
    return np.maximum(np.pad(each, (0, rest.size - each.size), mode="edge"), max(count / 3.0, 1e-300))


def _fitted(rest: np.ndarray, pattern: np.ndarray, scale: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (size, t statistic) (n,) of a pattern that begins at each sample."""
    power = float(pattern @ pattern)
    size = np.correlate(np.pad(rest, (0, pattern.size - 1)), pattern, mode="valid") / power
    return size, size * power**0.5 / scale
