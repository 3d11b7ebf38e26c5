"""The gains in the drive's own units: a unit's name and a factor, as the engineer states them."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from numbers import Real

from workbench.errors import WorkbenchError, nearest

GAINS = ("kp", "kd")
KEYS = ("per_si", "unit")
# The name goes into a C comment and a C string: plain ASCII, and nothing that ends either.
UNIT = re.compile(r"(?!.*(?:\*/|/\*|//))[A-Za-z0-9%_.^()*/ +-]{1,40}")


@dataclass(frozen=True)
class Scale:
    """One gain in the drive's unit: value = per_si * (value in SI)."""

    unit: str
    per_si: float


def scales(table: Mapping | None, where: str = "scale") -> dict[str, Scale] | None:
    """Return {"kp": Scale, "kd": Scale} of a table {kp = {unit, per_si}, kd = {unit, per_si}}, or None of None.

    per_si: drive units per SI unit (N*m/rad, N*m*s/rad; N/m, N*s/m), finite and above zero. Raises WorkbenchError, naming
    the key, for anything missing, unknown or out of range.
    """
    if table is None:
        return None
    _known(table, GAINS, where)
    return {name: _one(table[name], f"{where}.{name}") for name in GAINS}


def _one(entry, where: str) -> Scale:
    """Return the Scale of one table {unit, per_si}."""
    _known(entry, KEYS, where)
    unit, factor = entry["unit"], entry["per_si"]
    if not isinstance(unit, str) or not UNIT.fullmatch(unit):
        raise WorkbenchError(f"{where}.unit is {unit!r}; write up to 40 plain characters, such as 'A/count'.")
    if not isinstance(factor, Real) or isinstance(factor, bool) or not isfinite(factor) or factor <= 0.0:
        raise WorkbenchError(
            f"{where}.per_si is {factor!r}; a finite number above zero is needed: how many {unit} one SI unit is."
        )
    return Scale(unit, float(factor))


def _known(table, keys: tuple[str, ...], where: str) -> None:
    """Raise WorkbenchError unless `table` is a table with exactly these keys."""
    if not isinstance(table, Mapping):
        raise WorkbenchError(f"{where} is {table!r}; a table with {' and '.join(keys)} is needed.")
    for key in table:
        if key not in keys:
            raise WorkbenchError(f"{where}.{key} is unknown; {nearest(str(key), keys)}")
    for key in keys:
        if key not in table:
            raise WorkbenchError(f"{where}.{key} is missing; {where} needs {' and '.join(keys)}.")
