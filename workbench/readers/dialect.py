"""How a text table is written, found from its bytes: packing, encoding, comments, delimiter, units row, decimal mark.

The declared column names are known, and they say which delimiter it is: the one that finds them all in the header.
"""

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from workbench.errors import WorkbenchError, nearest
from workbench.readers.cells import number
from workbench.readers.limits import gunzipped
from workbench.units.registry import legible, tidy

GZIP = b"\x1f\x8b"
UTF8, UTF16 = b"\xef\xbb\xbf", (b"\xff\xfe", b"\xfe\xff")  # byte-order marks
COMMENT = (b"#", b"%")
DELIMITERS = (",", ";", "\t", " ")
NO_UNIT = ("", "-", "1")
NUMBERED = re.compile(r"column \d+")
PREAMBLE = 50  # lines that an instrument may write about itself above the header
AGREEING = 4  # lines that are parted alike make a table


@dataclass(frozen=True)
class Dialect:
    """header: column names. units: cells of the units row, or none. body: the samples in UTF-8, a line each; where the
    delimiter is a blank, one blank between cells. first: row of the first sample, counted as editors count."""

    header: Sequence[str]
    units: Sequence[str]
    body: bytes
    first: int
    delimiter: str


def text_of(content: bytes, path: Path) -> bytes:
    """Return a text file unpacked, in UTF-8, with line feeds at the ends of its lines; WorkbenchError where it is empty."""
    return _utf8(_plain(content, path), path).replace(b"\r\n", b"\n").replace(b"\r", b"\n")


def dialect(lines: bytes, path: Path, columns: Mapping[str, str]) -> Dialect:
    """Return how a text is written; WorkbenchError where it has no header with every declared column."""
    line, row, body, first = _parted(lines, columns.values())
    if not line.strip():
        raise WorkbenchError(f"{path}, row {row}: is blank; put the header with the column names there.")
    delimiter = _delimiter(line, columns.values())
    header = _names(line, delimiter)
    _complete(header, f"{path}, row {row}", columns)
    body = body.rstrip(b"\n")
    quotes = body.count(b'"')
    if quotes and not quotes % (2 * (body.count(b"\n") + 1)):  # whole columns in quotes, not a stray cell
        body = body.replace(b'"', b"")
    if delimiter == " ":
        body = b"\n".join(b" ".join(line.split()) for line in body.split(b"\n"))
    head, _, rest = body.partition(b"\n")
    units = [c.strip().strip("[]()").strip() for c in head.decode().split(delimiter)]
    if len(units) == len(header) and are_units([units[header.index(c)] for c in columns.values()]):
        body, first = rest, first + 1
    else:
        units = ()
    if not body:
        raise WorkbenchError(f"{path}: holds no samples below its header; export the record again.")
    return Dialect(header, units, body, first, delimiter)


def _plain(content: bytes, path: Path) -> bytes:
    """Return the text's bytes, unpacked where they are gzip by name or by content."""
    if path.suffix.lower() == ".gz" or content.startswith(GZIP):
        content = gunzipped(content, path)
    if not content.removeprefix(UTF8).strip():
        raise WorkbenchError(f"{path}: is empty; a header row and samples are needed, so export the record again.")
    return content


def _utf8(content: bytes, path: Path) -> bytes:
    """Return the text in UTF-8 without a mark; what is no UTF-8 is Latin-1, in which old software writes "°" and "µ"."""
    if content.startswith(UTF16):
        try:
            return content.decode("utf-16").encode()
        except UnicodeError as e:
            raise WorkbenchError(f"{path}: begins as UTF-16 text and is none; save the file as UTF-8.") from e
    if not content.isascii():
        try:
            content.decode()
        except UnicodeDecodeError:
            return content.decode("latin-1").encode()
    return content.removeprefix(UTF8)


