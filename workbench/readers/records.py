"""The records of a campaign: declared channels and files become frozen records in SI, with what was done to them."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError
from workbench.finding import Finding
from workbench.readers import load, reader, stem, wording
from workbench.readers.declaration import Table
from workbench.readers.own_unit import OWN
from workbench.readers.plausible import HUGE, plausible
from workbench.readers.sampling import FEWEST, uniform
from workbench.readers.stated import stated
from workbench.record import IDENTIFICATION, ROLES, VALIDATION, Payload, Record
from workbench.units import effect_unit, scaled, to_si
from workbench.units.registry import tidy

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
LOGGED = (*(name for row in OWN for name in row), "percent", "permille", "count")  # what drives log that is no torque
NAME = re.compile(r"[\w-]+")


@dataclass(frozen=True)
class Channel:
    """column: its name in the files. unit: as measured. si: inside. resolution: encoder step in SI, or 0.

    scaled: the unit that the column times `factor` has, from which it is converted; `unit` and 1 where no scale is
    declared. assumed: the scale is a guess that waits for its engineer. rate: Hz, of a time that counts samples and has no
    column.
    """

    column: str
    unit: str
    si: str
    resolution: float
    scaled: str
    factor: float = 1.0
    assumed: bool = False
    rate: float = 0.0

    def to_si(self, values, where: str, *, step: bool = False):
        """Return values of the column in SI. step: a difference, such as the encoder's."""
        with np.errstate(over="ignore"):
            product = self.factor * values
        if not np.all(np.isfinite(product)):
            raise WorkbenchError(
                f"{where} is too large when it is multiplied by its scale; check the samples and the scale."
            )
        return to_si(product, self.scaled, self.si, where, step=step)


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
        if name == "time" and isinstance(table.values[name], dict) and "rate" in table.values[name]:
            one = table.table(name, ("rate",), ("meaning",))
            channels[name] = Channel("", "s", "s", 0.0, "s", rate=one.quantity("rate", "Hz", above=0.0))
            notes["channels.time.meaning"] = one.text("meaning")
            continue
        one = table.table(name, ("column", "unit"), ("meaning", "resolution", "scale"))
        channel = _channel(one, effect_unit(CHANNELS[name], "torque" in table))
        for other, seen in channels.items():
            if seen.column == channel.column:
                raise WorkbenchError(
                    f"{one.path('column')}: column '{channel.column}' is channel '{other}' already; name another column."
                )
        channels[name] = channel
        notes[f"channels.{name}.meaning"] = one.text("meaning")
    return channels


def _channel(one: Table, si: str) -> Channel:
    """Return one declared channel; its scale is a quantity in either direction ("N*m/A", "count/rev")."""
    column, unit = one.text("column"), one.text("unit")
    factor, text, assumed = 1.0, unit, False
    if "scale" in one:
        scale = one.table("scale", ("value", "unit"), ("assumed",))
        text, multiplied = scaled(unit, scale.text("unit"), si, scale.path("unit"))
        value, assumed = scale.number("value"), scale.flag("assumed")
        if value == 0.0:
            raise WorkbenchError(f"{scale.path('value')} is 0; a scale turns counts or amperes into '{si}'.")
        factor = value if multiplied else 1.0 / value
    if "scale" not in one and si in ("N*m", "N") and tidy(unit) in LOGGED:
        said = f"{one.path('unit')}: '{unit}' is no {'torque' if si == 'N*m' else 'force'}; give the constant that makes it one, "
        mend = f'scale = {{ value = ..., unit = "{si}/{unit}" }}'
        whole = f", or write all parameters in it, an inertia in '{unit}*s^2/{'rad' if si == 'N*m' else 'm'}'"
        raise WorkbenchError(f"{said}{mend}{whole if any(tidy(unit) in row for row in OWN) else ''}.")
    to_si(0.0, text, si, one.path("unit"))
    step = one.number("resolution", 0.0, above=0.0) if "resolution" in one else 0.0
    channel = Channel(column, unit, si, 0.0, text, factor, assumed)
    return replace(channel, resolution=abs(channel.to_si(step, one.path("resolution"), step=True)))


def assumptions(channels: Mapping[str, Channel]) -> tuple[Finding, ...]:
    """Say which scales are guesses."""
    return tuple(wording.assumed_scale(n, c.column, c.unit, c.si, c.factor) for n, c in channels.items() if c.assumed)


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
    opened = cache(lambda path: load(path, {n: c.column for n, c in channels.items() if not c.rate}))
    pairs = [_record(one, folder, name, channels, resample, opened) for name, one in zip(names, declared, strict=True)]
    return tuple(r for r, _ in pairs), tuple(f for _, found in pairs for f in found)


def _record(one: Table, folder: Path, name: str, channels: Mapping[str, Channel], resample: bool, opened):
    path = _inside(folder, one)
    measured = {n: c for n, c in channels.items() if not c.rate}
    sheet, source = opened(path)  # two records may be of one file
    seen = {n: np.clip(sheet.channels[n], -HUGE, HUGE) for n in measured}  # `plausible` says which sample is beyond
    data = {n: c.to_si(seen[n], f"{path}: column '{c.column}'") for n, c in measured.items()}
    if rate := channels["time"].rate:
        data["time"] = np.arange(next(iter(data.values())).size) / rate
    time, data, first = _window(one, data.pop("time"), data)
    for n in data:
        plausible(name, n, channels[n], data[n], sheet, first)
    time, data, resampled = uniform(name, time, data, lambda k: sheet.place(k + first), resample=resample)
    start = one.number("start_time_s", float(time[0]))
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
        counts_from=_counted(one, time),
        payload=_payload(one, "torque" in channels),
    )
    findings = [f for n, c in measured.items() if (f := stated(name, c.column, sheet.units.get(n, ""), c.unit))]
    findings += [resampled] if resampled else []
    findings += [wording.noted(name, note) for note in sheet.notes]
    findings += [wording.other_clock(name, start, float(time[0]))] if abs(start - time[0]) > time[1] - time[0] else []
    return record, findings


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
    first = one.quantity("counts_from", "s") if "counts_from" in one else -np.inf
    left = int(np.count_nonzero(time >= first))
    if left < FEWEST:
        raise WorkbenchError(
            f"{one.path('counts_from')} leaves {left} samples that count; at least {FEWEST} are needed."
        )
    return first


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
