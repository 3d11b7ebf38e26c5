"""Units as they are written, checked against the dimension that a place expects, and turned into SI."""

import re
from collections.abc import Mapping

import numpy as np

from workbench.errors import WorkbenchError, nearest
from workbench.units.registry import LONGEST, NAMES, OFFSET, TOKEN, legible, registry, root, same, tidy

EXAMPLES = {
    "N*m": ("torque", "'N*m', 'mN*m' or 'lbf*in'"),
    "N": ("force", "'N', 'mN' or 'lbf'"),
    "rad": ("angle", "'rad', 'deg', 'arcsec' or 'rev'"),
    "m": ("length", "'m', 'mm' or 'um'"),
    "s": ("time", "'s' or 'ms'"),
    "Hz": ("frequency in cycles per second", "'Hz' or 'kHz' (1 Hz is 2*pi rad/s)"),
    "1/s": ("rate", "'1/s'"),
    "rad/s": ("angular velocity", "'rad/s', 'deg/s' or 'rpm'"),
    "m/s": ("velocity", "'m/s' or 'mm/s'"),
    "kg*m^2": ("moment of inertia", "'kg*m^2' or 'g*cm^2'"),
    "kg": ("mass", "'kg' or 'g'"),
    "K": ("temperature", "'degC' or 'K'"),
    "N*m*s/rad": ("rotary damping", "'N*m*s/rad'"),
    "N*m/rad": ("rotary stiffness", "'N*m/rad' or 'N*m/deg'"),
    "1": ("number without unit", "'1'"),
}
READABLE = {"F*s^2/x": ("kg*m^2", "kg")}


def to_si(value, unit: str, expected: str, where: str, *, step: bool = False):
    """Return `value` (a number or an array), given in `unit`, in the SI unit `expected`.

    where: file and key, for the sentence. step: a difference (an encoder step), so that no offset applies ("degC").
    A number becomes a float; an array keeps its shape. Raises WorkbenchError for an unknown unit, another dimension, and
    a value that is no number or too large in SI. What is not finite stays so: readers refuse it, with its row.
    """
    factor = _factor(unit, expected, where)
    try:
        given = np.asarray(value, dtype=float)
    except (TypeError, ValueError) as e:
        raise WorkbenchError(f"{where} is {value!r}; a number is needed.") from e
    with np.errstate(all="ignore"):
        if tidy(unit) in OFFSET and not step:
            si = np.asarray(registry().Quantity(given, tidy(unit)).to(expected).magnitude)
        else:
            si = given * factor
    if not np.all(np.isfinite(si) | ~np.isfinite(given)):
        raise WorkbenchError(f"{where} is too large in '{expected}'; check the value and its unit '{unit}'.")
    return si if np.ndim(value) else float(si)


def scaled(unit: str, by: str, expected: str, where: str) -> tuple[str, bool]:
    """Return (unit of the scaled value, whether it is multiplied) for a column in `unit` and a scale in `by`.

    A scale may be written either way round: a torque constant "N*m/A" multiplies a current in "A", "count/rev" divides a
    position in "count". Where both fit ("1") it multiplies. Raises WorkbenchError naming what would fit.
    """
    for multiplied, joint in ((True, "*"), (False, "/")):
        text = f"({tidy(unit)}){joint}({tidy(by)})"
        if legible(text) and _fits(text, expected):
            return text, multiplied
    of = tidy(unit)
    if not legible(of):
        _factor(unit, expected, where)  # an unknown name is answered with the nearest
    needed = f"{expected}/{of}" if of.isalpha() else f"{expected}/({of})"
    if not legible(tidy(by)):
        _factor(by, needed, where)
    raise WorkbenchError(
        f"{where}: a scale in '{by}' does not turn a column in '{unit}' into '{expected}'; '{needed}' would, or its reciprocal."
    )


