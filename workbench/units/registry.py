"""The units that are known, by pint, and how a unit string is read.

The registry holds the units below and no others, written in full with their prefixes: with free prefixes and plurals,
"Nm", "Ms" or "Ns" would find a meaning that nobody meant. The angle and the cycle are dimensions of their own.
"""

import re
from functools import cache
from math import pi

BASE = {"m": "length", "kg": "mass", "s": "time", "rad": "angle", "K": "temperature", "cycle": "cycle"}
BASE |= {"A": "current", "count": "count"}  # what drives log: to be scaled by a torque constant, by counts a revolution
DERIVED = {
    "m": {"km": 1e3, "dm": 0.1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "pm": 1e-12}
    | {"in": 0.0254, "ft": 0.3048, "mil": 2.54e-5},
    "kg": {"g": 1e-3, "mg": 1e-6, "t": 1e3, "lb": 0.45359237},
    "s": {"ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0},
    "rad": {"mrad": 1e-3, "urad": 1e-6, "nrad": 1e-9, "deg": pi / 180, "arcmin": pi / 10800, "arcsec": pi / 648000}
    | {"mdeg": pi / 180000, "rev": 2 * pi, "turn": 2 * pi, "gon": pi / 200},
    "rad/s": {"rpm": pi / 30},
    "cycle/s": {"Hz": 1.0, "mHz": 1e-3, "kHz": 1e3, "MHz": 1e6},
    "kg*m/s**2": {"N": 1.0, "mN": 1e-3, "uN": 1e-6, "kN": 1e3}
    | {"lbf": 4.4482216152605, "ozf": 0.27801385095378125, "kgf": 9.80665, "gf": 9.80665e-3},
    "K": {"mK": 1e-3},
    "A": {"mA": 1e-3},
    "kg*m**2/(s**3*A)": {"V": 1.0, "mV": 1e-3},
    "": {"percent": 1e-2, "permille": 1e-3},
}
OFFSET = {"degC": "K; offset: 273.15", "degF": f"{5 / 9!r} * K; offset: {459.67 * 5 / 9!r}"}
NAMES = (*(n for n in BASE if n != "cycle"), *(n for group in DERIVED.values() for n in group), *OFFSET)

TOKEN = re.compile(r"[A-Za-z]+|[0-9]+\.?[0-9]*|[*/()]|\^-?")
LONGEST = 60  # characters; nothing in use is half as long


def tidy(unit: str) -> str:
    """Return a unit string in the one spelling used inside: "^" and "*", no blanks about operators, "1" for no unit."""
    for old, new in (("**", "^"), ("·", "*"), ("⋅", "*"), ("²", "^2"), ("³", "^3"), ("µ", "u"), ("μ", "u")):
        unit = unit.replace(old, new)
    for old, new in (("°C", "degC"), ("°F", "degF"), ("°", "deg"), ("%", "percent")):
        unit = unit.replace(old, new)
    unit = re.sub(r"\s*([*/^()])\s*", r"\1", unit.strip())
    return "1" if unit in ("", "-") else unit


@cache
def registry():
    """Return the pint registry of exactly these units, made once."""
    import pint  # 0.4 s: only when a unit is read

    units = pint.UnitRegistry(None)
    for name, dimension in BASE.items():
        units.define(f"{name} = [{dimension}]")
    for base, group in DERIVED.items():
        for name, factor in group.items():
            units.define(f"{name} = {factor!r} * {base}" if base else f"{name} = {factor!r}")
    for name, definition in OFFSET.items():
        units.define(f"{name} = {definition}")
    return units


@cache
def root(text: str) -> tuple[float, tuple[tuple[str, float], ...]]:
    """Return the factor to base units and the sorted (dimension, exponent) of a legible unit string."""
    units = registry()
    parsed = units.parse_units(text.replace("^", "**"))
    exponents = ((name, float(power)) for name, power in units.get_dimensionality(parsed).items())
    return float(units.get_root_units(parsed)[0]), tuple(sorted((n, p) for n, p in exponents if p))


def legible(text: str) -> bool:
    """Whether `text` is built from known names with * / ^ and brackets; pint is shown nothing else.

    Powers stand at names only, above 0 and up to 9: nothing to overflow, no tower to climb, and no name that goes.
    """
    tokens = TOKEN.findall(text) if len(text) <= LONGEST else []
    previous, depth = "*", 0
    for t in tokens:
        after = previous[0].isalnum() or previous == ")"
        if previous[0] == "^":
            fits = t[0].isdigit() and 0 < float(t) <= 9
        elif t[0].isdigit():
            fits = t == "1" and not after
        elif t[0].isalpha():
            fits = t in NAMES and not after
        else:
            fits = previous[0].isalpha() if t[0] == "^" else (t != "(") == after
        depth += (t == "(") - (t == ")")
        if not fits or depth < 0:
            return False
        previous = t
    return "".join(tokens) == text and depth == 0 and (previous[0].isalnum() or previous == ")")


def same(a, b) -> bool:
    """Equal exponents, to five digits: a fractional power is written with as many as one cares for."""
    return [n for n, _ in a] == [n for n, _ in b] and all(
        abs(p - q) <= 1e-5 for (_, p), (_, q) in zip(a, b, strict=True)
    )
