"""Comma-separated text, plain or gzip, with one header row.

The common case is fast: line ends and commas are counted on the bytes (so that ragged and blank rows are found exactly)
and NumPy converts the declared columns. Only where that fails is the file walked cell by cell, to say row and column.
"""

import csv
import gzip
import re
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError, nearest

GZIP = b"\x1f\x8b"
FIRST = 2  # row of the first sample, counted as editors count, after the header
NUMBER = re.compile(r"\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*", re.ASCII)
COMMA, NEWLINE = b",\n"


class Csv:
    """See workbench.readers.Reader."""

    name = "csv"
    suffixes = (".csv", ".csv.gz")

    def place(self, path: Path, sample: int) -> str:
        return f"{path}, row {sample + FIRST}"

    def read(self, content: bytes, path: Path, columns: Mapping[str, str]) -> Mapping[str, np.ndarray]:
        content = _plain(content, path).replace(b"\r\n", b"\n").replace(b"\r", b"\n").removeprefix(b"\xef\xbb\xbf")
        head, _, body = content.partition(b"\n")
        header = _header(_text(head, path, 1), path, columns)
        body = body.rstrip(b"\n")
        if not body:
            raise WorkbenchError(f"{path}: holds no samples below its header; export the record again.")
        _rectangular(body, len(header), path)
        lines = _text(body, path, FIRST).split("\n")
        used = [header.index(column) for column in columns.values()]
        try:
            table = np.loadtxt(lines, delimiter=",", comments=None, usecols=used, ndmin=2)
        except (ValueError, OverflowError) as e:
            raise WorkbenchError(_diagnosis(lines, header, used, path, e)) from e
        if table.shape[0] != len(lines) or not np.isfinite(table).all():
            raise WorkbenchError(_diagnosis(lines, header, used, path, None))
        return {channel: table[:, k].copy() for k, channel in enumerate(columns)}


def _plain(content: bytes, path: Path) -> bytes:
    """Return the text's bytes, unpacked where they are gzip by name or by content."""
    if path.suffix.lower() == ".gz" or content.startswith(GZIP):
        try:
            content = gzip.decompress(content) if content else content
        except (OSError, EOFError, zlib.error) as e:
            raise WorkbenchError(f"{path}: is no whole gzip file ({e}); copy or pack it again.") from e
    if not content.strip():
        raise WorkbenchError(f"{path}: is empty; a header row and samples are needed, so export the record again.")
    return content


def _text(content: bytes, path: Path, row: int) -> str:
    try:
        return content.decode()
    except UnicodeDecodeError as e:
        row += content[: e.start].count(b"\n")
        raise WorkbenchError(f"{path}, row {row}: is not UTF-8 text; save the file as UTF-8 CSV.") from e


def _header(line: str, path: Path, columns: Mapping[str, str]) -> list[str]:
    """Return the column names; every declared column is there, once."""
    try:
        header = [name.strip() for name in next(csv.reader([line]), [])]
    except csv.Error as e:
        raise WorkbenchError(f"{path}, row 1: the header cannot be read ({e}); name the columns there.") from e
    if not any(header):
        raise WorkbenchError(f"{path}, row 1: is blank; put the header with the column names there.")
    twice = sorted({name for name in header if name and header.count(name) > 1})
    if twice:
        raise WorkbenchError(f"{path}, row 1: column '{twice[0]}' is there twice; rename or remove one of them.")
    for channel, column in columns.items():
        if column not in header:
            separator = next((s for s in (";", "\t") if len(header) == 1 and s in line), None)
            mend = "separate cells by commas." if separator else nearest(column, header)
            raise WorkbenchError(f"{path}, row 1: there is no column '{column}' for channel '{channel}'; {mend}")
    return header


def _rectangular(body: bytes, width: int, path: Path) -> None:
    """Refuse the first row that is blank or has not `width` cells."""
    marks = np.frombuffer(body, np.uint8)
    ends = np.append(np.flatnonzero(marks == NEWLINE), marks.size)
    cells = np.diff(np.searchsorted(np.flatnonzero(marks == COMMA), ends), prepend=0) + 1
    blank = np.diff(ends, prepend=-1) == 1
    wrong = np.flatnonzero((cells != width) | blank)
    if wrong.size:
        row, count = wrong[0] + FIRST, cells[wrong[0]]
        if not body.split(b"\n", int(wrong[0]) + 1)[wrong[0]].strip():
            raise WorkbenchError(f"{path}, row {row}: is blank; remove the row, or cut the record there.")
        extra = " (is a comma used for decimals, or inside a text?)" if count > width else ""
        raise WorkbenchError(f"{path}, row {row}: has {count} cells and the header {width}{extra}; complete the row.")


def _diagnosis(lines: list[str], header: list[str], used: list[int], path: Path, error: Exception | None) -> str:
    """Return the sentence for the first cell that is no finite number."""
    for row, line in enumerate(lines, FIRST):
        cells = line.split(",")
        for k in used:
            cell = cells[k]
            if NUMBER.fullmatch(cell) and np.isfinite(float(cell)):
                continue
            where = f"{path}, row {row}: column '{header[k]}'"
            if not cell.strip():
                return f"{where} is empty; fill the cell, or cut the record there."
            return f"{where} holds '{cell.strip()[:40]}'; a finite number is needed, so mend the cell or cut the record there."
    return f"{path}: its numbers cannot be read ({error}); export the record again as plain CSV."
