"""Pieces of text that several chapters share."""

import re
from collections.abc import Iterable, Sequence

from workbench.finding import BELOW_FLOOR, CARRIES_NOTHING, SOMETHING_ELSE, Finding, capital, title
from workbench.report import numbers
from workbench.report.contents import Items
from workbench.tracing.result import Cause

ALARMS = (BELOW_FLOOR, CARRIES_NOTHING, SOMETHING_ELSE)  # kinds of findings that the first page says

UNITS = re.compile(r"\b(?:m?N|kg|[JAVms]|rad)(?:\*(?:m|s|rad)|/(?:m|s|rad|A|V|N)|\^\d)+(?![\w*/^])")
POWER = re.compile(r"(?<![\w.,+-])-?\d+(?:\.\d+)?e[+-]\d{1,2}(?![\w.]\w)")  # as Python writes a number
NEGATIVE = re.compile(r"(?<![\w.)\]^+-])-(?=\d)")
KEY = re.compile(r"^([a-z]+(?:_[a-z0-9]+)+):")


def printable(text: str) -> str:
    """Return text without control and private characters, whose numbers do not part from their per cent sign at a line's end."""
    text = re.sub(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\uf8ff\ufffe\uffff\U000f0000-\U0010ffff]", "", text)
    return re.sub(r"(?<=\d) (?=%)", "\u00a0", text)


def typeset(text: str) -> str:
    """Return a sentence with the signs that are printed: "+-0.3 N*m" is "\u00b10.3 N\u00b7m", "-4e-13" is "\u2212400 × 10⁻¹⁵"; an
    effect that it begins with by its name: "viscous_friction: ..." is "Viscous friction: ...".
    """
    text = POWER.sub(lambda m: numbers.number(float(m[0]), len(re.sub(r"e.*|\D", "", m[0]))), text)
    text = NEGATIVE.sub(numbers.MINUS, text)
    text = UNITS.sub(lambda m: numbers.unit(m[0]), text.replace("+-", "\u00b1"))
    return KEY.sub(lambda m: f"{capital(title(m[1]))}:", text)


def listed(texts: Sequence[str]) -> str:
    """Return "a, b and c"."""
    return " and ".join(p for p in (", ".join(texts[:-1]), *texts[-1:]) if p)


def named(causes: Sequence[Cause]) -> str:
    """Return "a, b and c" of causes' names; two waves of one cause are one name."""
    return listed(list(dict.fromkeys(c.title for c in causes)))


def span(low: float, high: float, unit: str) -> str:
    """Return "between 1.20 and 1.50 rad", with a prefix."""
    factor, shown = numbers.prefixed(max(abs(low), abs(high)), unit)
    for digits in (3, 4, 5, 6):  # as many as tell the two apart
        texts = [numbers.number(x * factor, digits) for x in (low, high)]
        if texts[0] != texts[1]:
            break
    return f"between {texts[0]} and {texts[1]}\u00a0{shown}"


def bound(text: str) -> str:
    """Return a bound with the signs that are printed: "<= 1e-05" is "≤ 10.0 × 10⁻⁶"."""
    text = POWER.sub(lambda m: numbers.exact(float(m[0])), text)
    return text.replace("<=", "\u2264").replace(">=", "\u2265").replace("!=", "\u2260")


def finding_items(findings: Iterable[Finding]) -> tuple[Items, ...]:
    """Return findings as a list of sentences, each with what would change it; nothing where there are none."""
    texts = [f.sentence + (f" What would change it: {f.remedy.rstrip('.')}." if f.remedy else "") for f in findings]
    return (Items(tuple(texts)),) if texts else ()
