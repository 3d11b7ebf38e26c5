"""HDF5 files of any layout, by h5py; MATLAB's version 7.3 is one of them.

A column is a dataset's path, its groups joined by dots; "log.t" is also field t of a compound dataset "log", and "log(:,3)" a
column of a matrix. The attribute "units" or "unit" of a dataset is its unit.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError, nearest
from workbench.readers.arrays import addressed, listed, taken
from workbench.readers.limits import within
from workbench.readers.sheet import Sheet, library, sheet, vector

MAGIC = b"\x89HDF\r\n\x1a\n"
BLOCKS = (0, 512)  # where HDF5 may begin: MATLAB writes its own 512 bytes before it


class Hdf5:
    """See workbench.readers.Reader."""

    name = "hdf5"
    suffixes = (".h5", ".hdf5", ".he5")

    def columns(self, content: bytes, path: Path) -> tuple[str, ...]:
        return names(content, path)

    def read(self, content: bytes, path: Path, columns: Mapping[str, str]) -> Sheet:
        found = datasets(content, path, columns.values())
        vectors = {c: vector(found[n][0], n, path) for c, n in columns.items()}
        return sheet(vectors, columns, path, {c: found[n][1] for c, n in columns.items()})


def is_hdf5(content: bytes) -> bool:
    return any(content[k:].startswith(MAGIC) for k in BLOCKS)


def names(content: bytes, path: Path) -> tuple[str, ...]:
    """Return the names of all vectors that the file holds."""

    def listing(file, h5py):
        found: list[str] = []

        def visit(name, item):
            if not isinstance(item, h5py.Dataset) or name.startswith("#"):
                return
            name = name.replace("/", ".")
            inner = item.dtype.names or ()
            shape = item.shape[::-1] if _turned(content) else item.shape
            found.extend([f"{name}.{field}" for field in inner] if inner else listed(name, shape or ()))

        file.visititems(visit)
        return tuple(found)

    return _opened(content, path, listing)


def datasets(content: bytes, path: Path, columns: Iterable[str]) -> dict[str, tuple[np.ndarray, str]]:
    """Return column -> (array, unit as the file writes it or "")."""
    return _opened(content, path, lambda file, h5py: {c: _dataset(c, file, path, h5py, content) for c in columns})


def _opened(content: bytes, path: Path, use):
    h5py = library("h5py", "hdf5", path)
    try:
        with h5py.File(h5py.h5f.open_file_image(content)) as file:
            return use(file, h5py)
    except WorkbenchError:
        raise
    except Exception as e:  # h5py raises whatever broken bytes lead to
        reason = " ".join(str(e).split())[:120] or type(e).__name__
        kind = "MATLAB" if path.suffix.lower() == ".mat" else "HDF5"
        raise WorkbenchError(f"{path}: is no whole {kind} file ({reason}); save or copy it again.") from e


def _turned(content: bytes) -> bool:
    """Whether MATLAB wrote it: it stores arrays with their dimensions in reverse."""
    return content.startswith(b"MATLAB")


def _dataset(column: str, file, path: Path, h5py, content: bytes) -> tuple[np.ndarray, str]:
    """Return a dataset by "group.dataset", "dataset.field" or "dataset(:,3)", and its unit."""
    value, at, field = file, "", ""
    parts, address = addressed(column)
    for name in parts.split("."):
        inner = [k for k in value if not k.startswith("#")] if isinstance(value, h5py.Group) else []
        if isinstance(value, h5py.Dataset) and name in (value.dtype.names or ()):
            field = name
            continue
        if name not in inner and not at:
            raise WorkbenchError(f"{path}: there is no variable '{name}'; {nearest(name, inner)}")
        if name not in inner:
            raise no_field(path, at, name, inner)
        value, at = value[name], f"{at}.{name}" if at else name
    if isinstance(value, h5py.Group):
        raise structure(path, at)
    if value.attrs.get("MATLAB_empty", 0):
        return np.zeros(0), ""
    if value.dtype == h5py.ref_dtype:
        raise many(path, at)
    if value.attrs.get("MATLAB_class", b"") == b"char":  # stored as numbers
        return np.array("text"), ""
    within(value.size * value.dtype.itemsize, path)
    array = value[field] if field else value[()]
    unit = value.attrs.get("units", value.attrs.get("unit", ""))
    unit = unit.decode("utf-8", "replace") if isinstance(unit, bytes) else str(unit)
    return taken(np.transpose(array) if _turned(content) else np.asarray(array), address, column, path), unit


def no_field(path: Path, at: str, name: str, inner: Iterable[str]) -> WorkbenchError:
    if not inner:
        return WorkbenchError(f"{path}: '{at}' is no structure and has no field '{name}'; name the variable alone.")
    return WorkbenchError(f"{path}: '{at}' has no field '{name}'; {nearest(name, inner)}")


def many(path: Path, at: str) -> WorkbenchError:
    return WorkbenchError(
        f"{path}: '{at}' holds cells or not just one structure; save the one that is meant by itself."
    )


def structure(path: Path, at: str) -> WorkbenchError:
    return WorkbenchError(f"{path}: '{at}' holds a structure; name one of its fields, '{at}.field'.")
