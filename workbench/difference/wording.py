"""What is said of two campaigns: where their records are not alike, which parameter moved, and what that comes to."""

from collections.abc import Sequence

from workbench.finding import Finding, capital, located
from workbench.identification.result import Estimate


def other_counts(channel: str, before: float, after: float) -> Finding:
    """Say that an encoder is read in other steps, SI."""
    what = f"'{channel}' is read in steps of {before:.3g} before and {after:.3g} after"
    return _not_alike("encoder", what, before, after)


def other_reach(what: str, before: float, after: float) -> Finding:
    """Say that records cover another range of something, SI."""
    return _not_alike(what, f"{what} reach over {before:.3g} before and {after:.3g} after", before, after)


def _not_alike(subject: str, what: str, before: float, after: float) -> Finding:
    return Finding(
        "not alike", subject,
        f"The records are not alike: {what}; a parameter that stands in for an effect that the model lacks may move with this alone.",
        {"before": before, "after": after}, "record the same motions in both campaigns",
    )  # fmt: skip


def change_sentence(a: Estimate, b: Estimate, half: float, moved: bool) -> str:
    """Return whether a parameter moved from one estimate to the other. half: half width of the difference's interval."""
    apart = b.value - a.value
    what = f"{capital(located(a.effect, a.at))}, {a.meaning}"
    unit = "" if a.unit in ("1", "") else f" {a.unit}"
    if not moved:
        return f"{what} did not move: {a.value:.4g} and {b.value:.4g}{unit}; a change of {half:.1g} would have shown."
    share = f" ({100 * abs(apart) / abs(a.value):.2g} %)" if a.value else ""
    return (
        f"{what} {'rose' if apart > 0 else 'fell'} from {a.value:.4g} to {b.value:.4g}{unit}, by {abs(apart):.2g}{share} "
        f"with an interval of +-{half:.1g}."
    )


def difference_sentence(moved: Sequence[str], count: int, jointly: bool, chance: float) -> str:
    """Return what a difference comes to. moved: names, of `count` parameters. jointly: whether they moved together, at this chance."""
    if moved:
        return f"{len(moved)} of {count} parameters moved: {', '.join(moved)}."
    if jointly:
        return (
            f"No parameter moved by itself, but together they did (chance {chance:.1g} where nothing changed): these records "
            "know some of them only together."
        )
    return f"Nothing moved that these records can show, of {count} parameters."
