"""What a reader returns, and what the binary formats share: the same checks, the same sentences."""

import importlib
import logging
import sys
from collections.abc import Callable, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType, ModuleType

import numpy as np

from workbench.errors import WorkbenchError
from workbench.readers import instants
from workbench.readers.arrays import listed


@dataclass(frozen=True, eq=False)
class Sheet:
    """channels: channel -> (n,) float array of the caller's own, all of one length and finite, in the file's own units.

    place: sample number from 0 -> where it stands, for a sentence ("moves.csv, row 12"). units: channel -> its unit as
    the file writes it, where the file does. notes: what was done to the samples on the way in, a sentence each.
    """

    channels: Mapping[str, np.ndarray]
    place: Callable[[int], str]
    units: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __post_init__(self):
        object.__setattr__(self, "units", MappingProxyType({c: u for c, u in self.units.items() if u}))


def library(module: str, extra: str, path: Path) -> ModuleType:
    """Import what reads a format; WorkbenchError naming the extra where it is not installed."""
    try:
        return importlib.import_module(module)
    except ImportError as e:
        kind = "a .mat file of version 7.3" if path.suffix.lower() == ".mat" else f"{path.suffix.lower()} files"
        raise WorkbenchError(
            f"{path}: reading {kind} needs the extra '{extra}': pip install 'servo-workbench[{extra}]', or in a checkout "
            f"pip install -e '.[{extra}]'."
        ) from e


@contextmanager
def quiet(logger: str):
    """Keep a library from writing on stderr of broken bytes: what matters is refused with a sentence."""
    log = logging.getLogger(logger)
    was, log.disabled = log.disabled, True
    hook, sys.unraisablehook = sys.unraisablehook, lambda _: None
    try:
        yield
    finally:
        log.disabled, sys.unraisablehook = was, hook


def place(path: Path) -> Callable[[int], str]:
    """Return the place of samples in a file that has no rows: they are counted from 1."""
    return lambda sample: f"{path}, sample {sample + 1}"


def vector(values: object, column: str, path: Path) -> np.ndarray:
    """Return a row, a column or a plain vector of real numbers as (n,) floats; WorkbenchError for anything else.

    Dates and times of day become seconds.
    """
    array = np.asarray(values)
    if array.dtype.kind in "mM":
        array = instants.since_1970(array)
    elif array.dtype.kind in "UTO" and array.size and instants.written(array.flat[0]):
        array = _dated(array.ravel(), column, path)
    if array.dtype.kind not in "fiub":
        kinds = {"c": "complex numbers", "U": "text", "S": "text", "T": "text", "V": "a structure"}
        kind = kinds.get(array.dtype.kind, "no plain numbers")
        raise WorkbenchError(f"{path}: '{column}' holds {kind}; save it as a vector of real numbers.")
    if array.size != max(array.shape, default=1):
        shape = " x ".join(map(str, array.shape))
        names = listed(column, array.shape)
        mend = f"name one of them, '{names[0]}' to '{names[-1]}'" if len(names) > 1 else "save each column by itself"
        raise WorkbenchError(f"{path}: '{column}' is {shape}; {mend}.")
    return np.array(array.ravel(), dtype=float)


def _dated(cells: np.ndarray, column: str, path: Path) -> np.ndarray:
    try:
        return instants.seconds(cells.tolist())
    except (ValueError, TypeError, AttributeError) as e:
        raise WorkbenchError(f"{path}: '{column}' holds text that is no date; save it as numbers of seconds.") from e


def sheet(vectors: Mapping[str, np.ndarray], columns: Mapping[str, str], path: Path, units=None) -> Sheet:
    """Return channel -> (n,) array as a Sheet; WorkbenchError unless all are of one length, not empty, and finite."""
    where = place(path)
    sizes = {columns[channel]: v.size for channel, v in vectors.items()}
    (first, size), *others = sizes.items()
    for column, other in others:
        if other != size:
            raise WorkbenchError(
                f"{path}: '{column}' has {other} samples and '{first}' {size}; save all of one record at one rate."
            )
    if not size:
        raise WorkbenchError(f"{path}: '{first}' holds no samples; export the record again.")
    for channel, v in vectors.items():
        bad = np.flatnonzero(~np.isfinite(v))
        if bad.size:
            raise WorkbenchError(
                f"{where(int(bad[0]))}: '{columns[channel]}' holds '{v[bad[0]]}'; a finite number is needed, so mend the "
                "sample or cut the record there."
            )
    return Sheet(vectors, where, units or {})
