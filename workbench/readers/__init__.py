"""Readers of record files: one module a format, chosen by the file's suffix.

A reader gets the bytes, read once, so that the sha256 in the record's Source is that of the very data in use.
"""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

import numpy as np

from workbench.errors import WorkbenchError, nearest
from workbench.readers import csv, mat, mdf, tdms
from workbench.readers.sheet import Sheet
from workbench.record import Source


class Reader(Protocol):
    """A format. name: as Source says it. suffixes: in lower case, with the dot."""

    name: str
    suffixes: tuple[str, ...]

    def read(self, content: bytes, path: Path, columns: Mapping[str, str]) -> Sheet:
        """Return the columns that `columns` (channel -> column) names.

        Raises WorkbenchError naming `path`, and the row or sample.
        """


READERS: tuple[Reader, ...] = (csv.Csv(), mat.Mat(), mdf.Mdf(), tdms.Tdms())
SUFFIXES = tuple(s for r in READERS for s in r.suffixes)


def reader(path: Path) -> Reader:
    """Return the reader for this file's suffix; WorkbenchError where there is none."""
    for candidate in READERS:
        if path.name.lower().endswith(candidate.suffixes):
            return candidate
    raise WorkbenchError(f"{path}: no reader for this kind of file; readable are {', '.join(SUFFIXES)}.")


def load(path: Path, columns: Mapping[str, str]) -> tuple[Sheet, Source]:
    """Return the named columns (`columns` is channel -> column) with their places and units, and the Source.

    Raises WorkbenchError where the file cannot be read or holds anything but finite numbers in these columns.
    """
    chosen = reader(path)
    try:
        if path.exists() and not path.is_file():
            raise WorkbenchError(f"{path}: is a folder or a device; a record is a file.")
        content = path.read_bytes()
    except FileNotFoundError as e:
        raise WorkbenchError(f"{path}: there is no such file; {_beside(path)}") from e
    except (OSError, ValueError) as e:
        reason = getattr(e, "strerror", None) or e
        raise WorkbenchError(f"{path}: cannot be read ({reason}); make it a readable file.") from e
    sha256 = hashlib.sha256(content).hexdigest()
    return chosen.read(content, path, columns), Source(path, sha256, chosen.name, dict(columns))


def read(path: Path, columns: Mapping[str, str]) -> tuple[Mapping[str, np.ndarray], Source]:
    """Return channel -> (n,) array in the file's own units, and the Source; `columns` and errors as for `load`."""
    sheet, source = load(path, columns)
    return sheet.channels, source


def _beside(path: Path) -> str:
    """Return the nearest names beside a missing file, as a clause."""
    try:
        names = [p.name for p in path.parent.iterdir() if p.name.lower().endswith(SUFFIXES)]
    except OSError:
        return "nor its folder."
    return nearest(path.name, sorted(names)[:50])
