"""The records of a campaign: declared channels and files become frozen records in SI, with what was done to them."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError
from workbench.finding import Finding
from workbench.readers import load, reader
from workbench.readers.declaration import Table
from workbench.readers.sampling import uniform
from workbench.readers.stated import stated
from workbench.record import IDENTIFICATION, ROLES, VALIDATION, Record
from workbench.units import effect_unit, to_si

# Templates as effects state them: F is N*m or N, x is rad or m.
CHANNELS = {
    "time": "s",
    "torque": "N*m",
    "force": "N",
    "position": "x",
    "load_position": "x",
    "reference": "x",
    "injected": "F",
    "velocity": "x/s",
    "temperature": "K",
    "normal": "N",
}


@dataclass(frozen=True)
class Channel:
    """column: its name in the files. unit: as measured. si: inside. resolution: encoder step in SI, or 0."""

    column: str
    unit: str
    si: str
    resolution: float


def channels(top: Table, two_mass: bool, notes: dict[str, str]) -> dict[str, Channel]:
    """Return the declared channels by name: time, position, load_position on two masses, and one of torque and force.

    Which of the two it is says whether the axis turns. `notes` takes each channel's meaning.
    """
    table = top.table("channels", optional=tuple(CHANNELS))
    drive = [name for name in ("torque", "force") if name in table]
    if len(drive) != 1:
        fault = (
            "both 'torque' and 'force' are declared; keep" if drive else "neither 'torque' nor 'force' is declared; add"
        )
        raise WorkbenchError(f"{table.where}: {fault} the one that the drive reports.")
    for name in ("time", "position", *(["load_position"] if two_mass else [])):
        if name not in table:
            raise WorkbenchError(f"{table.where}: channel '{name}' is missing; the plant needs it, so add it.")
    channels = {}
    for name in table.values:
        one = table.table(name, ("column", "unit"), ("meaning", "resolution"))
        column, unit, si = one.text("column"), one.text("unit"), effect_unit(CHANNELS[name], "torque" in table)
        to_si(0.0, unit, si, one.path("unit"))
        step = one.number("resolution", 0.0, above=0.0) if "resolution" in one else 0.0
        step = to_si(step, unit, si, one.path("resolution"), step=True)
        for other, seen in channels.items():
            if seen.column == column:
                raise WorkbenchError(
                    f"{one.path('column')}: column '{column}' is channel '{other}' already; name another column."
                )
        channels[name] = Channel(column, unit, si, step)
        notes[f"channels.{name}.meaning"] = one.text("meaning")
    return channels


def records(
    top: Table, folder: Path, channels: Mapping[str, Channel], resample: bool
) -> tuple[tuple[Record, ...], tuple[Finding, ...]]:
    """Return the records in SI, at least one of each role, and the findings about them."""
    declared = list(top.tables("records", "file", ("file", "role"), ("motion", "start_time_s", "load_locked")))
    names: dict[str, str] = {}
    for one in declared:
        one.choice("role", ROLES, "role")
        path = _inside(folder, one)
        name = path.name.split(".")[0]
        if name in names:
            raise WorkbenchError(
                f"{one.path('file')}: '{one.text('file')}' and '{names[name]}' are both record '{name}'; rename one."
            )
        names[name] = one.text("file")
    for role in (IDENTIFICATION, VALIDATION):
        if not any(one.text("role") == role for one in declared):
            raise WorkbenchError(f"{top.path('records')}: no record has role '{role}'; add one, or change a role.")
    pairs = [_record(one, folder, name, channels, resample) for name, one in zip(names, declared, strict=True)]
    return tuple(r for r, _ in pairs), tuple(f for _, found in pairs for f in found)


def _record(one: Table, folder: Path, name: str, channels: Mapping[str, Channel], resample: bool):
    path = _inside(folder, one)
    sheet, source = load(path, {n: c.column for n, c in channels.items()})
    data = {n: to_si(sheet.channels[n], c.unit, c.si, f"{path}: column '{c.column}'") for n, c in channels.items()}
    time, data, resampled = uniform(name, data.pop("time"), data, sheet.place, resample=resample)
    findings = [f for n, c in channels.items() if (f := stated(name, c.column, sheet.units.get(n, ""), c.unit, c.si))]
    findings += [resampled] if resampled else []
    start = one.number("start_time_s", float(time[0]))
    if abs(start - time[0]) > time[1] - time[0]:
        findings.append(_clock(name, start, time))
    record = Record(
        name=name,
        role=one.text("role"),
        time=time,
        channels=data,
        units={n: c.si for n, c in channels.items()},
        source=source,
        resolution={n: c.resolution for n, c in channels.items() if c.resolution},
        motion=one.text("motion"),
        locked=one.flag("load_locked"),
    )
    return record, findings


def _clock(name: str, start: float, time: np.ndarray) -> Finding:
    sentence = f"Record '{name}' is declared to start at {start:g} s, and its time starts at {time[0]:g} s; the latter is used."
    evidence = {"declared": start, "measured": float(time[0])}
    return Finding("start time", name, sentence, evidence, "Log the clock of the bench, or mend start_time_s.")


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
