"""What a verdict is, and the rule by which it is given."""

from dataclasses import dataclass, replace

EQUAL = 0.02  # relative difference of two validation errors below which neither model is called better
NOTHING = 1.1  # times what noise and encoders leave: a model that leaves no more than this lacks nothing that records could show
BORNE_OUT, NOT_BORNE_OUT, NOT_HELD = "borne out", "not borne out", "not in these records"
CARRIED = "carried"  # the records that come with the study


@dataclass(frozen=True)
class Statement:
    """said: by the review. records: which ones judge it. verdict: one of the three above. numbers: what it rests on."""

    said: str
    records: str
    verdict: str
    numbers: str


def verdict(holds: bool, held: bool = True) -> str:
    """Return what records say to a statement. held: whether they hold what it is about."""
    return BORNE_OUT if holds else NOT_BORNE_OUT if held else NOT_HELD


def better(error: float, than: float) -> bool:
    """Whether one model's validation error is below another's by more than EQUAL."""
    return error < (1.0 - EQUAL) * than


def decisive(statements: list[Statement]) -> list[Statement]:
    """Return each statement by the records that can decide it; what those say that hold no such effect stands in its numbers."""
    silent = {s.said: s for s in statements if s.verdict == NOT_HELD}
    told = {s.said for s in statements if s.verdict != NOT_HELD}
    return [_controlled(s, silent.get(s.said)) for s in statements if s.verdict != NOT_HELD or s.said not in told]


def _controlled(s: Statement, control: Statement | None) -> Statement:
    """Return a statement with what records say that hold no such effect, where there are any beside its own."""
    if control is None or control is s:
        return s
    return replace(s, numbers=f"{s.numbers} Of the {control.records} records, which hold none: {control.numbers}")