def effect_unit(template: str, rotary: bool, powers: Mapping[str, float] | None = None) -> str:
    """Return the unit that a parameter's template means on this axis, as reports write it.

    F is N*m or N and x is rad or m: "F*s/x" is "N*m*s/rad" or "N*s/m". An exponent that is a name ("1/x^d") takes its
    value from `powers` and stays a name where it has none. "F*s^2/x" has readable names: "kg*m^2" or "kg".
    """
    text = tidy(template)
    for name, power in (powers or {}).items():
        text = re.sub(rf"\^{name}\b", f"^{power:g}", text)
    text = re.sub(r"\^1(?![\d.])", "", text)
    if text in READABLE:
        return READABLE[text][0 if rotary else 1]
    effort, displacement = ("N*m", "rad") if rotary else ("N", "m")
    # A divided effort needs its brackets: 1/F is 1/(N*m).
    text = re.sub(r"/F\b", f"/({effort})" if rotary else f"/{effort}", text)
    return re.sub(r"\bx\b", displacement, re.sub(r"\bF\b", effort, text))


def holds_mass(unit: str) -> bool:
    """Whether a unit that is written has a mass in it, as every torque, force and inertia has."""
    text = tidy(unit)
    return legible(text) and any("mass" in name for name, _ in root(text)[1])


def _factor(unit: str, expected: str, where: str) -> float:
    """Return SI per `unit`, after all checks; WorkbenchError says what would be right."""
    if not isinstance(unit, str):
        raise WorkbenchError(f"{where}: the unit is {unit!r}; a text is needed, such as {_examples(expected)}.")
    text, shown = tidy(unit), unit[:LONGEST]
    unknown = [t for t in TOKEN.findall(text[:LONGEST]) if t[0].isalpha() and t not in NAMES]
    if unknown or not legible(text):
        mend = _starred(text, expected)
        fault = "is unknown" if unknown else "cannot be read"
        hint = nearest(unknown[0], NAMES) if unknown else "join names by * / ^ and brackets."
        hint = f"; write '{mend}'." if mend else "." if hint.startswith("known:") else f"; {hint}"
        raise WorkbenchError(f"{where}: unit '{shown}' {fault}{hint} {_need(expected, capital=True)}")
    if text == tidy(expected):
        return 1.0  # most files are in SI, and pint need not be loaded for them
    factor, given = root(text)
    if not _fits(text, expected):
        kind = next((f"is a {n}" for u, (n, _) in EXAMPLES.items() if same(given, root(u)[1])), "does not fit")
        raise WorkbenchError(f"{where}: unit '{unit}' {_article(kind)}; {_need(expected)}")
    return factor / root(tidy(expected))[0]


def _fits(text: str, expected: str) -> bool:
    """Whether a legible unit has the expected dimension; an inertia may also be written N*m*s^2/rad."""
    given, inertia = root(text)[1], tidy(expected) == "kg*m^2"
    return same(given, root(tidy(expected))[1]) or (inertia and same(given, root("N*m*s^2/rad")[1]))


def _starred(text: str, expected: str) -> str:
    """Return `text` with its runs of letters parted by stars where that gives the expected unit ("Nms/rad"), or ""."""
    if len(text) > LONGEST:
        return ""
    raised = re.sub(r"(?<=[A-Za-z])(?=\d)", "^", re.sub(r"(?<=\w) +(?=\w)", "*", text))
    whole = [""]
    for part in re.split(r"([A-Za-z]+)", raised):
        whole = [head + run for head in whole for run in (_partings(part) if part.isalpha() else [part])][:64]
    return next((w for w in whole if legible(w) and _fits(w, expected)), "")


def _partings(run: str) -> list[str]:
    """Return every way to read a run of at most eight letters as known names joined by stars ("Nm": "N*m")."""
    if len(run) > 8:
        return []
    ways = [f"{run[:k]}*{rest}" for k in range(1, len(run)) if run[:k] in NAMES for rest in _partings(run[k:])]
    return [run, *ways] if run in NAMES else ways


def _examples(expected: str) -> str:
    return EXAMPLES[tidy(expected)][1] if tidy(expected) in EXAMPLES else f"'{expected}'"


def _need(expected: str, *, capital: bool = False) -> str:
    name = EXAMPLES[tidy(expected)][0] if tidy(expected) in EXAMPLES else ""
    need = f"{_article(f'a {name}')} is needed, such as {_examples(expected)}." if name else f"'{expected}' is needed."
    return need[0].upper() + need[1:] if capital else need


def _article(noun: str) -> str:
    return re.sub(r"\ba (?=[aeiou])", "an ", noun)
