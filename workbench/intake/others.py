"""The columns beside time, drive and position: which serve as further channels, and what the rest might be."""

from collections.abc import Mapping, Sequence

import numpy as np

from workbench.errors import WorkbenchError
from workbench.intake.axes import elsewhere
from workbench.intake.columns import Columns, Guess
from workbench.intake.wording import unknown_unit
from workbench.units import to_si

SMOOTH = 0.999  # correlation above which a column is another reading of the position
NAMED, UNNAMED = (
    0.1,
    0.02,
)  # a reference goes as far as the position but for this: where its name says so, and where none does
SHOWN = 12  # unused columns that are listed; a bag of topics has hundreds
MAYBE = {
    "temperature": "a temperature, and states no unit",
    "current": "a current beside the drive that is used",
    "torque": "another torque, perhaps of a sensor",
    "force": "another force, perhaps of a sensor",
    "voltage": "a voltage",
    "velocity": "a velocity, which the position holds, too",
    "time": "another clock",
    "normal": "a normal force, and states no unit",
}


def alike(columns: Columns, a: str, b: str) -> bool:
    """Whether two columns follow each other in every file."""
    pairs = zip(columns.of(a), columns.of(b), strict=True)
    return all(np.ptp(x) > 0 and np.ptp(y) > 0 and abs(np.corrcoef(x, y)[0, 1]) > SMOOTH for x, y in pairs)


def _slope(columns: Columns, name: str, position: str) -> float:
    """Return how far a column goes for one unit of the position, by least squares over all files."""
    x = np.concatenate([v - np.mean(v) for v in columns.of(position)])
    y = np.concatenate([v - np.mean(v) for v in columns.of(name)])
    return float(x @ y) / max(float(x @ x), 1e-300)


def others_of(columns: Columns, rest: Sequence[str], told: Mapping[str, str], position: Guess) -> tuple[Guess, ...]:
    """Return reference, load position, velocity and temperature, where a name says so or the data do."""
    found: dict[str, Guess] = {}
    for n in rest:
        guess = _other(columns, n, position)
        if guess is not None:
            found.setdefault(guess.channel, guess)
    for channel, column in told.items():
        if channel not in ("time", "drive", "position"):
            m = columns.meanings[column]
            if m.unknown:
                raise unknown_unit(columns, column)
            found[channel] = Guess(channel, column, m.unit or position.unit, "you say so", stated=bool(m.unit))
    return tuple(found.values())


def _other(columns: Columns, n: str, position: Guess) -> Guess | None:
    m = columns.meanings[n]
    unit, stated = m.unit or position.unit, bool(m.unit) or position.stated
    if "error" in m.quality or m.unknown:
        return None
    if "load" in m.quality and m.kind == "position":
        return Guess("load_position", n, unit, "its name says so", stated=stated)
    if m.kind == "velocity" and "reference" not in m.quality and m.unit and m.unit != "count":
        return Guess("velocity", n, m.unit, "its name and unit say so")
    if m.kind in ("temperature", "normal") and m.unit:
        return Guess(m.kind, n, m.unit, "its name and unit say so")
    if m.kind not in ("", "position"):
        return None
    named = "reference" in m.quality
    if _as_far(columns, n, unit, position, NAMED if named else UNNAMED):
        if named:
            return Guess("reference", n, unit, "its name says so", stated=stated)
        if (
            alike(columns, n, position.column)
            and not _same(columns, n, position.column)
            and "measured" not in m.quality
        ):
            return Guess("reference", n, unit, "it goes as far as the position, and follows it", stated=stated)
    return None


def _as_far(columns: Columns, n: str, unit: str, position: Guess, within: float) -> bool:
    """Whether a column goes as far as the position, each in its unit, and from the same zero."""
    try:
        scale = 1.0 if unit == position.unit else to_si(1.0, unit, position.unit, n, step=True)
    except WorkbenchError:  # counts beside an angle
        return False
    apart = [abs(scale * np.mean(r) - np.mean(p)) / max(np.ptp(p), 1e-300) for r, p in
             zip(columns.of(n), columns.of(position.column), strict=True)]  # fmt: skip
    return abs(scale * _slope(columns, n, position.column) - 1.0) < within and max(apart) < 0.5


def _same(columns: Columns, a: str, b: str) -> bool:
    return all(np.array_equal(x, y) for x, y in zip(columns.of(a), columns.of(b), strict=True))


def unused(columns: Columns, guesses: Sequence[Guess]) -> list[str]:
    """Return a line on every column that is not used: what it might be."""
    used = {g.column for g in guesses}
    position, apart = guesses[2].column, elsewhere(columns, used)
    mine = [n for n in columns.names if n not in used and n not in apart]
    left = [f"    '{n}': {_maybe(columns, n, position)}" for n in mine]
    for axis in dict.fromkeys(apart.values()):
        names = [f"'{n}'" for n in columns.names if apart.get(n) == axis]
        left.append(f"    {', '.join(names)}: of axis {axis}")
    more = [f"    and {len(left) - SHOWN} more"] if len(left) > SHOWN else []
    return ["not used:", *left[:SHOWN], *more] if left else []


def _maybe(columns: Columns, n: str, position: str) -> str:
    m = columns.meanings[n]
    if not columns.moves(n):
        return "it does not change"
    if "error" in m.quality:
        return "a control error"
    if m.kind in MAYBE and not (m.kind == "temperature" and m.unit):
        return f"a set value of {m.kind}" if "reference" in m.quality and m.kind != "time" else MAYBE[m.kind]
    if _same(columns, n, position):
        return "the position once more"
    if alike(columns, n, position):
        far = _slope(columns, n, position)
        if "reference" in m.quality:
            return f"called a set value, but it goes {far:.5g} times as far as the position; state its unit by --unit"
        return (
            f"it follows the position, {far:.5g} times as far: perhaps a second encoder (--channel load_position=...)"
        )
    return f"perhaps a {m.kind}" if m.kind else "unknown"
