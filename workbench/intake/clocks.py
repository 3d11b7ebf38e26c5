"""Which column is the time, and in which unit: sure where a name or the data say so, else assumed."""

from collections.abc import Mapping, Sequence

import numpy as np

from workbench.errors import WorkbenchError
from workbench.intake import signals
from workbench.intake.columns import Columns, Guess, Scale
from workbench.intake.wording import no_time, unknown_unit

COUNTERS = set("sample samples index idx count counter cycle cycles nr no n k scan tick ticks".split())
# Seconds since 1970 between 2001 and 2049, in each unit: no time since a start is as large, whatever its unit.
SINCE_1970 = (1.0e9, 2.5e9)
SINCE_1601 = (1.26e17, 1.42e17)  # ticks of 100 ns of Windows, of the same years
TICKS = 1e7  # a second
PLAUSIBLE = (10.0, 200_000.0)  # Hz: a unit is sure where no other makes a rate within these
COUNTED = 1000.0  # Hz, of a counter of samples whose rate no one states


def time_of(columns: Columns, told: Mapping[str, str], rate: float | None) -> Guess:
    """Return the guess for time. rate: Hz, as its user says, where the files have no time column.

    A column that is called so and increases is taken even where its steps are uneven. Raises WorkbenchError, saying why each
    column that is called time was not taken, where there is none.
    """
    if rate is not None:
        return Guess("time", "", "s", "samples are counted at the rate that you say", "time", rate=rate)
    named = [n for n, m in columns.meanings.items() if m.kind == "time"]
    rising = [n for n in named if all(np.all(np.diff(x) > 0) for x in columns.of(n))]
    others = [n for n in columns.names if columns.meanings[n].kind == "" or columns.meanings[n].unit == "count"]
    clocks = [n for n in others if all(signals.is_clock(x) for x in columns.of(n))]
    rising.sort(key=lambda n: not columns.meanings[n].unit)  # of several times the one that states its unit
    clocks.sort(key=lambda n: _counts(columns, n))  # a counter of samples is the last resort
    found = told.get("time") or next(iter(rising), None) or next(iter(clocks), None)
    if found is None:
        raise WorkbenchError(no_time(columns, named))
    why = "you say so" if "time" in told else "its name says so" if found in named else "it increases evenly"
    if found not in named and _counts(columns, found):
        scale = Scale(COUNTED, "count/s", True, "samples a second, which the log does not say")
        return Guess("time", found, "count", f"{why}, one by one, so it counts samples", "time", scale)
    return _in_unit(columns, found, why)


def seconds(time: Guess, values: Sequence[float] | None, size: int) -> np.ndarray:
    """Return (n,) s of a time column's values, or of counted samples."""
    if time.rate:
        return np.arange(size) / time.rate
    factor = 1.0 / time.scale.value if time.unit == "count" else signals.CLOCKS[time.unit]
    return np.asarray(values) * factor


def _counts(columns: Columns, name: str) -> bool:
    """Whether a column counts samples: whole numbers, one by one."""
    one_by_one = all(np.all(np.diff(x) == 1.0) for x in columns.of(name))
    m = columns.meanings[name]
    return one_by_one and (m.unit in ("", "count")) and not (m.kind == "time" and not COUNTERS & set(m.words))


def _in_unit(columns: Columns, name: str, why: str) -> Guess:
    values = columns.of(name)[0]
    m = columns.meanings[name]
    if m.unit == "count":
        scale = Scale(COUNTED, "count/s", True, "counts a second, which the log does not say")
        return Guess("time", name, "count", f"{why}, in counts", "time", scale)
    if m.unknown:
        raise unknown_unit(columns, name)
    step = float(np.median(np.diff(values)))
    if m.unit in signals.CLOCKS:
        rate = 1.0 / (step * signals.CLOCKS[m.unit])
        return Guess("time", name, m.unit, f"{why}, and its unit; that makes {rate:.6g} Hz", "time")
    if SINCE_1601[0] < values[0] < SINCE_1601[1]:
        scale = Scale(TICKS, "count/s", False, "ticks of 100 ns since 1601, as Windows counts")
        return Guess("time", name, "count", f"{why}; that makes {TICKS / step:.6g} Hz", "time", scale)
    for unit, size in signals.CLOCKS.items():
        if SINCE_1970[0] < values[0] * size < SINCE_1970[1]:
            return Guess("time", name, unit, f"{why}; it counts {unit} since 1970, {1 / (step * size):.6g} Hz", "time")
    return _by_rate(name, why, values)


def _by_rate(name: str, why: str, values: np.ndarray) -> Guess:
    """Return the guess of the unit in which a drive could have logged as fast; assumed where another one is as well possible."""
    step = float(np.median(np.diff(values)))
    rates = {unit: 1.0 / (step * size) for unit, size in signals.CLOCKS.items()}
    possible = [u for u, rate in rates.items() if PLAUSIBLE[0] <= rate <= PLAUSIBLE[1]]
    if len(possible) == 1:
        unit = possible[0]
        return Guess("time", name, unit, f"{why}; in {unit} its steps make {rates[unit]:.6g} Hz, as drives log", "time")
    unit, rate = signals.clock_unit(values)
    unit = "s" if "s" in possible else unit  # what states no unit is in seconds more often than not
    others = " or ".join(f"{rates[u]:.6g} Hz in {u}" for u in possible if u != unit) or "nothing a drive logs at"
    scale = Scale(1.0, "1", True, f"no unit is stated: {rates[unit]:.6g} Hz in {unit}, {others}")
    return Guess("time", name, unit, f"{why}; no unit is stated, and '{unit}' is a guess", "time", scale)
