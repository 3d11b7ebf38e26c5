"""What is said of two encoders: a clock that is late, and counts that were lost."""

from workbench.encoders.clocks import Late
from workbench.encoders.lost_counts import LostCounts
from workbench.finding import LOST_COUNTS, Finding


def lost_finding(lost: LostCounts) -> Finding:
    """Return the finding that an encoder loses counts: how often, how many, and where it was seen first."""
    shown = {name: shifts for name, shifts in lost.shifts.items() if shifts}
    name, first = next((name, shifts[0]) for name, shifts in shown.items())
    sizes = sorted(abs(s.size) / (lost.count or 1.0) for s in lost.all)
    many = f"{round(sizes[0])} to {round(sizes[-1])} counts" if lost.count else f"{sizes[0]:.2g} to {sizes[-1]:.2g}"
    return Finding(
        LOST_COUNTS, lost.channel,
        f"The reading of {lost.channel} shifts by {many} within one sample and stays there, {len(lost.all)} times in "
        f"{len(shown)} of {len(lost.shifts)} records, first in record '{name}' at {first.time:.4f} s: the encoder loses counts, or its line packets.",
        {"shifts": float(len(lost.all)), "time": first.time, "size": first.size},
        "Look at the encoder's line, its supply and what its counter can follow; until then rely on no reading of it over a whole record.",
    )  # fmt: skip


def late_sentence(late: Late) -> str:
    """Return by how much an encoder is read late, and how much of the angle between the two that takes."""
    s, d = late.seconds, late.measured
    other = "position" if late.channel == "load_position" else "load_position"
    word, low, high = ("late", s.low, s.high) if s.value > 0 else ("early", -s.high, -s.low)
    anew = " from where each record begins" if d.restarted else ""
    drift = f", and that changes by {1e3 * late.values['skew']:.2g} ms a second{anew}" if d.gains else ""
    return (
        f"{late.channel} is read {1e3 * abs(s.value):.3g} ms {word} against {other} (95 % interval {1e3 * low:.3g} to "
        f"{1e3 * high:.3g} ms){drift}: this takes {100 * d.share:.0f} % of the angle's power between the two encoders that "
        f"compliance, friction and hysteresis leave."
    )
