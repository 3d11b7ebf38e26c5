"""The cells of a text table: every row has as many as the header, and the declared ones hold finite numbers."""

import re
from collections.abc import Sequence
from math import isfinite
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError

NUMBER = re.compile(r"\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*", re.ASCII)
NEWLINE = ord("\n")


def number(cell: str, decimal: str = ".") -> bool:
    """Whether a cell is a finite number with this decimal mark, and no other."""
    if decimal == ",":
        if "." in cell:
            return False
        cell = cell.replace(",", ".")
    return NUMBER.fullmatch(cell) is not None and isfinite(float(cell))


def decimal_mark(lines: Sequence[str], used: Sequence[int], delimiter: str) -> str:
    """Return the decimal mark, "." or ",": the first of them in the declared columns."""
    if delimiter == ",":
        return "."
    for line in lines:
        cells = line.split(delimiter)
        for k in used:
            mark = next((c for c in cells[k] if c in ".,"), "")
            if mark:
                return mark
    return "."


def rectangular(body: bytes, width: int, delimiter: str, first: int, path: Path) -> None:
    """Refuse the first row that is blank or has not `width` cells. first: row of the first line."""
    marks = np.frombuffer(body, np.uint8)
    ends = np.append(np.flatnonzero(marks == NEWLINE), marks.size)
    cells = np.diff(np.searchsorted(np.flatnonzero(marks == ord(delimiter)), ends), prepend=0) + 1
    blank = np.diff(ends, prepend=-1) == 1
    wrong = np.flatnonzero((cells != width) | blank)
    if wrong.size:
        row, count = wrong[0] + first, cells[wrong[0]]
        if not body.split(b"\n", int(wrong[0]) + 1)[wrong[0]].strip():
            raise WorkbenchError(f"{path}, row {row}: is blank; remove the row, or cut the record there.")
        extra = "a comma used for decimals, or inside a text" if delimiter == "," else "the delimiter inside a text"
        hint = f" (is {extra}?)" if count > width else ""
        raise WorkbenchError(f"{path}, row {row}: has {count} cells and the header {width}{hint}; complete the row.")


def fault(
    lines: Sequence[str], header: Sequence[str], used: Sequence[int], delimiter: str, decimal: str
) -> tuple[int, str] | None:
    """Return (line from 0, sentence) of the first declared cell that is no finite number, or None."""
    for row, line in enumerate(lines):
        cells = line.split(delimiter)
        for k in used:
            cell = cells[k].strip()
            if number(cell, decimal):
                continue
            if not cell:
                return row, f"column '{header[k]}' is empty; fill the cell, or cut the record there."
            need = "a finite number is needed, so mend the cell or cut the record there."
            return row, f"column '{header[k]}' holds '{cell[:40]}'; {need}"
    return None
