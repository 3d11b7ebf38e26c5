"""ASAM MDF 4 files, by asammdf: the named channels only, which must be sampled at the same instants.

A column is a channel's name. The time axis of a group, its master channel, is a column like the others.
"""

import gc
import io
from collections.abc import Mapping
from pathlib import Path
from traceback import clear_frames

import numpy as np

from workbench.errors import WorkbenchError, nearest
from workbench.readers import mdf4
from workbench.readers.sheet import Sheet, library, place, quiet, sheet, vector

FINISHED, UNFINISHED = b"MDF     4", b"UnFinMF 4"
FLAGS = slice(60, 64)  # what its logger left undone


class Mdf:
    """See workbench.readers.Reader."""

    name = "mdf"
    suffixes = (".mf4",)

    def columns(self, content: bytes, path: Path) -> tuple[str, ...]:
        return _opened(content, path, lambda file: tuple(n for n in file.channels_db if n))

    def read(self, content: bytes, path: Path, columns: Mapping[str, str]) -> Sheet:
        return _opened(content, path, lambda file: _read(file, path, columns))


def _opened(content: bytes, path: Path, use):
    """Return what `use` makes of the open file; WorkbenchError where it is no whole MDF 4 file."""
    asammdf = library("asammdf", "mdf", path)
    if not content.startswith((FINISHED, UNFINISHED)):
        raise WorkbenchError(f"{path}: is no MDF 4 file; export the measurement as MDF 4.")
    if content.startswith(UNFINISHED) or content[FLAGS].strip(b"\0"):
        raise WorkbenchError(f"{path}: was not closed by its logger; finalise it with the logger's own tool.")
    fault = mdf4.fault(content)
    if fault:
        raise WorkbenchError(f"{path}: is no whole MDF 4 file ({fault}); copy or export it again.")
    with quiet("asammdf"):
        try:
            with asammdf.MDF(io.BytesIO(content)) as file:
                return use(file)
        except WorkbenchError:
            raise
        except Exception as e:  # asammdf raises whatever broken bytes lead to
            reason = " ".join(str(e).split())[:120] or type(e).__name__
            clear_frames(
                e.__traceback__
            )  # a file that is half made cannot be closed: it goes here, where nobody hears it
            gc.collect()
            raise WorkbenchError(f"{path}: is no whole MDF 4 file ({reason}); copy or export it again.") from None


def _read(file, path: Path, columns: Mapping[str, str]) -> Sheet:
    at = _where(file, path, columns)
    masters = {c for c, (group, index) in at.items() if file.masters_db.get(group) == index}
    vectors, units, times = {}, {}, {}
    for channel in sorted(at, key=lambda c: c in masters):  # so that two channels are compared before a master is
        column, (group, index) = columns[channel], at[channel]
        if channel in masters:
            times[column] = vectors[channel] = vector(file.get_master(group), column, path)
            units[channel] = "s"
            continue
        signal = file.get(group=group, index=index)
        invalid = signal.invalidation_bits
        if invalid is not None and np.any(invalid):
            where = place(path)(int(np.flatnonzero(invalid)[0]))
            raise WorkbenchError(f"{where}: '{column}' is marked as invalid; cut the record there.")
        vectors[channel] = vector(signal.samples, column, path)
        units[channel] = signal.unit or ""
        times[column] = np.asarray(signal.timestamps, dtype=float)
    _at_once(times, path)
    return sheet({c: vectors[c] for c in columns}, columns, path, units)


def _where(file, path: Path, columns: Mapping[str, str]) -> dict[str, tuple[int, int]]:
    """Return channel -> (group, index).

    Every group has a master, and all of them may have one name: the one meant is that of the other channels' group.
    """
    found, masters = {}, {}
    for channel, column in columns.items():
        places = tuple(file.channels_db.get(column, ()))
        if not places:
            names = [n for n in file.channels_db if n]
            raise WorkbenchError(f"{path}: there is no channel '{column}'; {nearest(column, names)}")
        if all(file.masters_db.get(g) == i for g, i in places):
            masters[channel] = places
        elif len(places) > 1:
            raise WorkbenchError(
                f"{path}: channel '{column}' is there {len(places)} times; export one of them under a name of its own."
            )
        else:
            found[channel] = places[0]
    groups = {g for g, _ in found.values()}
    for channel, places in masters.items():
        found[channel] = next((p for p in places if p[0] in groups), places[0])
    return found


def _at_once(times: Mapping[str, np.ndarray], path: Path) -> None:
    """Refuse channels that are sampled at different instants."""
    (first, time), *others = times.items()
    for column, other in others:
        if not np.array_equal(time, other):
            raise WorkbenchError(
                f"{path}: '{first}' ({_rate(time)}) and '{column}' ({_rate(other)}) are not sampled at the same instants; "
                "export them on one raster."
            )


def _rate(time: np.ndarray) -> str:
    span = float(time[-1] - time[0]) if time.size > 1 else 0.0
    return f"{time.size} samples, {(time.size - 1) / span:.6g} Hz" if span > 0 else f"{time.size} samples"
