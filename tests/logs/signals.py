"""The motion that every log holds, its columns in the units of a layout, and the ten ways in which logs of one layout differ."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

SAMPLES = 700
TORQUE_CONSTANT = 0.12  # N*m/A
COUNTS = 65536 / (2 * np.pi)  # a rad


@dataclass(frozen=True)
class Column:
    """One column of a layout. signal: what it holds. name: with "{}" where its unit stands. units: (label, SI per unit), the
    usual one first. channel: what `new` should take it for, or "". whole: it is logged in whole numbers. digits: after the point.
    """

    signal: str
    name: str
    units: Sequence[tuple[str, float]] = (("", 1.0),)
    channel: str = ""
    whole: bool = False


@dataclass(frozen=True)
class Layout:
    """name, source: of the layout. suffix: of its files. write: (path, names, table, units, rate, rng, comma) -> None.

    rate: Hz. axis: the one that is meant, where it holds several. locale: whether it can be written with decimal commas. linear:
    N over m. fixed: the first columns keep their place. extra: whether columns may stand beside. jitter: whether its clock may be uneven. numbered: how a column is
    called by its place, where the file has no names.
    """

    name: str
    source: str
    suffix: str
    write: Callable
    columns: Sequence[Column]
    rate: float = 1000.0
    axis: str = ""
    locale: bool = False
    linear: bool = False
    fixed: int = 0
    extra: bool = True
    jitter: bool = True
    numbered: str = ""


@dataclass(frozen=True)
class Made:
    """A file and its truth. columns: channel -> column name. scale: channel -> SI per unit. time: (n,) s of the samples; si: channel -> (n,)."""

    path: Path
    columns: dict[str, str]
    scale: dict[str, float]
    time: np.ndarray
    si: dict[str, np.ndarray]
    units: dict[str, str] = field(default_factory=dict)


VARIANTS = (
    "as it is",
    "reversed",
    "shuffled",
    "other units",
    "locale",
    "extra columns",
    "jitter",
    "offset",
    "dots",
    "all at once",
)
EXTRA = (
    Column("temperature", "Motor temperature [{}]", (("degC", 1.0),)),
    Column("still", "Status"),
    Column("still", "Torque sensor [{}]", (("Nm", 1.0),)),  # it was never connected
    Column("error", "Following error"),
)


def signals(time: np.ndarray, seed: int) -> dict[str, np.ndarray]:
    """Return name -> (n,) in SI, of the axis that is meant and of two others ("position 1", ...)."""
    rng = np.random.default_rng(seed)
    found = {"time": time, "still": np.zeros(time.size), "sample": np.arange(time.size, dtype=float)}
    for k in range(3):
        w = 2 * np.pi * np.array([1.1, 2.3, 4.1]) * (1 + 0.17 * k)
        amplitude, phase = np.array([1.0, 0.4, 0.12]), rng.uniform(0, 6, 3)
        terms = [a * np.sin(x * time + p) for a, x, p in zip(amplitude, w, phase, strict=True)]
        position = sum(terms) + 0.3 * k
        rates = [a * x * np.cos(x * time + p) for a, x, p in zip(amplitude, w, phase, strict=True)]
        velocity, acceleration = sum(rates), -sum(x**2 * s for x, s in zip(w, terms, strict=True))
        ahead = sum(a * np.sin(x * (time + 0.004) + p) for a, x, p in zip(amplitude, w, phase, strict=True)) + 0.3 * k
        torque = 0.004 * acceleration + 0.01 * velocity + 0.06 * np.tanh(velocity / 0.05)
        torque = torque + 0.004 * rng.normal(size=time.size)
        end = "" if k == 0 else f" {k}"
        found |= {f"position{end}": position, f"torque{end}": torque, f"velocity{end}": velocity}
        found |= {f"reference{end}": ahead, f"acceleration{end}": acceleration, f"error{end}": ahead - position}
        found |= {f"current{end}": torque / TORQUE_CONSTANT, f"external{end}": 0.01 * rng.normal(size=time.size)}
    found["temperature"] = 31.0 + 0.5 * time + 0.01 * rng.normal(size=time.size)
    found["other current"] = 0.05 * rng.normal(size=time.size)
    return found


def made(layout: Layout, variant: int, folder: Path) -> Made:
    """Write one variant of a layout into a folder, and return its truth."""
    rng = np.random.default_rng([variant, len(layout.name), ord(layout.name[0])])
    every = variant == len(VARIANTS) - 1
    jitter = (variant == 6 or every) and layout.jitter
    offset = 812.0 if variant == 7 or every else 0.0
    steps = np.full(SAMPLES - 1, 1.0)
    if jitter:
        steps += rng.uniform(-0.25, 0.25, steps.size)
    time = np.concatenate([[0.0], np.cumsum(steps)]) / layout.rate
    held = signals(time, len(layout.name))
    columns = list(layout.columns)
    if (variant == 5 or every) and layout.extra:
        columns += EXTRA
    columns = ordered(columns, layout.fixed, variant, every, rng)
    names, table, units, truth = [], [], [], {}
    for c in columns:
        label, si = c.units[min(1, len(c.units) - 1) if variant == 3 or every else 0]
        values = (held[c.signal] + (offset if c.signal == "time" else 0.0)) / si
        names.append(layout.numbered.format(len(names) + 1) or c.name.format(label))
        units.append(label)
        table.append(np.round(values) if c.whole else values)
        if c.channel:
            truth[c.channel] = (names[-1], si, label)
    stem = "run.2026.11.22" if variant == 8 or every else f"log_{variant}"
    path = folder / f"{stem}{layout.suffix}"
    layout.write(path, names, np.array(table), units, layout.rate, layout.locale and (variant == 4 or every))
    where = {c: n for c, (n, _, _) in truth.items()}
    si = {c: held[next(x.signal for x in columns if x.channel == c)] for c in truth}
    return Made(
        path,
        where,
        {c: s for c, (_, s, _) in truth.items()},
        time + offset,
        si,
        {c: u for c, (_, _, u) in truth.items()},
    )


def ordered(columns: list[Column], fixed: int, variant: int, every: bool, rng) -> list[Column]:
    head, tail = columns[:fixed], columns[fixed:]
    if variant == 1:
        tail = tail[::-1]
    if variant == 2 or every:
        tail = [tail[k] for k in rng.permutation(len(tail))]
    return [*head, *tail]


def axes_of(template: Sequence[Column], names: Sequence[str], at: str = "@") -> list[Column]:
    """Return columns for several axes: `at` in a name stands for the axis; the first axis is the one that is meant."""
    found = []
    for c in template:
        if at not in c.name:
            found.append(c)
            continue
        for k, axis in enumerate(names):
            end = "" if k == 0 else f" {1 + (k - 1) % 2}"
            found.append(
                replace(c, name=c.name.replace(at, axis), signal=f"{c.signal}{end}", channel="" if k else c.channel)
            )
    return found
