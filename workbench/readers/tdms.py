"""National Instruments TDMS files, by npTDMS: the named channels only.

A column is "group/channel", or "channel" where only one group has it. Waveforms hold no time channel but a start and a
step: the column "wf_increment" stands for the time axis that these make.
"""

import io
import warnings
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError, nearest
from workbench.readers.sheet import Sheet, library, quiet, sheet, vector

STEP, START, UNIT = "wf_increment", "wf_start_offset", "unit_string"


class Tdms:
    """See workbench.readers.Reader."""

    name = "tdms"
    suffixes = (".tdms",)

    def columns(self, content: bytes, path: Path) -> tuple[str, ...]:
        return _opened(content, path, _columns)

    def read(self, content: bytes, path: Path, columns: Mapping[str, str]) -> Sheet:
        return _opened(content, path, lambda file: _read(file, path, columns))


def _opened(content: bytes, path: Path, use):
    """Return what `use` makes of the open file; WorkbenchError for whatever broken bytes lead to."""
    file_type = library("nptdms", "tdms", path).TdmsFile
    try:
        with (
            quiet("nptdms.reader"),
            quiet("nptdms.tdms_segment"),
            warnings.catch_warnings(),
            file_type.open(io.BytesIO(content)) as file,
        ):
            warnings.simplefilter("ignore")  # of segments that break off: lengths are compared below
            return use(file)
    except WorkbenchError:
        raise
    except Exception as e:  # npTDMS raises whatever broken bytes lead to
        reason = " ".join(str(e).split())[:120] or type(e).__name__
        raise WorkbenchError(f"{path}: is no whole TDMS file ({reason}); copy or export it again.") from e


def _columns(file) -> tuple[str, ...]:
    """Return the channels' names, with their group where two groups have one name, and the time axis of waveforms."""
    found = [(g.name, one.name, STEP in one.properties) for g in file.groups() for one in g.channels()]
    names = [name for _, name, _ in found]
    columns = [name if names.count(name) == 1 else f"{group}/{name}" for group, name, _ in found]
    return (*([STEP] if any(wave for *_, wave in found) and STEP not in names else []), *columns)


def _read(file, path: Path, columns: Mapping[str, str]) -> Sheet:
    known: dict[str, list] = {}
    for group in file.groups():
        for one in group.channels():
            known.setdefault(f"{group.name}/{one.name}", []).append(one)
            known.setdefault(one.name, []).append(one)
    found = {c: _channel(known, column, path) for c, column in columns.items() if column != STEP or STEP in known}
    vectors = {c: vector(one[:], columns[c], path) for c, one in found.items()}
    for channel in columns:
        if channel not in found:
            vectors[channel] = _time(found, path)
    units = {c: str(one.properties.get(UNIT, "")) for c, one in found.items()}
    return sheet({c: vectors[c] for c in columns}, columns, path, units)


def _channel(known: Mapping[str, list], column: str, path: Path):
    here = known.get(column, [])
    if len(here) == 1:
        return here[0]
    if not here:
        raise WorkbenchError(f"{path}: there is no channel '{column}'; {nearest(column, known)}")
    groups = " or ".join(f"'{one.group_name}/{column}'" for one in here)
    raise WorkbenchError(f"{path}: channel '{column}' is there {len(here)} times; name {groups}.")


def _time(found: Mapping[str, object], path: Path) -> np.ndarray:
    """Return start + k step of the waveforms, s; WorkbenchError unless all of them have the same."""
    axes = {(one.properties.get(START, 0.0), one.properties.get(STEP), len(one)) for one in found.values()}
    if len(axes) != 1:
        raise WorkbenchError(
            f"{path}: its waveforms differ in start, '{STEP}' or length; export them on one time axis."
        )
    ((start, step, count),) = axes
    if not isinstance(step, (int, float)) or not step > 0:
        raise WorkbenchError(f"{path}: its channels have no '{STEP}'; name the channel that holds the time.")
    return float(start) + float(step) * np.arange(count)
