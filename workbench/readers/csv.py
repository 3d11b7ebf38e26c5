"""Text tables, plain or gzip, with one header row: cells parted by commas, semicolons, tabs or blanks.

The common case is fast: line ends and delimiters are counted on the bytes (so that ragged and blank rows are found
exactly) and NumPy converts the declared columns. Only where that fails is the file walked cell by cell, to say row and
column.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError
from workbench.readers.cells import decimal_mark, fault, rectangular
from workbench.readers.dialect import Dialect, columns_of, dialect
from workbench.readers.sheet import Sheet


class Csv:
    """See workbench.readers.Reader."""

    name = "csv"
    suffixes = (".csv", ".csv.gz", ".tsv", ".tsv.gz", ".txt", ".txt.gz")

    def columns(self, content: bytes, path: Path) -> tuple[str, ...]:
        return columns_of(content, path)

    def read(self, content: bytes, path: Path, columns: Mapping[str, str]) -> Sheet:
        found = dialect(content, path, columns)
        rectangular(found.body, len(found.header), found.delimiter, found.first, path)
        used = [found.header.index(column) for column in columns.values()]
        table = _numbers(found, used, path)
        return Sheet(
            {channel: table[:, k].copy() for k, channel in enumerate(columns)},
            lambda sample: f"{path}, row {sample + found.first}",
            {channel: found.units[k] for channel, k in zip(columns, used, strict=True)} if found.units else {},
        )


def _numbers(found: Dialect, used: list[int], path: Path) -> np.ndarray:
    """Return the declared columns (n, columns); WorkbenchError with row and column of what is no finite number."""
    text = found.body.decode()
    lines = text.split("\n")
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
