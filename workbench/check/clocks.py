"""The clocks of two encoders, from the angle between them: far below what a shift of one against the other would show."""

from collections.abc import Iterator

from workbench.check.seen import Seen
from workbench.finding import Finding
from workbench.identify.clocks import late_clock


def skewed(seen: Seen) -> Iterator[Finding]:
    """Say which of two encoders is late, by what the records themselves resolve."""
    late = late_clock(seen.passes, seen.campaign.plant)
    if late is None:
        return
    s, d = late.seconds, late.measured
    yield Finding(
        "clock skew", late.channel, late.sentence,
        {"late": s.value, "low": s.low, "high": s.high, "share": d.share, "drift": d.gains, "by_motor": d.by_motor},
        f"Log both encoders in one task, or declare clock_skew at sensor.{late.channel} with offset = "
        f"{1e3 * late.values['offset']:.3g} ms; not undone, it makes hysteresis and damping of the joint too large.",
    )  # fmt: skip
