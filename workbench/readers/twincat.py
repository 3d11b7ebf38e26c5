"""The CSV of TwinCAT Scope, in which channels have time columns of their own.

After Beckhoff, "TE13xx TC3 Scope View", Export to CSV: some rows about the project; a row for each property of the channels,
in which the property's name stands over each time column ("Name", "SymbolName", "Unit"); then the samples, of which a
channel that is sampled more slowly has fewer. Times are ms from the first sample, or ticks of 100 ns of Windows.
"""

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError
from workbench.readers.cells import number
from workbench.readers.held import Held

DELIMITERS = "\t;,"
PROJECT = ("File", "Starttime of export", "StartRecord", "Start time of export")  # second row of the head
TICKS = 1e14  # ms since the start are fewer, ticks since 1601 more


def is_scope(lines: Sequence[str]) -> bool:
    """Whether a text begins as TwinCAT Scope writes it."""
    head = [line.split(d)[0].strip('"') for d in DELIMITERS for line in lines[:4] if d in line]
    return "Name" in head[:1] and any(key in head for key in PROJECT)


def held(text: str, path: Path) -> dict[str, Held]:
    """Return the channels of a scope's CSV by name; WorkbenchError where their times cannot be told."""
    lines = text.split("\n")
    delimiter = max(DELIMITERS, key=lambda d: sum(line.startswith(f"Name{d}") for line in lines[:60]))
    rows = list(csv.reader(lines, delimiter=delimiter))
    first = next((k for k, row in enumerate(rows) if k > 1 and _samples(row)), None)
    if first is None:
        raise WorkbenchError(f"{path}: holds no samples below its head; export the scope again.")
    start = max((k for k, row in enumerate(rows[:first]) if row and row[0] == "Name"), default=0)
    if start == 0:
        raise WorkbenchError(f"{path}: its head does not name the channels; export it with the full header.")
    head = {row[0]: row for row in rows[start:first] if row and row[0]}
    width = len(head["Name"])
    clocks = [k for k in range(width) if head["Name"][k] == "Name"]
    if len(clocks) == width or not all(map(_given, rows[first][:1])):
        raise WorkbenchError(f"{path}: has no time columns; export it with a timeline for each sample time.")
    names = _names(head, [k for k in range(width) if k not in clocks])
    body = [row for row in rows[first:] if len(row) >= 2]
    decimal = "," if delimiter != "," and any("," in cell for row in body[:50] for cell in row) else "."
    times = {k: _times(_column(body, k, decimal)) for k in clocks}
    units = head.get("Unit", [])
    found = {}
    for k, name in names.items():
        clock = times[max(c for c in clocks if c < k)]
        values = _column(body, k, decimal)[: clock.size]
        unit = units[k].strip("[]() ") if k < len(units) else ""
        found[name] = Held(values, "" if unit.lower() == "none" else unit, clock[: values.size])
    return found


def _samples(row: Sequence[str]) -> bool:
    return len(row) >= 2 and all(_given(c) for c in row[:2])


def _given(cell: str) -> bool:
    return number(cell) or number(cell, ",")


def _names(head: dict, used: Sequence[int]) -> dict[int, str]:
    """Return column -> name: the short one where it is the only one, else the path of the symbol."""
    short = {k: head["Name"][k].strip() for k in used}
    long = head.get("SymbolName", head["Name"])
    twice = len(set(short.values())) < len(short)
    return {k: long[k].strip() if twice and k < len(long) else name for k, name in short.items() if name}


def _column(body: Sequence[Sequence[str]], k: int, decimal: str) -> np.ndarray:
    """Return the samples of a column, up to the first cell that is empty or no number."""
    found = []
    for row in body:
        cell = row[k].strip() if k < len(row) else ""
        if not number(cell, decimal):
            break
        found.append(float(cell.replace(",", ".")))
    return np.array(found)


def _times(column: np.ndarray) -> np.ndarray:
    """Return times in s: of ticks of 100 ns, from the first on."""
    if column.size and column[0] > TICKS:
        return (column - column[0]) * 1e-7
    return column * 1e-3
