"""WPILib data logs, after WPILib's "WPILib Data Log File Format Specification, Version 1.0" (allwpilib, datalog.adoc).

Twelve bytes ("WPILOG", version, size of a further header), then records: a byte that says how many bytes its entry, size and
time have, these three, and the payload. Entry 0 starts the others with their names and types. A column is an entry that
holds numbers, or "entry[2]" of one that holds lists; "time" stands for the instants, in microseconds in the file.
"""

import struct
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError
from workbench.readers.held import Held, Whole

MAGIC, START = b"WPILOG", 0
SCALARS = {"boolean": "?", "int64": "<i8", "float": "<f4", "double": "<f8"}
LISTS = {"int64[]": "<i8", "float[]": "<f4", "double[]": "<f8"}


class Wpilog(Whole):
    """See workbench.readers.Reader."""

    name = "wpilog"
    suffixes = (".wpilog",)

    def held(self, content: bytes, path: Path) -> Mapping[str, Held]:
        try:
            entries, rows = _parted(content)
            found = {n: h for key, (name, kind) in entries.items() for n, h in _columns(name, kind, rows.get(key, []))}
        except (struct.error, ValueError, IndexError, UnicodeDecodeError) as e:
            raise WorkbenchError(f"{path}: is no whole WPILib data log ({e}); copy it again.") from e
        if not found:
            raise WorkbenchError(f"{path}: none of its entries holds numbers; log the axis's signals.")
        return found


def _parted(content: bytes) -> tuple[dict, dict]:
    """Return entry -> (name, type), and entry -> list of (time in us, payload)."""
    if not content.startswith(MAGIC) or len(content) < 12:
        raise ValueError("it does not begin as one")
    entries: dict[int, tuple[str, str]] = {}
    rows: dict[int, list[tuple[int, bytes]]] = {}
    for entry, time, payload in _records(content, 12 + int.from_bytes(content[8:12], "little")):
        if entry:
            rows.setdefault(entry, []).append((time, payload))
        elif payload[0] == START:
            texts = list(_texts(payload[5:]))
            entries[int.from_bytes(payload[1:5], "little")] = (texts[0], texts[1])
    return entries, rows


def _records(content: bytes, at: int) -> Iterator[tuple[int, int, bytes]]:
    while at < len(content):
        widths = content[at]
        sizes = ((widths & 3) + 1, (widths >> 2 & 3) + 1, (widths >> 4 & 7) + 1)
        at, numbers = at + 1, []
        for size in sizes:
            numbers.append(int.from_bytes(content[at : at + size], "little"))
            at += size
        entry, length, time = numbers
        if at + length > len(content):
            return  # a robot that is switched off leaves its last record half written
        yield entry, time, content[at : at + length]
        at += length


def _texts(payload: bytes) -> Iterator[str]:
    at = 0
    while at + 4 <= len(payload):
        length = int.from_bytes(payload[at : at + 4], "little")
        yield payload[at + 4 : at + 4 + length].decode()
        at += 4 + length


def _columns(name: str, kind: str, rows: list) -> Iterator[tuple[str, Held]]:
    """Yield the columns of an entry; of two values at one instant the later stands."""
    rows = sorted(dict(rows).items())
    name = name.removeprefix("NT:").strip("/")
    clock = np.array([time for time, _ in rows]) / 1e6
    if kind in SCALARS and len(rows) > 1:
        yield name, Held(np.frombuffer(b"".join(p for _, p in rows), SCALARS[kind]), "", clock)
    elif kind in LISTS and len(rows) > 1 and len({len(p) for _, p in rows}) == 1:
        values = np.frombuffer(b"".join(p for _, p in rows), LISTS[kind]).reshape(len(rows), -1)
        for k in range(values.shape[1]):
            yield f"{name}[{k}]", Held(values[:, k], "", clock)
