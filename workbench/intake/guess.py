"""Which column is which channel: by its name and unit where these say so, else by the data."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from workbench.errors import WorkbenchError, nearest
from workbench.intake import signals
from workbench.intake.axes import DRIVES, of_axis
from workbench.intake.clocks import seconds, time_of
from workbench.intake.columns import Columns, Guess
from workbench.intake.names import is_length, kind_of
from workbench.intake.others import alike, others_of
from workbench.intake.wording import unknown_unit, untold

EXPLAINED = 0.3  # share of a drive's power that motion must explain for nameless columns to be taken for a pair
APART = 0.1  # of a drive's power: a pair of columns that explains as much but for this is a rival of the best
IDLE = {"d", "id", "reactive"}  # of the current along the field, which makes no torque
ROS = "as sensor_msgs/JointState has it; a sliding joint's is in"  # of position and effort beside each other


def channels(
    columns: Columns, told: Mapping[str, str], *, axis: str = "", rate: float | None = None
) -> tuple[Guess, ...]:
    """Return the guesses for time, drive, position and whatever else is there, in this order.

    told: channel -> column, as its user says. axis: which of several is meant. rate: Hz, where no column is the time. Raises
    WorkbenchError, naming the flag that says it, where one of the first three cannot be told.
    """
    for channel, column in told.items():
        if column not in columns.names:
            raise WorkbenchError(
                f"--channel {channel}={column}: there is no such column; {nearest(column, columns.names)}"
            )
    columns, _ = of_axis(columns, axis, told)
    time = time_of(columns, told, rate)
    rest = [n for n in columns.names if n != time.column and n not in told.values() and columns.moves(n)]
    rest = [n for n in rest if columns.meanings[n].kind != "time"]
    drive, position = _pair(columns, rest, told, time)
    if kind_of(drive.unit) not in ("torque", "force") and is_length(position.unit):
        drive = replace(drive, channel="force")
    taken = {time.column, drive.column, position.column}
    others = others_of(columns, [n for n in rest if n not in taken], told, position)
    position, others = _not_the_reference(columns, position, others)
    return (time, drive, position, *others)


def _pair(columns: Columns, rest: Sequence[str], told: Mapping[str, str], time: Guess) -> tuple[Guess, Guess]:
    """Return drive and position: by name, else the pair of columns in which motion explains the drive best."""
    named = {
        "drive": [told["drive"]] if "drive" in told else _likeliest(columns, rest, DRIVES),
        "position": [told["position"]] if "position" in told else _likeliest(columns, rest, ("position",)),
    }
    open_ = [n for n in rest if columns.meanings[n].kind == "" and "error" not in columns.meanings[n].quality]
    named["position"] = list(_distinct(columns, named["position"]))
    pairs = [(d, p) for d in named["drive"] or open_ for p in named["position"] or open_ if d != p]
    scores = {pair: _explained(columns, *pair, time) if len(pairs) > 1 else 1.0 for pair in pairs}
    best = max(scores, key=scores.get, default=None)
    if best is None or (scores[best] < EXPLAINED and not (named["drive"] and named["position"])):
        raise WorkbenchError(untold(columns, rest))
    rivals = [p for p in pairs if scores[p] > scores[best] - APART and _another(columns, p, best)]
    if rivals:
        shown = " and ".join(f"'{d}' over '{p}' ({100 * scores[d, p]:.0f} %)" for d, p in (best, *rivals[:2]))
        part = "drive" if rivals[0][1] == best[1] else "position"
        mend = f"--channel {part}={best[part == 'position']}"
        raise WorkbenchError(
            f"{columns.path}: several pairs of columns may be drive and position: motion explains {shown}; say which is meant: {mend}"
        )
    reasons = {
        part: "you say so" if part in told
        else "its name says so" if by_name
        else f"motion explains {100 * scores[best]:.0f} % of one column by the other, the best of all pairs"
        for part, by_name in named.items()
    }  # fmt: skip
    ros = "effort" in columns.meanings[best[0]].words
    return _drive(columns, best[0], reasons["drive"], ros), _position(columns, best[1], reasons["position"], ros)


def _distinct(columns: Columns, names: Sequence[str]) -> Iterator[str]:
    """Yield columns of which none follows an earlier one: several readings of one position are one candidate."""
    kept: list[str] = []
    for n in names:
        if not any(alike(columns, n, other) for other in kept):
            kept.append(n)
            yield n


def _another(columns: Columns, pair: tuple[str, str], best: tuple[str, str]) -> bool:
    """Whether a pair is another axis's, or another drive signal: not a second reading of the same two."""
    return any(a != b and not alike(columns, a, b) for a, b in zip(pair, best, strict=True))


def _likeliest(columns: Columns, names: Sequence[str], kinds: Sequence[str]) -> list[str]:
    """Return the columns of these quantities that come first: measured before set values, and no errors or loads."""

    def rank(n: str):
        m = columns.meanings[n]
        return ("reference" in m.quality, "measured" not in m.quality, kinds.index(m.kind))

    fit = [n for n in names if columns.meanings[n].kind in kinds]
    fit = [
        n for n in fit if not (columns.meanings[n].kind == "current" and IDLE & set(columns.meanings[n].words))
    ] or fit
    fit = [n for n in fit if not {"error", "load"} & columns.meanings[n].quality]
    return [n for n in fit if rank(n) == min(map(rank, fit))]


def _explained(columns: Columns, drive: str, position: str, time: Guess) -> float:
    """Return the share of the drive that motion explains, the best of all files; less where a position is rough."""
    found = []
    for s in columns.surveys:
        d, p = s.columns[drive], s.columns[position]
        rate = 1.0 / float(np.median(np.diff(seconds(time, s.columns.get(time.column), d.size))))
        rough = float(np.std(np.diff(p)) / max(float(np.std(p)), 1e-300))
        rough_drive = float(np.std(np.diff(d)) / max(float(np.std(d)), 1e-300))
        explained = signals.relation(p, d, rate, signals.motion_band(p, rate)).explained
        found.append(explained if rough < rough_drive else 0.0)  # a position is the smoother: it is integrated twice
    return max(found)


def _drive(columns: Columns, name: str, why: str, ros: bool) -> Guess:
    m = columns.meanings[name]
    if m.unknown:
        raise unknown_unit(columns, name)
    kind = m.kind if m.kind in DRIVES else "current"
    default = {"torque": "N*m", "force": "N", "current": "A", "voltage": "V"}[kind]
    said = f"{why}, and its unit" if m.unit else f"{why}; its unit is a guess"
    said = f"{why}; in N*m {ROS} N" if ros and not m.unit else said
    unit = m.unit or default
    linear = unit in ("N", "mN", "kN", "uN", "lbf") or kind == "force"
    return Guess("force" if linear else "torque", name, unit, said, kind, stated=bool(m.unit))


def _position(columns: Columns, name: str, why: str, ros: bool = False) -> Guess:
    m = columns.meanings[name]
    if m.unknown:
        raise unknown_unit(columns, name)
    if m.unit:
        return Guess("position", name, m.unit, f"{why}, and its unit", "position")
    whole = all(np.all(x == np.round(x)) for x in columns.of(name))
    said = "whole numbers, so encoder counts" if whole else "no unit is stated, so that 'rad' is a guess"
    said = f"in rad {ROS} m" if ros and not whole else said
    return Guess("position", name, "count" if whole else "rad", f"{why}; {said}", "position", stated=False)


def _not_the_reference(columns: Columns, position: Guess, others: tuple[Guess, ...]):
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
