"""The records of a campaign: declared channels and files become frozen records in SI, with what was done to them."""

import re
from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError
from workbench.finding import Finding
from workbench.readers import load, reader, stem, wording
from workbench.readers.channels import Channel
from workbench.readers.declaration import Table
from workbench.readers.plausible import HUGE, plausible
from workbench.readers.sampling import FEWEST, gaps, stretches, uniform
from workbench.readers.stated import stated
from workbench.record import IDENTIFICATION, ROLES, VALIDATION, Payload, Record
from workbench.units import effect_unit

NAME = re.compile(r"[\w-]+")
SAME = 0.01  # of a record's length, within which it starts when it is declared to: nothing drifts in that, and stamps jitter
SPARED = (
    "reference",
)  # channels that some of the records may lack: an output that is clamped, or a torque that is injected, follows none


def records(
    top: Table, folder: Path, channels: Mapping[str, Channel], resample: bool
) -> tuple[tuple[Record, ...], tuple[Finding, ...]]:
    """Return the records in SI, at least one of each role, and the findings about them."""
    further = ("motion", "start_time_s", "load_locked", "name", "from", "until", "counts_from", "payload")
    declared = list(top.tables("records", "file", ("file", "role"), further))
    names: dict[str, str] = {}
    for one in declared:
        one.choice("role", ROLES, "role")
        path = _inside(folder, one)
        name = one.text("name") or stem(path)
        if "name" in one and not NAME.fullmatch(name):
            raise WorkbenchError(f"{one.path('name')} is '{name}'; letters, digits, '_' and '-' make a record's name.")
        if name in names:
            raise WorkbenchError(
                f"{one.path('file')}: '{one.text('file')}' and '{names[name]}' are both record '{name}'; rename one, or give it a key 'name'."
            )
        names[name] = one.text("file")
    for role in (IDENTIFICATION, VALIDATION):
        if not any(one.text("role") == role for one in declared):
            raise WorkbenchError(f"{top.path('records')}: no record has role '{role}'; add one, or change a role.")
    columns = {n: c.column for n, c in channels.items() if not c.rate}
    opened = cache(lambda path: load(path, columns, SPARED))
    made: list[Record] = []
    findings: list[Finding] = []
    for name, one in zip(names, declared, strict=True):
        of_one, found = _records(one, folder, name, channels, resample, opened, names)
        made, findings = [*made, *of_one], [*findings, *found]
    if any(n in columns and all(n not in r.channels for r in made) for n in SPARED):
        load(_inside(folder, declared[0]), columns)  # a name that no file has is a wrong one, and this says so
    return tuple(made), tuple(findings)


def _records(one: Table, folder: Path, name: str, channels: Mapping[str, Channel], resample: bool, opened, names):
    """Return the record that an entry declares, or those between its gaps where they may be resampled, and the findings about them."""
    path = _inside(folder, one)
    sheet, source = opened(path)  # two records may be of one file
    measured = {n: c for n, c in channels.items() if n in source.columns}
    seen = {n: np.clip(sheet.channels[n], -HUGE, HUGE) for n in measured}  # `plausible` says which sample is beyond
    data = {n: c.to_si(seen[n], f"{path}: column '{c.column}'") for n, c in measured.items()}
    if rate := channels["time"].rate:
        data["time"] = np.arange(next(iter(data.values())).size) / rate
    time, data, first = _window(one, data.pop("time"), data)
    for n in data:
        plausible(name, n, channels[n], data[n], sheet, first)
    parts = _parts(one, time) if resample else [slice(0, time.size)]
    called = _called(name, len(parts), names)
    even = [
        uniform(
            n, time[p], {c: x[p] for c, x in data.items()}, lambda k, at=first + p.start: sheet.place(k + at), resample=resample
        )
        for n, p in zip(called, parts, strict=True)
    ]  # fmt: skip
    begun = float(time[0] if parts[0].start else even[0][0][0])
    start, step, counted = one.number("start_time_s", begun), float(even[0][0][1] - even[0][0][0]), _counted(one, time)
    later = start if abs(begun) <= step < start else 0.0  # its own clock begins with the record: the bench's is told
    whole = Record(
        name=name,
        role=one.text("role"),
        time=time,
        channels=data,
        units={n: c.si for n, c in channels.items() if n in data or n == "time"},
        source=source,
        resolution={n: c.resolution for n, c in channels.items() if c.resolution and n in data},
        motion=one.text("motion"),
        locked=one.flag("load_locked"),
        counts_from=counted + later,
        payload=_payload(one, "torque" in channels),
    )
    made = [
        # what lay before a gap is known, what lay in it is not
        replace(
            whole,
            name=n,
            time=t + later if later else t,
            channels=x,
            history=None if p.start else whole.history,
            unseen=tuple((a + later, b + later) for a, b in gaps(time[p])) if said else (),
        )
        for n, p, (t, x, said) in zip(called, parts, even, strict=True)
    ]  # fmt: skip
    findings = [f for n, c in measured.items() if (f := stated(name, c.column, sheet.units.get(n, ""), c.unit))]
    if (left_out := time.size - sum(p.stop - p.start for p in parts)) or len(parts) > 1:
        steps = np.diff(time)
        findings += [wording.cut(name, called, left_out, float(steps.max()), float(np.median(steps)))]
    findings += [resampled for *_, resampled in even if resampled]
    findings += [wording.noted(n, note) for note in sheet.notes for n in called]
    findings += [wording.without(name, n, c.column) for n, c in channels.items() if n in SPARED and n not in data]
    findings += [wording.own_clock(name, later)] if later else []
    apart = max(step, SAME * float(time[-1] - begun))
    findings += [wording.other_clock(name, start, begun)] if not later and abs(start - begun) > apart else []
    return made, findings


