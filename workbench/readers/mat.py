"""MATLAB files: versions 5 to 7, version 4 by SciPy, and version 7.3, which is HDF5, by h5py.

A column is a variable, a row or a column vector of real numbers; "struct.field" is a field of a structure, "struct(2).field"
that of the second of an array of structures, and "log(:,3)" or "log(3,:)" a column or a row of a matrix.
"""

import io
import re
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError, nearest
from workbench.readers import hdf5, mat5
from workbench.readers.arrays import addressed, listed, taken
from workbench.readers.sheet import Sheet, sheet, vector

ELEMENT = re.compile(r"(.+)\((\d+)\)")  # of an array of structures


class Mat:
    """See workbench.readers.Reader."""

    name = "mat"
    suffixes = (".mat",)

    def columns(self, content: bytes, path: Path) -> tuple[str, ...]:
        if hdf5.is_hdf5(content):
            return hdf5.names(content, path)
        return tuple(name for n, v in _variables(content, path).items() if n for name in _listed(n, v))

    def read(self, content: bytes, path: Path, columns: Mapping[str, str]) -> Sheet:
        if hdf5.is_hdf5(content):
            found = {n: array for n, (array, _) in hdf5.datasets(content, path, columns.values()).items()}
        else:
            variables = _variables(content, path)
            found = {column: _field(column, variables, path) for column in columns.values()}
        vectors = {channel: vector(found[column], column, path) for channel, column in columns.items()}
        return sheet(vectors, columns, path)


def _variables(content: bytes, path: Path) -> dict[str, object]:
    try:
        # The first four bytes are text from version 5 on; before it, one of them is zero.
        return _version_4(content) if 0 in content[:4] else mat5.variables(content, path)
    except WorkbenchError:
        raise
    except Exception as e:  # SciPy raises whatever broken bytes lead to
        reason = " ".join(str(e).split())[:120] or type(e).__name__
        raise WorkbenchError(f"{path}: is no whole MATLAB file ({reason}); save or copy it again.") from e


def _listed(name: str, value: object) -> Iterator[str]:
    """Yield the names of all vectors in a variable."""
    if isinstance(value, dict):
        for field, inner in value.items():
            yield from _listed(f"{name}.{field}", inner)
    elif isinstance(value, list):
        for k, inner in enumerate(value, 1):
            yield from _listed(f"{name}({k})", inner)
    else:
        yield from listed(name, np.shape(value))


def _version_4(content: bytes) -> dict[str, object]:
    import scipy.io

    with warnings.catch_warnings():  # of variables that are there twice
        warnings.simplefilter("ignore")
        return {n: v for n, v in scipy.io.loadmat(io.BytesIO(content)).items() if not n.startswith("__")}


def _field(column: str, variables: Mapping[str, object], path: Path) -> object:
    """Return a variable, a field of a structure, or a column or row of either."""
    name, address = addressed(column)
    value, at = variables, ""
    for part in name.split("."):
        which = ELEMENT.fullmatch(part)
        part = which[1] if which else part
        inner = value if isinstance(value, dict) else {}
        if part not in inner or not part:
            known = filter(None, variables)
            raise (
                hdf5.no_field(path, at, part, inner)
                if at
                else WorkbenchError(f"{path}: there is no variable '{part}'; {nearest(part, known)}")
            )
        value, at = inner[part], f"{at}.{part}" if at else part
        if which and isinstance(value, list) and 0 < int(which[2]) <= len(value):
            value, at = value[int(which[2]) - 1], f"{at}({which[2]})"
        if isinstance(value, list):
            raise hdf5.many(path, at)
    if isinstance(value, dict) and value:
        raise hdf5.structure(path, at)
    return taken(np.asarray(value), address, column, path)
