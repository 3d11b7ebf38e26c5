"""Pieces of text that several chapters share."""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence

from workbench.finding import BELOW_FLOOR, CARRIES_NOTHING, SOMETHING_ELSE, Finding, capital, title
from workbench.identification.findings import DISAGREE
from workbench.identification.result import Estimate, Fit
from workbench.report import numbers
from workbench.report.contents import BAD, CODE, QUIET, Items, Marked, Table

ALARMS = (BELOW_FLOOR, CARRIES_NOTHING, SOMETHING_ELSE)  # kinds of findings that the first page says

UNITS = re.compile(r"\b(?:m?N|kg|[JAVms]|rad)(?:\*(?:m|s|rad)|/(?:m|s|rad|A|V|N)|\^\d)+(?![\w*/^])")
POWER = re.compile(r"(?<![\w.,+-])-?\d+(?:\.\d+)?e[+-]\d{1,2}(?![\w.]\w)")  # as Python writes a number
NEGATIVE = re.compile(r"(?<![\w.)\]^+-])-(?=\d)")
KEY = re.compile(r"^([a-z]+(?:_[a-z0-9]+)+):")

Spread = Mapping[str, tuple[float, float]]


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


def said(findings: Iterable[Finding]) -> tuple[Items, ...]:
    """Return findings as a list of sentences, each with what would change it; nothing where there are none."""
    texts = [f.sentence + (f" What would change it: {f.remedy.rstrip('.')}." if f.remedy else "") for f in findings]
    return (Items(tuple(texts)),) if texts else ()


def _of_effects(estimates: Sequence[Estimate]) -> str:
    """Return whether the place must be told: only where an effect or a place differs."""
    return "at" if len({e.at for e in estimates}) > 1 else ""


def _interval(e: Estimate) -> tuple[str, str | Marked]:
    """Return (value, 95 % interval) of an estimate as cells."""
    value, wide = numbers.with_interval(e.value, e.low, e.high)
    if e.fixed:
        return value, Marked("fixed", QUIET)
    if not wide:
        return value, Marked("none: on its bound", BAD)
    undetermined = not e.low * e.high > 0
    return value, Marked(f"{wide}, not determined", BAD) if undetermined else wide


def _by_record(e: Estimate, spread: Spread, differ: Collection[str]) -> str | Marked:
    """Return what the records say of a parameter one at a time, as a cell; marked where they disagree."""
    name = f"{e.effect}@{e.at}.{e.parameter}"
    if name not in spread:
        return Marked("\u2013", QUIET)
    low, high = spread[name]
    text = numbers.with_interval((low + high) / 2, low, high)[1] or numbers.number(low)
    return Marked(text, BAD) if name in differ else text


def parameters(
    estimates: Sequence[Estimate], caption: str, before: Sequence[Estimate] = (), *, fit: Fit | None = None
) -> Table:
    """Return a table of parameters with their intervals.

    before: what the declared model found, beside. fit: whose records say something of a parameter one at a time, beside.
    """
    earlier = {(e.effect, e.at, e.parameter): _interval(e)[0] for e in before}
    spread = fit.spread if fit is not None else {}
    differ = {f.subject for f in fit.findings if f.kind == DISAGREE} if fit is not None else set()
    rows, last = [], None
    for e in estimates:
        here = (e.effect, e.at)
        name = f"{title(e.effect)} ({e.at})" if _of_effects(estimates) else title(e.effect)
        value, wide = _interval(e)
        was = (earlier.get((*here, e.parameter), Marked("\u2013", QUIET)),) if before else ()
        each = (_by_record(e, spread, differ),) if spread else ()
        first = name if here != last else ""
        rows.append(
            (
                first,
                Marked(e.parameter, CODE),
                *(() if before else (e.meaning,)),
                *was,
                value,
                wide,
                *each,
                numbers.unit(e.unit),
            )
        )
        last = here
    was, each = ("declared",) if before else (), ("by record",) if spread else ()
    now = "extended" if before else "value"
    meaning = () if before else ("meaning",)  # what was said of them already
    columns = ("effect", "parameter", *meaning, *was, now, "95 % interval", *each, "unit")
    return Table(
        columns, tuple(rows), caption, ("pl" if before else "llp") + "r" * len(was) + "rr" + "r" * len(each) + "l"
    )
