"""Where lives what no effect explains: in words, and as what is shaded in the graphs over its coordinate."""

from collections.abc import Mapping

from workbench.finding import capital
from workbench.report import numbers
from workbench.report.contents import Items, StudyResult
from workbench.report.residual_figures import Shade
from workbench.report.wording import listed, span
from workbench.residual.maps import TIME
from workbench.residual.window import DIRECTIONS

SPANS = 12  # told in words


def shade(result: StudyResult) -> Shade | None:
    """Return what is shaded; None where nothing is unexplained, or where it lives nowhere in particular."""
    unknown = result.trace.located
    if not unknown.get("spans"):
        return None
    of = "what the extended model leaves" if result.trace.causes else "the residual's power"
    title = (
        f"{numbers.percent(unknown['share'])} of {of} above what noise leaves at least lives {_whereabouts(unknown)}"
    )
    spans = tuple((low, high) for low, high in unknown["spans"])
    return Shade(unknown["coordinate"], spans, _direction(unknown), title)


def _whereabouts(unknown: Mapping[str, object]) -> str:
    """Return "between 1.20 and 1.50 rad, moving forward", or "at 12 moments"."""
    spans, unit = unknown["spans"], unknown["unit"]
    if unknown["coordinate"] == TIME and len(spans) > 1:
        return f"at {len(spans)} moments"
    direction = _direction(unknown)
    way = f", moving {DIRECTIONS[direction]}" if direction else ""
    return listed([span(low, high, unit) for low, high in spans]) + way


def _direction(unknown: Mapping[str, object]) -> int:
    """Return the direction of motion in which it lives, from the word for it."""
    return next(d for d, word in DIRECTIONS.items() if word == unknown["direction"])


def localised(result: StudyResult) -> Items:
    """Where an unexplained residual lives, in words."""
    unknown = result.trace.located
    facts = []
    if channel := unknown.get("channel"):
        facts.append(f"The reading of {channel} shifts {_whereabouts(unknown)}{_moments(unknown)}.")
        gone = numbers.percent(unknown["share"])
        return Items(
            (
                *facts,
                f"Putting the counts back takes away {gone} of the residual's power on the identification records.",
            )
        )
    if "spans" in unknown:
        facts.append(f"{capital(_whereabouts(unknown))} ({unknown['coordinate']}){_moments(unknown)}.")
        facts.append(f"It holds {numbers.percent(unknown['share'])} of the power above what is calm.")
    elif unknown.get("coordinate") == "frequency":
        facts.append(f"It is a line of the spectrum, at {numbers.exact(unknown['low'], 3)} Hz.")
    else:
        facts.append("It lives nowhere in particular: in no window of position or of speed, and at no moments.")
    told = f"Of the drive's rms, {numbers.percent(unknown['size'])} could be predicted from outside the loop"
    if "times_calm" in unknown:
        told += (
            f"; the residual is {numbers.number(unknown['times_calm'])} times what is calm of it, and outside, fitted without "
            f"it, {numbers.number(unknown['times_calm_outside'])} times"
        )
    return Items((*facts, f"{told}."))


def _moments(unknown: Mapping[str, object]) -> str:
    """Return ": 1.20 to 1.26, 3.70 to 3.76 s" of several moments."""
    spans = unknown["spans"]
    if unknown["coordinate"] != TIME or len(spans) == 1:
        return ""
    told = [f"{numbers.exact(low, 4)} to {numbers.exact(high, 4)}" for low, high in spans[:SPANS]]
    more = f" and {len(spans) - SPANS} more" if len(spans) > SPANS else ""
    return f": {', '.join(told)} s{more}"
