"""Channels that are not on one time axis: the drive against the motion it causes, the motion against its reference."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from workbench.checking.by_model import borne_out, earlier
from workbench.checking.seen import Seen
from workbench.checking.shift import FARTHEST, LATE
from workbench.motion import LowPass

FOLLOWS = 0.9  # share of one channel that another explains
MOST = 0.5  # of the records that follow a reference, more than which stand before it where the log is what is shifted: a slow sine says no time


@dataclass(frozen=True)
class LateDrive:
    """The drive in a record's log comes `late` s after the motion that it causes, before it where negative."""

    record: str
    channel: str
    late: float


@dataclass(frozen=True)
class Apart:
    """One channel of a record stands `late` s after another one, before it where negative, and no axis shifts them so."""

    record: str
    channel: str
    other: str
    late: float


def misaligned(seen: Seen) -> Iterator[LateDrive]:
    """Yield where the drive in the log comes later or earlier than the motion that it causes."""
    found = {b.record.name: late for b, late in zip(seen.balances, seen.delays, strict=True) if late}
    records = {r.name: r for r in seen.campaign.records}
    told = borne_out(seen, {name: earlier(records[name], seen.drive, late) for name, late in found.items()})
    yield from (LateDrive(name, seen.drive, late) for name, late in found.items() if name in told)


def apart(seen: Seen) -> Iterator[Apart]:
    """Yield where two encoders are shifted in time as no axis shifts them; less of it is told by their angle (`checking.clocks`).

    A soft joint shifts them, too, by its load's friction: the declared model has to bear it out.
    """
    found, put_right = {}, {}
    for r in seen.campaign.records:
        if "load_position" in r.channels and not r.locked:
            late = _lag_of(r.channels["load_position"], r.channels["position"], r.dt, seen.campaign.bandwidth)
            if late is not None and abs(late) > max(LATE, 1.5 * r.dt):
                found[r.name], put_right[r.name] = late, earlier(r, "load_position", late)
    told = borne_out(seen, put_right)
    yield from (Apart(name, "load_position", "position", late) for name, late in found.items() if name in told)


def ahead(seen: Seen) -> Iterator[Apart]:
    """Yield where a position comes before its reference, in most of the records in which it follows one: that is the log's. A feedforward leads on
    some motions, and an injected torque moves an axis beside its reference."""
    found, follows = {}, 0
    for r in seen.campaign.records:
        if "reference" in r.channels:
            late = _lag_of(r.channels["position"], r.channels["reference"], r.dt, seen.campaign.bandwidth)
            follows += late is not None
            if late is not None and late < -max(LATE, 1.5 * r.dt):
                found[r.name] = late
    if len(found) > MOST * follows:
        yield from (Apart(name, "position", "reference", late) for name, late in found.items())


def _lag_of(x: np.ndarray, of: np.ndarray, dt: float, bandwidth: float) -> float | None:
    """Return the time in s by which x is later than `of`, None where they do not follow each other.

    Both as velocities below a fifth of the bandwidth, where a joint is stiff.
    """
    slow = LowPass(0.2 * bandwidth, 1.0 / dt, x.size)
    a, b = slow(x, 1), slow(of, 1)
    size = 1 << (2 * x.size - 1).bit_length()
    far = min(round(FARTHEST / dt), x.size // 4)
    both = np.fft.irfft(np.fft.rfft(a, size) * np.conj(np.fft.rfft(b, size)), size)
    shifts = np.arange(-far, far + 1)
    values = both[shifts % size]
    k = int(np.argmax(values))
    whole = float(np.sqrt((a @ a) * (b @ b)))
    if not values[k] > np.sqrt(FOLLOWS) * whole or k in (0, shifts.size - 1):
        return None
    before, at, after = values[k - 1 : k + 2]
    return float((shifts[k] + 0.5 * (before - after) / (before - 2 * at + after)) * dt)
