"""Logs of several axes: which columns belong to which."""

import re
from collections.abc import Mapping

from workbench.errors import WorkbenchError, nearest
from workbench.intake.columns import Columns
from workbench.intake.names import QUALITIES, QUANTITIES, unit_of

DRIVES = ("torque", "force", "current", "voltage")
WORDS = {w for group in (QUANTITIES, QUALITIES) for line in group.values() for w in line.split()}
PATTERNS = (r"[A-Za-z]+\d*|\d+", r"[A-Za-z]+|\d+", r"\d+")  # "q7"; "7" of "q7" and "tau7"; "0" of "q[0]" and "tau_J[0]"


def of_axis(columns: Columns, axis: str, told: Mapping[str, str]) -> tuple[Columns, tuple[str, ...]]:
    """Return the columns without those of other axes, and the names of all axes.

    axis: as its user says, "" for none. An axis is a name that a drive and a position have in common ("q7" in "position.q7"
    and "effort.q7"). Raises WorkbenchError where there are several and neither `axis` nor `told` says which.
    """
    found = _axes(columns)
    mine = [a for a, names in found.items() if names & {told.get("drive"), told.get("position")}]
    wanted = _plain(axis)
    if axis:
        mine = [a for a in found if _plain(a) == wanted] or [
            a for a in found if wanted.endswith(_plain(a)) or _plain(a).endswith(wanted)
        ]
    if axis and len(mine) != 1:
        known = nearest(axis, list(found)) if found else "the columns are those of one axis, so leave it out."
        raise WorkbenchError(f"--axis {axis}: there is no such axis; {known}")
    if len(found) < 2:
        return columns, tuple(found)
    if len(mine) != 1 and not {"drive", "position"} <= set(told):
        raise WorkbenchError(
            f"{columns.path}: the columns are those of {len(found)} axes ({', '.join(found)}); say which one is meant: --axis {next(iter(found))}"
        )
    others = {n for a, names in found.items() if a not in mine for n in names} if len(mine) == 1 else set()
    return columns.only([n for n in columns.names if n not in others or n in told.values()]), tuple(found)


def elsewhere(columns: Columns, used: set[str]) -> dict[str, str]:
    """Return column -> its axis, of the axes of which no column is used."""
    return {n: a for a, names in _axes(columns).items() if not names & used for n in names}


def _axes(columns: Columns) -> dict[str, set[str]]:
    """Return axis -> its columns: names that a drive and a position share, where there are two at least; else nothing."""
    for pattern in PATTERNS:
        keys = {n: _key(columns, n, pattern) for n in columns.names}
        drives = {keys[n] for n, m in columns.meanings.items() if m.kind in DRIVES}
        places = {keys[n] for n, m in columns.meanings.items() if m.kind == "position"}
        both = [k for k in dict.fromkeys(keys.values()) if k in drives & places and k]
        if len(both) > 1:
            parts = enumerate(zip(*both, strict=False))  # "/joint_states" before every joint tells none from another
            shared = next((i for i, words in parts if len(set(words)) > 1), 0)
            return {"_".join(k[shared:] or k): {n for n in columns.names if keys[n] == k} for k in both}
    return {}


def _key(columns: Columns, name: str, pattern: str) -> tuple[str, ...]:
    """Return what of a column's name is neither a quantity nor a quality nor its unit."""
    bare = re.sub(r"[\[(][^\])\d]*[\])]", " ", name)
    spaced = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z]{2})", " ", bare)
    words = re.findall(pattern, spaced)
    unit = columns.meanings[name].unit
    if unit and len(words) > 1 and unit_of(words[-1], columns.meanings[name].kind) == unit:
        words.pop()
    return tuple(w for w in words if w.lower() not in WORDS)


def _plain(axis: str) -> str:
    return re.sub(r"[\W_]+", "", axis).lower()
