"""Excel workbooks, by openpyxl: every sheet that holds a table of numbers.

A column is the header's name, with its sheet before it ("run 2.torque") where several sheets hold tables. Formulas have the
values that Excel computed last.
"""

import io
import warnings
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from workbench.errors import WorkbenchError
from workbench.readers.dialect import are_units
from workbench.readers.held import Held, Whole
from workbench.readers.limits import unzippable
from workbench.readers.sheet import library

AGREEING = 4  # rows that begin a table alike
PREAMBLE = 50  # rows that a tool may write about itself above the header


class Excel(Whole):
    """See workbench.readers.Reader."""

    name = "excel"
    suffixes = (".xlsx", ".xlsm")

    def held(self, content: bytes, path: Path) -> Mapping[str, Held]:
        openpyxl = library("openpyxl", "excel", path)
        try:
            unzippable(content, path)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of styles and validations that openpyxl drops
                book = openpyxl.load_workbook(io.BytesIO(content), read_only=True, data_only=True)
                tables = {s.title: dict(_table(list(s.iter_rows(values_only=True)))) for s in book.worksheets}
        except WorkbenchError:
            raise
        except (Exception, zipfile.BadZipFile) as e:  # openpyxl raises whatever broken bytes lead to
            reason = " ".join(str(e).split())[:120] or type(e).__name__
            raise WorkbenchError(f"{path}: is no whole Excel workbook ({reason}); save or copy it again.") from e
        tables = {title: table for title, table in tables.items() if table}
        if not tables:
            raise WorkbenchError(f"{path}: none of its sheets holds a table of numbers; export the record again.")
        one = len(tables) == 1
        return {n if one else f"{title}.{n}": held for title, table in tables.items() for n, held in table.items()}


def _table(rows: Sequence[tuple]) -> Iterator[tuple[str, Held]]:
    """Yield (name, Held) of the columns of a sheet: samples begin where rows of numbers do, names stand above them."""
    first = next((k for k in range(min(len(rows), PREAMBLE)) if _begins(rows[k : k + AGREEING])), None)
    if first is None:
        return
    used = [k for k, cell in enumerate(rows[first]) if cell is not None]
    above = [[_text(row[k]) if k < len(row) else "" for k in used] for row in rows[max(first - 2, 0) : first]]
    units = above.pop() if len(above) == 2 and any(above[0]) and are_units(above[-1]) else [""] * len(used)
    names = above[-1] if above and any(above[-1]) else []
    last = max(k for k, row in enumerate(rows) if any(cell is not None for cell in row)) + 1
    for number, k in enumerate(used):
        name = (names[number] if names else "") or f"column {number + 1}"
        values = [row[k] if k < len(row) else None for row in rows[first:last]]
        yield name, Held(_cells(values), units[number].strip("[]()"))


def _begins(rows: Sequence[tuple]) -> bool:
    counts = [sum(isinstance(c, (int, float)) and not isinstance(c, bool) for c in row) for row in rows]
    return bool(counts) and min(counts) >= 2


def _cells(values: list) -> list:
    """Return numbers; empty cells as nan, dates as texts of ISO 8601."""
    made = [float("nan") if v is None else v.isoformat(" ") if hasattr(v, "isoformat") else v for v in values]
    if made and isinstance(made[0], str) and "." in "".join(m for m in made if isinstance(m, str)):
        made = [m if not isinstance(m, str) or "." in m else f"{m}.0" for m in made]
    return made


def _text(cell: object) -> str:
    return "" if cell is None else str(cell).strip()
