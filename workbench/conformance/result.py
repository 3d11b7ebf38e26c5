"""What a check says."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Result:
    """effect, property: what was checked. passed; sentence: what was found, with its numbers."""

    effect: str
    property: str
    passed: bool
    sentence: str


def within(found: float, bound: float, what: str) -> tuple[bool, str]:
    """Return (passed, sentence) of a number that must not be larger than a bound."""
    passed = bool(found <= bound)  # NaN does not pass
    return passed, f"{what} {found:.2g}, {'within' if passed else 'which is more than'} {bound:.2g}."
