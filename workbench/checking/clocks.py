"""The clocks of two encoders, from the angle between them: far below what a shift of one against the other would show."""

from collections.abc import Iterator
from dataclasses import dataclass

from workbench.checking.alignment import Apart
from workbench.checking.seen import Seen
from workbench.checking.shift import LATE
from workbench.encoders.clocks import Late, late_clock


@dataclass(frozen=True)
class Skewed:
    """An encoder's clock is late. record: of which it is found; "" where it is found of the campaign as a whole."""

    record: str
    late: Late


def skewed(seen: Seen) -> Iterator[Apart | Skewed]:
    """Yield which of two encoders is late, by what the records themselves resolve.

    Where it is the motor's it is so of every record: drive and motion are compared in none of them before that is mended.
    """
    late = late_clock(seen.inverses, seen.campaign.plant)
    if late is None:
        return
    s, records = late.seconds, [r.name for r in seen.campaign.records]
    if abs(s.value) > max(LATE, 1.5 * min(r.dt for r in seen.campaign.records)):  # no clock's: a shift
        other = "position" if late.channel == "load_position" else "load_position"
        yield from (Apart(r, late.channel, other, s.value) for r in late.measured.records)
        return
    yield from (Skewed(r, late) for r in ([""] if late.channel == "load_position" else records))
