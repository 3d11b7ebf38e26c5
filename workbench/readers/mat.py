"""MATLAB files: versions 5 to 7, version 4 by SciPy, and version 7.3, which is HDF5, by h5py.

A column is a variable, a row or a column vector of real numbers; "struct.field" is a field of a structure.
"""

import io
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError, nearest
from workbench.readers import mat5
from workbench.readers.sheet import Sheet, library, sheet, vector

HDF5 = b"\x89HDF\r\n\x1a\n"
BLOCKS = (0, 512)  # where HDF5 may begin: MATLAB writes its own 512 bytes before it


class Mat:
    """See workbench.readers.Reader."""

    name = "mat"
    suffixes = (".mat",)

    def columns(self, content: bytes, path: Path) -> tuple[str, ...]:
        if any(content[k:].startswith(HDF5) for k in BLOCKS):
            return _names_73(content, path)
        variables = _variables(content, path)
        inner = {n: v if isinstance(v, dict) else {} for n, v in variables.items() if n}
        return tuple(f"{n}.{field}" if field else n for n, fields in inner.items() for field in fields or [""])

    def read(self, content: bytes, path: Path, columns: Mapping[str, str]) -> Sheet:
        if any(content[k:].startswith(HDF5) for k in BLOCKS):
            found = _version_73(content, path, columns.values())
        else:
            variables = _variables(content, path)
            found = {column: _field(column, variables, path) for column in columns.values()}
        vectors = {channel: vector(found[column], column, path) for channel, column in columns.items()}
        return sheet(vectors, columns, path)


def _variables(content: bytes, path: Path) -> dict[str, object]:
    try:
        # The first four bytes are text from version 5 on; before it, one of them is zero.
        return _version_4(content) if 0 in content[:4] else mat5.variables(content)
    except Exception as e:  # SciPy raises whatever broken bytes lead to
        raise _broken(path, e) from e


def _names_73(content: bytes, path: Path) -> tuple[str, ...]:
    """Return the names of all datasets, fields of structures by "struct.field"."""
    h5py = library("h5py", "hdf5", path)
    found: list[str] = []
    try:
        with h5py.File(h5py.h5f.open_file_image(content)) as file:
            file.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) else None)
    except Exception as e:  # h5py raises whatever broken bytes lead to
        raise _broken(path, e) from e
    return tuple(name.replace("/", ".") for name in found if not name.startswith("#"))


def _version_4(content: bytes) -> dict[str, object]:
    import scipy.io

    with warnings.catch_warnings():  # of variables that are there twice
        warnings.simplefilter("ignore")
        return {n: v for n, v in scipy.io.loadmat(io.BytesIO(content)).items() if not n.startswith("__")}


def _field(column: str, variables: Mapping[str, object], path: Path) -> object:
    """Return a variable, or a field of a structure."""
    root, *fields = column.split(".")
    if root not in variables:
        raise WorkbenchError(f"{path}: there is no variable '{root}'; {nearest(root, filter(None, variables))}")
    value, at = variables[root], root
    for name in (*fields, None):
        if isinstance(value, list):
            raise _many(path, at)
        inner = value if isinstance(value, dict) else {}
        if name is None:
            if inner:
                raise _structure(path, at)
            return value
        if name not in inner:
            raise _no_field(path, at, name, inner)
        value, at = inner[name], f"{at}.{name}"


def _version_73(content: bytes, path: Path, columns: Iterable[str]) -> dict[str, np.ndarray]:
    h5py = library("h5py", "hdf5", path)
    try:
        with h5py.File(h5py.h5f.open_file_image(content)) as file:
            return {column: _dataset(column, file, path, h5py) for column in columns}
    except WorkbenchError:
        raise
    except Exception as e:  # h5py raises whatever broken bytes lead to
        raise _broken(path, e) from e


def _dataset(column: str, file, path: Path, h5py) -> np.ndarray:
    """Return a dataset by "variable" or "struct.field": structures are groups."""
    value, at = file, ""
    for name in column.split("."):
        inner = [k for k in value if not k.startswith("#")] if isinstance(value, h5py.Group) else []
        if name not in inner and not at:
            raise WorkbenchError(f"{path}: there is no variable '{name}'; {nearest(name, inner)}")
        if name not in inner:
            raise _no_field(path, at, name, inner)
        value, at = value[name], f"{at}.{name}" if at else name
    if isinstance(value, h5py.Group):
        raise _structure(path, at)
    if value.attrs.get("MATLAB_empty", 0):
        return np.zeros(0)
    if value.dtype == h5py.ref_dtype:
        raise _many(path, at)
    text = value.attrs.get("MATLAB_class", b"") == b"char"  # stored as numbers
    return np.array("text") if text else value[()]


def _no_field(path: Path, at: str, name: str, inner: Iterable[str]) -> WorkbenchError:
    if not inner:
        return WorkbenchError(f"{path}: '{at}' is no structure and has no field '{name}'; name the variable alone.")
    return WorkbenchError(f"{path}: '{at}' has no field '{name}'; {nearest(name, inner)}")


def _many(path: Path, at: str) -> WorkbenchError:
    return WorkbenchError(
        f"{path}: '{at}' holds cells or not just one structure; save the one that is meant by itself."
    )


def _structure(path: Path, at: str) -> WorkbenchError:
    return WorkbenchError(f"{path}: '{at}' holds a structure; name one of its fields, '{at}.field'.")


def _broken(path: Path, error: Exception) -> WorkbenchError:
    reason = " ".join(str(error).split())[:120] or type(error).__name__
    return WorkbenchError(f"{path}: is no whole MATLAB file ({reason}); save or copy it again.")