def _parted(lines: bytes, columns: Sequence[str]) -> tuple[str, int, bytes, int]:
    """Return (header line, its row, the rest, row of the rest).

    Comments stand above the header, and blank lines among them. A comment may be the header itself (as NumPy writes it)
    where the line below has not the declared columns. Where neither has them, the header is a line further down that has,
    below what an instrument wrote about itself, or there is none and the columns are called by their numbers.
    """
    comments: list[tuple[str, int]] = []
    row, rest = 1, lines
    while True:
        line, _, after = rest.partition(b"\n")
        if after and (line.startswith(COMMENT) or (comments and not line.strip())):
            comments.append((line.decode(), row))
            row, rest = row + 1, after
            continue
        shown = line.decode()
        if comments and not _finds_all(shown, columns):
            for comment, at in reversed(comments):
                for text in (comment.lstrip("#% "), comment):
                    if _finds_all(text, columns):
                        return text, at, rest, row
        if columns and not _finds_all(shown, columns):
            if all(NUMBERED.fullmatch(c) for c in columns):
                return _numbered(shown), row, rest, row
            for k, lower in enumerate(rest.split(b"\n", PREAMBLE)[1:PREAMBLE], 1):
                if _finds_all(lower.decode(), columns):
                    return lower.decode(), row + k, rest.split(b"\n", k + 1)[-1], row + k + 1
        return shown, row, after, row + 1


def _numbered(line: str) -> str:
    """Return a header for a table without one: "column 1", "column 2", ... parted as its first line is."""
    delimiter = max(DELIMITERS, key=lambda d: _numeric(line, d))
    return delimiter.join(f'"column {k + 1}"' for k in range(len(_names(line, delimiter))))


def columns_of(lines: bytes, path: Path) -> tuple[str, ...]:
    """Return the names of all columns of a table, "column 1" and so on where it has no header.

    The samples begin at the first line that holds numbers and whose next lines are parted alike; the header is the line
    above them, or above a row of units. Raises WorkbenchError where no line holds two numbers.
    """
    top = [line.decode() for line in lines.split(b"\n", PREAMBLE + AGREEING)[: PREAMBLE + AGREEING]]
    for k, line in enumerate(top):
        delimiter = max(DELIMITERS, key=lambda d: _numeric(line, d))
        below = [other for other in top[k : k + AGREEING] if other.strip()]
        width = len(_names(line, delimiter))
        if all(_numeric(o, delimiter)[1] >= 2 and len(_names(o, delimiter)) == width for o in below) and below:
            above = [_names(o.lstrip("#% "), delimiter) for o in top[max(k - 2, 0) : k]]
            above = [cells for cells in above if len(cells) == width]
            if len(above) == 2 and not are_units([c.strip("[]()") for c in above[-1]]):
                del above[0]
            return tuple(above[0]) if above else tuple(_names(_numbered(line), delimiter))
    raise WorkbenchError(
        f"{path}: no line of the first {PREAMBLE} begins a table of numbers; export the record as CSV."
    )


def _numeric(line: str, delimiter: str) -> tuple[float, int, bool]:
    """Return (share of cells that are numbers, how many are, not a blank), by which a delimiter is chosen."""
    cells = _names(line, delimiter)
    marks = "." if delimiter == "," else ".,"
    count = sum(any(number(c, mark) for mark in marks) for c in cells)
    return (count / len(cells) if count > 1 else 0.0), count, delimiter != " "


def _finds_all(line: str, columns: Sequence[str]) -> bool:
    return any(set(columns) <= set(_names(line, d)) for d in DELIMITERS)


def _delimiter(line: str, columns: Sequence[str]) -> str:
    """Return the delimiter that finds most of the declared columns; of equals the one that makes most cells."""
    cells = {d: _names(line, d) for d in DELIMITERS}
    return max(DELIMITERS, key=lambda d: (len(set(columns) & set(cells[d])), d != " ", len(cells[d])))


def _names(line: str, delimiter: str) -> list[str]:
    try:
        row = next(csv.reader([line.strip(" ")], delimiter=delimiter, skipinitialspace=True), [])
    except csv.Error:
        return []
    return [name.strip() for name in row]


def _complete(header: Sequence[str], where: str, columns: Mapping[str, str]) -> None:
    """Every declared column is there, and no name is there twice."""
    twice = sorted({name for name in header if name and header.count(name) > 1})
    if twice:
        raise WorkbenchError(f"{where}: column '{twice[0]}' is there twice; rename or remove one of them.")
    for channel, column in columns.items():
        if column not in header:
            raise WorkbenchError(
                f"{where}: there is no column '{column}' for channel '{channel}'; {nearest(column, header)}"
            )


def are_units(cells: Sequence[str]) -> bool:
    """Whether the cells of a row are units: no sample among them, and at least one that is known."""
    told = [c for c in cells if c not in NO_UNIT]
    return not any(_sample(c) for c in told) and any(legible(tidy(c)) for c in told)


def _sample(cell: str) -> bool:
    """Whether a cell is a sample, if only a "nan"."""
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True