def _parts(one: Table, time: np.ndarray) -> list[slice]:
    """Return the samples of the records that an entry is: all of them, or those between gaps of which enough count."""
    worth = [p for p in stretches(time) if np.count_nonzero(time[p] >= _counts_from(one)) >= FEWEST]
    return worth or [slice(0, time.size)]


def _called(name: str, parts: int, names: Collection[str]) -> list[str]:
    """Return the names of what a record is cut into: its own where it is one, else numbered, and none that another one has."""
    if parts < 2:
        return [name]
    while any(f"{name}_{k + 1}" in names for k in range(parts)):
        name += "_"
    return [f"{name}_{k + 1}" for k in range(parts)]


def _window(one: Table, time: np.ndarray, data: Mapping[str, np.ndarray]):
    """Return (time, channels, number of the first sample) of what the keys 'from' and 'until' leave of a file.

    They cut a file into records, or a gap out of it, before anything is asked of its time axis.
    """
    if "from" not in one and "until" not in one:
        return time, data, 0
    low = one.quantity("from", "s") if "from" in one else -np.inf
    high = one.quantity("until", "s") if "until" in one else np.inf
    inside = np.flatnonzero((time >= low) & (time < high))
    if inside.size < FEWEST:
        key = "from" if "from" in one else "until"
        raise WorkbenchError(f"{one.path(key)} leaves {inside.size} samples; at least {FEWEST} are needed.")
    return time[inside], {n: values[inside] for n, values in data.items()}, int(inside[0])


def _counted(one: Table, time: np.ndarray) -> float:
    """Return the time from which errors count: what lies before it brings operators with memory into their state."""
    first = _counts_from(one)
    left = int(np.count_nonzero(time >= first))
    if left < FEWEST:
        raise WorkbenchError(
            f"{one.path('counts_from')} leaves {left} samples that count; at least {FEWEST} are needed."
        )
    return first


def _counts_from(one: Table) -> float:
    return one.quantity("counts_from", "s") if "counts_from" in one else -np.inf


def _payload(one: Table, rotary: bool) -> Payload | None:
    """Return what was added to the axis for a record; on a linear axis a mass alone, whose weight is a constant offset."""
    if "payload" not in one:
        return None
    units = {"inertia": "F*s^2/x"} | ({"mgl": "F", "phase": "x"} if rotary else {})
    given = one.table("payload", (), tuple(units))
    return Payload(**{n: given.quantity(n, effect_unit(units[n], rotary)) for n in given.values})


def _inside(folder: Path, one: Table) -> Path:
    """Return the path of a record's file, which lies in the folder, links followed."""
    file = one.text("file")
    path = folder / file
    try:
        inside = bool(file) and ".." not in Path(file).parts and path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError):  # a link to itself, a name too long, a NUL
        inside = False
    if not inside or Path(file).is_absolute():
        raise WorkbenchError(f"{one.path('file')}: '{file}' is no path in the folder; copy the record into it.")
    reader(path)
    if path.name.startswith("."):
        raise WorkbenchError(f"{one.path('file')}: '{file}' has no name before its suffix; rename the file.")
    return path
