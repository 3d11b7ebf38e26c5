"""Readers of record files: one module a format, chosen by the file's suffix.

A reader gets the bytes, read once, so that the sha256 in the record's Source is that of the very data in use.
"""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from workbench.errors import WorkbenchError, nearest
from workbench.readers import csv, excel, hdf5, json, mat, mcap, mdf, npy, parquet, tdms, wpilog
from workbench.readers.held import Whole
from workbench.readers.sheet import Sheet
from workbench.record import Source


class Reader(Protocol):
    """A format. name: as Source says it. suffixes: in lower case, with the dot."""

    name: str
    suffixes: tuple[str, ...]

    def columns(self, content: bytes, path: Path) -> tuple[str, ...]:
        """Return the names that `read` knows, of columns that may or may not hold numbers; errors as for `read`."""

    def read(self, content: bytes, path: Path, columns: Mapping[str, str]) -> Sheet:
        """Return the columns that `columns` (channel -> column) names.

        Raises WorkbenchError naming `path`, and the row or sample.
        """


READERS: tuple[Reader, ...] = (
    csv.Csv(), mat.Mat(), mdf.Mdf(), tdms.Tdms(), hdf5.Hdf5(), parquet.Parquet(), excel.Excel(), json.Json(), npy.Npy(),
    mcap.Mcap(), wpilog.Wpilog(),
)  # fmt: skip
LARGEST = 1e30  # in any unit that is written: counts of nanoseconds since 1970 are below 1e19; its fourth power does not overflow
SUFFIXES = tuple(s for r in READERS for s in r.suffixes)


def reader(path: Path) -> Reader:
    """Return the reader for this file's suffix; WorkbenchError where there is none."""
    for candidate in READERS:
        if path.name.lower().endswith(candidate.suffixes):
            return candidate
    raise WorkbenchError(f"{path}: no reader for this kind of file; readable are {', '.join(SUFFIXES)}.")


def stem(path: Path) -> str:
    """Return a file's name without the suffixes of its format, dots in it as "_": "run.2.csv.gz" is "run_2"."""
    suffix = max((s for s in SUFFIXES if path.name.lower().endswith(s)), key=len, default="")
    return path.name[: len(path.name) - len(suffix)].replace(".", "_")


def load(path: Path, columns: Mapping[str, str], spared: Sequence[str] = ()) -> tuple[Sheet, Source]:
    """Return the named columns (`columns` is channel -> column) with their places and units, and the Source.

    spared: channels that the file need not hold. Raises WorkbenchError where it cannot be read or holds anything but finite
    numbers in these columns.
    """
    chosen, content = reader(path), _content(path)
    try:
        sheet = chosen.read(content, path, columns)
    except WorkbenchError:
        held = chosen.columns(content, path) if {*spared} & {*columns} else ()
        kept = {n: c for n, c in columns.items() if n not in spared or c in held}
        if len(kept) == len(columns) or not held:
            raise
        sheet, columns = chosen.read(content, path, kept), kept
    return sheet, Source(path, hashlib.sha256(content).hexdigest(), chosen.name, dict(columns))


def read(path: Path, columns: Mapping[str, str]) -> tuple[Mapping[str, np.ndarray], Source]:
    """Return channel -> (n,) array in the file's own units, and the Source; `columns` and errors as for `load`."""
    sheet, source = load(path, columns)
    return sheet.channels, source


@dataclass(frozen=True, eq=False)
class Survey:
    """Every column of a file that holds numbers. columns: name -> (n,) array in the file's units, all of one length.

    units: name -> unit as the file writes it. refused: name -> why a column was left out. notes: what was done to the
    samples on the way in.
    """

    path: Path
    columns: Mapping[str, np.ndarray]
    units: Mapping[str, str]
    refused: Mapping[str, str]
    notes: tuple[str, ...] = ()

    def __post_init__(self):
        beyond = [n for n, v in self.columns.items() if not np.max(np.abs(v), initial=0.0) <= LARGEST]
        why = {
            n: f"{self.path}: column '{n}' reaches {np.max(np.abs(self.columns[n])):.3g}, which nothing measures"
            for n in beyond
        }
        object.__setattr__(self, "columns", {n: v for n, v in self.columns.items() if n not in why})
        object.__setattr__(self, "refused", {**self.refused, **why})


def survey(path: Path, names: Sequence[str] = ()) -> Survey:
    """Return all that a file of unknown content holds; WorkbenchError where not one column can be read.

    names: the columns that are meant, where not all are.
    """
    chosen, content = reader(path), _content(path)
    columns, units, refused, notes = {}, {}, {}, ()
    for name, found in _each(chosen, content, path, names):
        if isinstance(found, WorkbenchError):
            refused[name] = str(found)
        else:
            columns[name], units[name], notes = found.channels[name], found.units.get(name, ""), found.notes
    if not columns:
        raise WorkbenchError(next(iter(refused.values()), f"{path}: holds no columns; export the record again."))
    size = max(v.size for v in columns.values())
    columns = {n: v for n, v in columns.items() if v.size == size}  # scalars beside signals, in .mat files
    return Survey(path, columns, {n: u for n, u in units.items() if u}, refused, notes)


def _each(
    chosen: Reader, content: bytes, path: Path, names: Sequence[str]
) -> Iterator[tuple[str, Sheet | WorkbenchError]]:
    """Yield every column, or why it cannot be read: text or gaps in one do not keep the others from being read."""
    if isinstance(chosen, Whole):
        yield from chosen.each(content, path, names)
        return
    names = names or chosen.columns(content, path)
    try:
        sheet = chosen.read(content, path, {name: name for name in names})
        yield from ((name, sheet) for name in names)
        return
    except WorkbenchError:
        pass
    for name in names:
        try:
            yield name, chosen.read(content, path, {name: name})
        except WorkbenchError as e:
            yield name, e


def _content(path: Path) -> bytes:
    try:
        if path.exists() and not path.is_file():
            raise WorkbenchError(f"{path}: is a folder or a device; a record is a file.")
        return path.read_bytes()
    except FileNotFoundError as e:
        raise WorkbenchError(f"{path}: there is no such file; {_beside(path)}") from e
    except (OSError, ValueError) as e:
        reason = getattr(e, "strerror", None) or e
        raise WorkbenchError(f"{path}: cannot be read ({reason}); make it a readable file.") from e


def _beside(path: Path) -> str:
    """Return the nearest names beside a missing file, as a clause."""
    try:
        names = [p.name for p in path.parent.iterdir() if p.name.lower().endswith(SUFFIXES)]
    except OSError:
        return "nor its folder."
    return nearest(path.name, sorted(names)[:50]) if names else "nor is any other record in its folder."
