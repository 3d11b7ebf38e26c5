"""The clocks of two encoders, from the angle between them: far below what a shift of one against the other would show."""

from collections.abc import Iterator

from workbench.checking.alignment import shifted_apart
from workbench.checking.seen import Seen
from workbench.checking.shift import LATE
from workbench.encoders.clocks import late_clock
from workbench.finding import Finding


def skewed(seen: Seen) -> Iterator[Finding]:
    """Say which of two encoders is late, by what the records themselves resolve.

    Where it is the motor's it is said of every record: drive and motion are compared in none of them before that is mended.
    """
    late = late_clock(seen.passes, seen.campaign.plant)
    if late is None:
        return
    s, d, records = late.seconds, late.measured, [r.name for r in seen.campaign.records]
    if abs(s.value) > max(LATE, 1.5 * min(r.dt for r in seen.campaign.records)):  # no clock's: said as a shift is
        other = "position" if late.channel == "load_position" else "load_position"
        yield from (
            shifted_apart(r, late.channel, other, s.value, "the joint carries motion at once") for r in d.records
        )
        return
    for subject in [late.channel] if late.channel == "load_position" else [f"{r}.{late.channel}" for r in records]:
        yield Finding(
            "clock skew", subject, late.sentence,
            {"late": s.value, "low": s.low, "high": s.high, "share": d.share, "drift": d.gains, "by_motor": d.by_motor},
            f"Log both encoders in one task, or declare clock_skew at sensor.{late.channel} with offset = "
            f"{1e3 * late.values['offset']:.3g} ms; not undone, it makes hysteresis and damping of the joint too large.",
        )  # fmt: skip
