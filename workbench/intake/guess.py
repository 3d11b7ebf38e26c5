"""Which column is which channel: by its name and unit where these say so, else by the data."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.errors import WorkbenchError, nearest
from workbench.intake import signals
from workbench.intake.names import Meaning, is_length, kind_of, meaning
from workbench.readers import Survey

DRIVES = ("torque", "force", "current", "voltage")  # the likelier first
EXPLAINED = 0.3  # share of a drive's power that motion must explain for nameless columns to be taken for a pair
SMOOTH = 0.999  # correlation above which a column is another reading of the position, or of its velocity


@dataclass(frozen=True)
class Guess:
    """One channel. channel: of the campaign format. column, unit: in the files. why: a clause."""

    channel: str
    column: str
    unit: str
    why: str
    kind: str = ""


@dataclass(frozen=True)
class Columns:
    """What is common to all files. data: of each file, name -> (n,). meanings: name -> what the name says."""

    surveys: tuple[Survey, ...]
    meanings: Mapping[str, Meaning]

    @property
    def names(self) -> list[str]:
        return list(self.meanings)

    def of(self, name: str) -> list[np.ndarray]:
        return [s.columns[name] for s in self.surveys]

    def moves(self, name: str) -> bool:
        return any(np.ptp(x) > 0 for x in self.of(name))


def common(surveys: Sequence[Survey]) -> Columns:
    """Return the columns that every file has; WorkbenchError where there are fewer than three."""
    first = surveys[0]
    names = [n for n in first.columns if all(n in s.columns for s in surveys)]
    if len(names) < 3:
        raise WorkbenchError(
            f"{first.path}: {len(names)} columns of numbers are common to all records ({', '.join(names) or 'none'}); time, "
            "drive (torque, force or current) and position are needed in each, under the same names."
        )
    return Columns(tuple(surveys), {n: meaning(n, first.units.get(n, "")) for n in names})


def channels(columns: Columns, told: Mapping[str, str]) -> tuple[Guess, ...]:
    """Return the guesses for time, drive, position and whatever else is there, in this order.

    told: channel -> column, as its user says. Raises WorkbenchError where one of the first three cannot be found.
    """
    for channel, column in told.items():
        if column not in columns.names:
            raise WorkbenchError(
                f"--channel {channel}={column}: there is no such column; {nearest(column, columns.names)}"
            )
    time = _time(columns, told)
    rest = [n for n in columns.names if n != time.column and n not in told.values() and columns.moves(n)]
    drive, position = _pair(columns, rest, told, time)
    if kind_of(drive.unit) not in ("torque", "force") and is_length(position.unit):
        drive = replace(drive, channel="force")
    taken = {time.column, drive.column, position.column}
    others = _others(columns, [n for n in rest if n not in taken], told, position)
    position, others = _not_the_reference(columns, position, others, time)
    return (time, drive, position, *others)


def _time(columns: Columns, told: Mapping[str, str]) -> Guess:
    named = [n for n, m in columns.meanings.items() if m.kind == "time"]
    clocks = [n for n in columns.names if all(signals.is_clock(x) for x in columns.of(n))]
    found = told.get("time") or next((n for n in named if n in clocks), None) or next(iter(clocks), None)
    if found is None:
        raise WorkbenchError(
            f"{columns.surveys[0].path}: no column increases evenly as time does ({', '.join(columns.names)}); log the "
            "time, or say which column it is: --channel time=COLUMN."
        )
    unit, rate = signals.clock_unit(columns.of(found)[0])
    why = "you say so" if "time" in told else "its name says so" if found in named else "it increases evenly"
    if columns.meanings[found].unit in signals.CLOCKS:
        unit = columns.meanings[found].unit
        rate = 1.0 / (float(np.median(np.diff(columns.of(found)[0]))) * signals.CLOCKS[unit])
        return Guess("time", found, unit, f"{why}, and its unit; that makes {rate:.6g} Hz", "time")
    return Guess("time", found, unit, f"{why}; in {unit} its steps make {rate:.6g} Hz, as drives log", "time")


def _pair(columns: Columns, rest: Sequence[str], told: Mapping[str, str], time: Guess) -> tuple[Guess, Guess]:
    """Return drive and position: by name, else the pair of columns in which motion explains the drive best."""
    drives = [told["drive"]] if "drive" in told else _likeliest(columns, rest, DRIVES)
    positions = [told["position"]] if "position" in told else _likeliest(columns, rest, ("position",))[:1]
    open_ = [n for n in rest if columns.meanings[n].kind == "" and "error" not in columns.meanings[n].quality]
    by_name = {"drive": bool(drives), "position": bool(positions)}
    drives, positions = drives or open_, positions or open_
    best, score = None, -np.inf
    for d in drives:
        for p in positions:
            if d != p:
                explained = _explained(columns, d, p, time) if len(drives) * len(positions) > 1 else 1.0
                best, score = ((d, p), explained) if explained > score else (best, score)
    if best is None or (score < EXPLAINED and not all(by_name.values())):
        raise WorkbenchError(
            f"{columns.surveys[0].path}: which column is the drive's torque, force or current and which the position cannot "
            f"be told from the names or the data ({', '.join(rest) or 'none is left'}); say --channel drive=COLUMN "
            "--channel position=COLUMN."
        )
    reasons = {
        part: "you say so" if part in told
        else "its name says so" if named
        else f"motion explains {100 * score:.0f} % of one column by the other, the best of all pairs"
        for part, named in by_name.items()
    }  # fmt: skip
    return _drive(columns, best[0], reasons["drive"]), _position(columns, best[1], reasons["position"])


def _likeliest(columns: Columns, names: Sequence[str], kinds: Sequence[str]) -> list[str]:
    """Return the columns of these quantities that come first: measured before set values, and no errors or loads."""

    def rank(n: str):
        m = columns.meanings[n]
        return ("reference" in m.quality, "measured" not in m.quality, kinds.index(m.kind))

    fit = [n for n in names if columns.meanings[n].kind in kinds]
    fit = [n for n in fit if not {"error", "load"} & columns.meanings[n].quality]
    return [n for n in fit if rank(n) == min(map(rank, fit))]


def _explained(columns: Columns, drive: str, position: str, time: Guess) -> float:
    """Return the share of the drive that motion explains, the best of all files; less where a position is rough."""
    found = []
    for t, d, p in zip(columns.of(time.column), columns.of(drive), columns.of(position), strict=True):
        rate = 1.0 / (float(np.median(np.diff(t))) * signals.CLOCKS[time.unit])
        rough = float(np.std(np.diff(p)) / max(float(np.std(p)), 1e-300))
        rough_drive = float(np.std(np.diff(d)) / max(float(np.std(d)), 1e-300))
        explained = signals.relation(p, d, rate, signals.motion_band(p, rate)).explained
        found.append(explained if rough < rough_drive else 0.0)  # a position is the smoother: it is integrated twice
    return max(found)


def _drive(columns: Columns, name: str, why: str) -> Guess:
    m = columns.meanings[name]
    kind = m.kind if m.kind in DRIVES else "current"
    default = {"torque": "N*m", "force": "N", "current": "A", "voltage": "V"}[kind]
    said = f"{why}, and its unit" if m.unit else f"{why}; its unit is a guess"
    unit = m.unit or default
    linear = unit in ("N", "mN", "kN", "uN", "lbf") or kind == "force"
    return Guess("force" if linear else "torque", name, unit, said, kind)


def _position(columns: Columns, name: str, why: str) -> Guess:
    m = columns.meanings[name]
    if m.unit:
        return Guess("position", name, m.unit, f"{why}, and its unit", "position")
    whole = all(np.all(x == np.round(x)) for x in columns.of(name))
    said = "whole numbers, so encoder counts" if whole else "no unit is stated, so that 'rad' is a guess"
    return Guess("position", name, "count" if whole else "rad", f"{why}; {said}", "position")


def _others(columns: Columns, rest: Sequence[str], told: Mapping[str, str], position: Guess) -> tuple[Guess, ...]:
    """Return reference, load position, velocity and temperature, where a name says so or the data do."""
    found: dict[str, Guess] = {}
    for n in rest:
        m = columns.meanings[n]
        like = min(float(np.corrcoef(x, p)[0, 1]) if np.ptp(x) > 0 and np.ptp(p) > 0 else 1.0
                   for x, p in zip(columns.of(n), columns.of(position.column), strict=True))  # fmt: skip
        unit = m.unit or position.unit
        if m.quality & {"error"}:
            continue
        if "load" in m.quality and m.kind == "position":
            found.setdefault("load_position", Guess("load_position", n, unit, "its name says so"))
        elif m.kind == "velocity" and "reference" not in m.quality and m.unit and m.unit != "count":
            found.setdefault("velocity", Guess("velocity", n, m.unit, "its name and unit say so"))
        elif m.kind in ("temperature", "normal") and m.unit:
            found.setdefault(m.kind, Guess(m.kind, n, m.unit, "its name and unit say so"))
        elif "reference" in m.quality and m.kind in ("", "position"):
            found.setdefault("reference", Guess("reference", n, unit, "its name says so"))
        elif m.kind in ("", "position") and like > SMOOTH:
            why = f"it follows the position (correlation {like:.4f})"
            found.setdefault("reference", Guess("reference", n, unit, why))
    for channel, column in told.items():
        if channel not in ("time", "drive", "position"):
            unit = columns.meanings[column].unit or position.unit
            found[channel] = Guess(channel, column, unit, "you say so")
    return tuple(found.values())


def _not_the_reference(columns: Columns, position: Guess, others: tuple[Guess, ...], time: Guess):
    """Exchange position and reference where neither name tells them apart and the 'position' comes first in time."""
    reference = next((g for g in others if g.channel == "reference"), None)
    named = columns.meanings[position.column].quality | (
        columns.meanings[reference.column].quality if reference else frozenset()
    )
    if reference is None or named & {"reference", "measured"}:
        return position, others
    lead = sum(
        float(np.sum(np.diff(r)[1:] * np.diff(p)[:-1]) - np.sum(np.diff(r)[:-1] * np.diff(p)[1:]))
        for r, p in zip(columns.of(reference.column), columns.of(position.column), strict=True)
    )
    why = "the reference leads and the position lags"
    if lead <= 0:  # the reference's rate is like the position's a moment later
        return replace(position, why=f"{position.why}; {why}"), others
    swapped = replace(_position(columns, reference.column, why), why=why)
    back = replace(reference, column=position.column, why=why)
    return swapped, tuple(back if g is reference else g for g in others)
