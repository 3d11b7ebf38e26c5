"""Text tables, plain or gzip, with one header row: cells parted by commas, semicolons, tabs or blanks.

The common case is fast: line ends and delimiters are counted on the bytes (so that ragged and blank rows are found
exactly) and NumPy converts the declared columns. Only where that fails is the file walked cell by cell, to say row and
column. Two layouts that no header tells are parted by modules of their own: TwinCAT Scope's, and `ros2 topic echo --csv`.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError
from workbench.readers import echo, instants, twincat
from workbench.readers.cells import decimal_mark, fault, rectangular
from workbench.readers.dialect import Dialect, columns_of, dialect, text_of
from workbench.readers.held import Held, Whole, chosen
from workbench.readers.sheet import Sheet

LAYOUTS = ((twincat.is_scope, twincat.held), (echo.is_echo, echo.held))
HEAD = 4  # lines by which a layout is known


class Csv:
    """See workbench.readers.Reader."""

    name = "csv"
    suffixes = (".csv", ".csv.gz", ".tsv", ".tsv.gz", ".txt", ".txt.gz", ".dat", ".log")

    def columns(self, content: bytes, path: Path) -> tuple[str, ...]:
        text = text_of(content, path)
        layout = _layout(text)
        return _Laid(layout(text.decode(), path)).columns(content, path) if layout else columns_of(text, path)

    def read(self, content: bytes, path: Path, columns: Mapping[str, str]) -> Sheet:
        text = text_of(content, path)
        if layout := _layout(text):
            return chosen(layout(text.decode(), path), path, columns)
        found = dialect(text, path, columns)
        rectangular(found.body, len(found.header), found.delimiter, found.first, path)
        used = [found.header.index(column) for column in columns.values()]
        table = _numbers(found, used, path)
        return Sheet(
            {channel: table[:, k].copy() for k, channel in enumerate(columns)},
            lambda sample: f"{path}, row {sample + found.first}",
            {channel: found.units[k] for channel, k in zip(columns, used, strict=True)} if found.units else {},
        )


class _Laid(Whole):
    def __init__(self, held: Mapping[str, Held]):
        self._held = held

    def held(self, content: bytes, path: Path) -> Mapping[str, Held]:
        return self._held


def _layout(text: bytes):
    """Return what parts a text of one of the two layouts, or None."""
    lines = text.split(b"\n", HEAD)[:HEAD]
    shown = [line.decode() for line in lines]
    return next((part for known, part in LAYOUTS if known(shown)), None)


def _numbers(found: Dialect, used: list[int], path: Path) -> np.ndarray:
    """Return the declared columns (n, columns); WorkbenchError with row and column of what is no finite number."""
    text = found.body.decode()
    lines = text.split("\n")
    first = lines[0].split(found.delimiter)
    dated = [k for k in used if instants.written(first[k])]
    if dated:
        return _with_dates(found, used, dated, lines, path)
    return _plain(found, used, text, lines, path)


def _with_dates(found: Dialect, used: list[int], dated: list[int], lines: Sequence[str], path: Path) -> np.ndarray:
    cells = {k: [line.split(found.delimiter)[k] for line in lines] for k in dated}
    table = np.empty((len(lines), len(used)))
    rest = [k for k in used if k not in dated]
    if rest:
        table[:, [used.index(k) for k in rest]] = _plain(found, rest, "\n".join(lines), lines, path)
    for k, texts in cells.items():
        wrong = next((row for row, cell in enumerate(texts) if not instants.written(cell)), None)
        if wrong is not None:
            raise WorkbenchError(
                f"{path}, row {wrong + found.first}: column '{found.header[k]}' holds '{texts[wrong][:40]}', which is no time; mend it."
            )
        table[:, used.index(k)] = instants.seconds(texts)
    return table


def _plain(found: Dialect, used: list[int], text: str, lines: Sequence[str], path: Path) -> np.ndarray:
    decimal = decimal_mark(lines, used, found.delimiter) if "," in text else "."
    # A point beside decimal commas may part thousands, so it is looked for first.
    wrong = fault(lines, found.header, used, found.delimiter, decimal) if decimal == "," and "." in text else None
    reason = ""
    if wrong is None:
        rows = text.replace(",", ".").split("\n") if decimal == "," else lines
        try:
            table = np.loadtxt(rows, delimiter=found.delimiter, comments=None, usecols=used, ndmin=2)
            if table.shape[0] == len(lines) and np.isfinite(table).all():
                return table
        except (ValueError, OverflowError) as e:
            reason = f" ({e})"
        wrong = fault(lines, found.header, used, found.delimiter, decimal)
    if wrong is None:
        raise WorkbenchError(f"{path}: its numbers cannot be read{reason}; export the record again as plain CSV.")
    raise WorkbenchError(f"{path}, row {wrong[0] + found.first}: {wrong[1]}")
