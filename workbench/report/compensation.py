"""The chapter on what cancelling named effects is worth: the following error of a slow motion, without and with it."""

from collections.abc import Mapping

import numpy as np

from workbench.cancellation.worth import CancellationWorth
from workbench.compensation import REFERENCE
from workbench.finding import title
from workbench.report import numbers
from workbench.report.contents import Chapter, Figure, Paragraph, Table
from workbench.report.drawing import AFTER, BEFORE, svg
from workbench.report.wording import listed, typeset


def compensation_chapter(worth: CancellationWorth, x: str, of: str = "") -> Chapter:
    """What it is worth, in a table and over time. x: unit of position. of: name of a further compensation."""
    found = worth.found
    heading = f"Compensated, the error of a slow motion that turns is {numbers.number(found.ratio, 2)} times smaller"

    def draw(axes):
        (a,) = axes
        scale, shown = numbers.prefixed(found.errors[0.0], x)
        step = max(found.time.size // 2000, 1)
        a.plot(found.time[::step], scale * found.without[::step], color=BEFORE, label="without")
        a.plot(found.time[::step], scale * found.with_it[::step], color=AFTER, label="compensated")
        a.set_xlabel("time (s)")
        a.set_ylabel(f"r − q ({shown})")
        a.legend(loc="upper right")

    figure = Figure(
        f"compensation_{of}" if of else "compensation",
        lambda: svg(heading, draw, height=2.6),
        "Error over time.",
        f"Two traces. {heading}.",
    )
    blocks = (Paragraph(_text(worth, x)), _table(worth, x), figure)
    return Chapter("Compensation of what was named" + (f": the {of}" if of else ""), blocks)


def _text(worth: CancellationWorth, x: str) -> str:
    """Say what is compensated, by what, and what that leaves."""
    given, found = worth.given, worth.found
    names, source = listed([title(e.partition("@")[0]) for e in given.effects]), given.options["source"]
    feedback = (
        "It hangs on the reference alone, so the loop's margins are what they were."
        if source == REFERENCE
        else "It closes a path of its own around the plant: margins are those of the plant without these effects."
    )
    off, left = (numbers.scaled(found.errors[g], x) for g in (0.0, 1.0))
    return (
        f"The largest following error of a slow motion falls from {off} to {left} once the command gets what {names} will take of it, "
        f"from the {source} position, by the definition that simulation and identification have. The controller is “{given.controller}”, the motion a sine of {numbers.scaled(given.slow.amplitude, x)} "
        f"at {given.slow.frequency:g} Hz. {feedback}"
    )


def _table(worth: CancellationWorth, x: str) -> Table:
    """What is left at each gain of the compensation, and by the plant's true law where that is another one."""
    found, true, ms, share = worth.found, worth.true, worth.sensitivity, worth.given.mismatch
    labels = {0.0: "none", 1.0: "as identified"} | {
        1.0 + s: f"{typeset(f'{100 * s:+.0f}')} % of it" for s in (-share, share)
    }
    rows = [
        (labels[g], numbers.scaled(found.errors[g], x), _factor(found.errors[0.0] / found.errors[g]) if g else "", _margin(ms, g))
        for g in labels
    ]  # fmt: skip
    if true is not found:
        rows.append(("by the plant's true law", numbers.scaled(true.errors[1.0], x), _factor(true.ratio), ""))
    columns = ("compensation", "largest following error", "smaller by", "Ms")
    caption = (
        "Following error over the last two periods. Ms: the largest |S| of the linearised loop with the compensation in it, "
        "over amplitudes from two counts to gross sliding."
    )
    kept = slice(None) if ms else slice(3)
    return Table(columns[kept], tuple(r[kept] for r in rows), caption if ms else caption.split(" Ms:")[0], "lrrr"[kept])


def _margin(ms: Mapping[float, float], gain: float) -> str:
    """Ms at one gain of the compensation, as a table shows it."""
    value = ms.get(gain, np.nan)
    return numbers.number(value) if np.isfinite(value) else "unstable" if gain in ms else ""


def _factor(ratio: float) -> str:
    return f"{numbers.number(ratio, 2)} times" if np.isfinite(ratio) else "it does not follow"
