"""Signs: of the drive against the motion it causes, of the encoders against the reference and against each other."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.checking.balance import Balance
from workbench.checking.seen import Seen
from workbench.identification.bounded import bounded
from workbench.record import Record

EXPLAINED = 0.5  # of the drive's power: what a turned drive must be explained by, and twice what it is as it stands
FOLLOWS = 0.95  # correlation from which one channel is taken to follow another


@dataclass(frozen=True)
class Slope:
    """How a channel follows another: x = slope of + constant, with this correlation (without its sign)."""

    record: str
    channel: str
    other: str
    slope: float
    correlation: float


@dataclass(frozen=True)
class Against:
    """The drive of a record counts against its position.

    as_it_stands, turned: share of its power that inertia and friction explain, and that they explain of it with its sign turned.
    """

    record: str
    channel: str
    as_it_stands: float
    turned: float


def slopes(records: Sequence[Record]) -> list[Slope]:
    """Return how encoders follow the reference and each other, where they do."""
    found = []
    for r in records:
        pairs = [("position", "reference"), ("load_position", "reference"), ("load_position", "position")]
        for channel, other in pairs:
            if channel in r.channels and other in r.channels and not (r.locked and channel == "load_position"):
                x, y = (r.channels[n] - np.mean(r.channels[n]) for n in (channel, other))
                whole = float(np.sqrt((x @ x) * (y @ y)))
                if whole > 0 and abs(x @ y) > FOLLOWS * whole:
                    found.append(Slope(r.name, channel, other, float(x @ y) / float(y @ y), float(abs(x @ y)) / whole))
    return found


def _share(b: Balance, parameters: np.ndarray, moment: np.ndarray) -> float:
    """Return the share of the drive's power that these parameters explain."""
    left = b.power - 2 * parameters @ moment + parameters @ b.gram @ parameters
    return 1.0 - float(left) / max(b.power, 1e-300)


def _quickly(b: Balance) -> float:
    """Return what the plant explains of the drive at least: parameters that come out below their bounds are left out."""
    moment = b.columns.T @ (b.drive - np.mean(b.drive))
    used = np.ones(moment.size, dtype=bool)
    c = b.solved(moment)
    while np.any(c < b.lower):
        used &= c >= b.lower
        c = np.zeros(moment.size)
        c[used] = replace(b, columns=b.columns[:, used]).solved(moment[used])
    return _share(b, c, moment)


def _explained(b: Balance, turned: float) -> float:
    """Return the share of the drive's power that the plant explains with parameters within their bounds.

    Inertia and friction are not negative: a drive that counts against the position leaves them nothing to explain.
    turned: -1 for the drive turned round.
    """
    drive = turned * (b.drive - np.mean(b.drive))
    c = bounded(b.columns, drive, b.lower, np.full(b.lower.size, np.inf))
    return _share(b, c, b.columns.T @ drive)


def _reversed_drives(seen: Seen) -> list[tuple[Balance, float, float]]:
    """Return (balance, share explained as it stands, share explained when turned) of records whose drive is reversed."""
    found = []
    for b in seen.aligned:
        if _quickly(b) < EXPLAINED:
            as_it_is, turned = _explained(b, 1.0), _explained(b, -1.0)
            if turned > EXPLAINED and as_it_is < 0.5 * turned:
                found.append((b, as_it_is, turned))
    return found


def signs(seen: Seen) -> Iterator[Slope | Against]:
    """Yield which channel counts the wrong way: an encoder (against another channel) where the reference tells, else the drive."""
    negative = [s for s in slopes(seen.campaign.records) if s.slope < 0]
    blamed = {(s.record, s.channel) for s in negative if s.other == "reference"}
    reversed_ = _reversed_drives(seen)
    turned = {b.record.name for b, *_ in reversed_}
    for s in negative:  # two encoders against each other: the motor's is wrong where the drive says so as well
        if s.other == "position" and not {(s.record, "position"), (s.record, "load_position")} & blamed:
            blamed.add((s.record, "position" if s.record in turned else "load_position"))
    for s in negative:
        if (s.record, s.channel) in blamed or (s.record, s.other) in blamed:
            channel, other = (s.channel, s.other) if (s.record, s.channel) in blamed else (s.other, s.channel)
            blamed.discard((s.record, channel))
            yield replace(s, channel=channel, other=other)
    wrong = {s.record for s in negative if s.channel == "position" or s.other == "position"}
    for b, as_it_is, when_turned in reversed_:
        if b.record.name not in wrong:
            yield Against(b.record.name, seen.drive, as_it_is, when_turned)
