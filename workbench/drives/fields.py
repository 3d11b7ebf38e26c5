"""Numbers as a drive holds them, checked against its range before they are written and after they are read."""

import struct
from dataclasses import dataclass
from math import isfinite

import numpy as np

from workbench.errors import WorkbenchError, nearest

LICENCE = "No licence is claimed on this file."
# CiA 301 name -> (struct code, lowest, highest)
TYPES = {
    "INTEGER16": ("<h", -(2**15), 2**15 - 1),
    "INTEGER32": ("<i", -(2**31), 2**31 - 1),
    "UNSIGNED16": ("<H", 0, 2**16 - 1),
    "UNSIGNED32": ("<I", 0, 2**32 - 1),
    "REAL32": ("<f", -3.4e38, 3.4e38),
}


@dataclass(frozen=True)
class Range:
    """What one parameter of a drive takes. integer: whole numbers only."""

    name: str
    low: float
    high: float
    integer: bool = False

    def hold(self, value: float, where: str) -> float:
        """Return the value as the drive will hold it (rounded where it counts); WorkbenchError beyond its range."""
        if not (isfinite(value) and self.low <= value <= self.high):
            raise WorkbenchError(
                f"{where}: {self.name} would be {value:.6g}, and the drive takes {self.low:g} to {self.high:g}. Change the "
                "drive's units, or tune softer gains."
            )
        held = float(round(value)) if self.integer else float(np.float32(value))
        if self.integer and value != 0.0 and abs(held / value - 1.0) > COARSE:
            raise WorkbenchError(
                f"{where}: {self.name} would be {value:.6g}, which as the whole number {held:g} is off by more than "
                f"{100 * COARSE:g} %. Give the drive finer units."
            )
        return held


COARSE = 0.02  # a gain's error by rounding that is let through: half or twice it moves a loop's margin as little


def packed(value: float, kind: str, where: str) -> bytes:
    """A value in a CiA 301 type, little-endian."""
    if kind not in TYPES:
        raise WorkbenchError(f"{where}: unknown type '{kind}'; {nearest(kind, TYPES)}")
    code, low, high = TYPES[kind]
    held = Range(where, low, high, kind != "REAL32").hold(value, where)
    return struct.pack(code, held if kind == "REAL32" else int(held))


def unpacked(data: bytes, kind: str, where: str) -> float:
    """The number of some bytes; WorkbenchError where they are not of that length."""
    if kind not in TYPES or len(data) != struct.calcsize(TYPES[kind][0]):
        raise WorkbenchError(f"{where}: {len(data)} bytes are no '{kind}'.")
    return float(struct.unpack(TYPES[kind][0], data)[0])


def number(text: str, where: str) -> float:
    """A finite number; WorkbenchError names the line where there is none."""
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not isfinite(value):
        raise WorkbenchError(f"{where}: '{text}' is no number.")
    return value


def text(value: float) -> str:
    """A number that reads back to the same float32."""
    return str(np.float32(value)) if value != int(value) or abs(value) > 2**24 else str(int(value))
