"""Columns and rows of matrices: "log(:,3)" and "log(2,:)", counted from 1, as MATLAB writes them."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError

ADDRESS = re.compile(r"(.*)\((?:(:),(\d+)|(\d+),(:))\)")
MOST = 256  # vectors of one matrix that are listed: a log has fewer, a picture more


def addressed(column: str) -> tuple[str, tuple[int, int] | None]:
    """Return (name, None), or of "log(:,3)" its name and (dimension along which is counted, number from 0)."""
    found = ADDRESS.fullmatch(column)
    if not found:
        return column, None
    return found[1], (1, int(found[3]) - 1) if found[2] else (0, int(found[4]) - 1)


def listed(name: str, shape: Sequence[int]) -> tuple[str, ...]:
    """Return the names of a variable's vectors: its own, or those of a matrix along its longer dimension."""
    if len(shape) != 2 or 1 in shape or 0 in shape:
        return (name,)
    rows, columns = shape
    count = min(rows, columns)
    form = "{}(:,{})" if rows >= columns else "{}({},:)"
    return tuple(form.format(name, k + 1) for k in range(count)) if count <= MOST else (name,)


def taken(array: np.ndarray, address: tuple[int, int] | None, column: str, path: Path) -> np.ndarray:
    """Return the row or column of a matrix, or the array where there is no address; WorkbenchError beside its shape."""
    if address is None:
        return array
    name, shape = addressed(column)[0], np.shape(array)
    dimension, number = address
    if len(shape) != 2 or not 0 <= number < shape[dimension]:
        of = " x ".join(map(str, shape)) or "one number"
        names = listed(name, shape)
        raise WorkbenchError(
            f"{path}: there is no '{column}', since '{name}' is {of}; known: {names[0]} to {names[-1]}."
            if len(names) > 1
            else f"{path}: there is no '{column}', since '{name}' is {of}; name it alone."
        )
    return np.take(array, number, axis=dimension)
