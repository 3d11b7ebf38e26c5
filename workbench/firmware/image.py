"""The table that a firmware loads: one block of bytes, little-endian throughout, in words of four bytes.

| offset | type | what |
|---|---|---|
| 0 | char[8] | magic "WBTABLE" and a zero |
| 8 | uint32 | byte order: 0x01020304 |
| 12 | uint32 | format version, 1 |
| 16 | uint32 | length of the whole in bytes |
| 20 | uint32 | arithmetic: 1 float32, 2 fixed point |
| 24 | uint32 | law: CRC-32 over its instructions, its constants' formulas and, in fixed point, its scales |
| 28 | uint32 | number n of constants |
| 32 | uint32 | number c of rows over the knots: gain and slope of each column; in fixed point the gain alone |
| 36 | uint32 | number m of knots; 0 for a law without a table of gains, c is 0 then |
| 40 | uint32 | knots an octave, a power of two up to 2048 |
| 44 | float32 | sample time, s |
| 48 | float32 | one encoder count, rad or m |
| 52 | float32 | largest command, N*m or N |
| 56 | uint32 | bits of the encoder, 2 to 32: where its reading wraps |
| 60 | uint32 | jump: the largest plausible way between two samples, counts |
| 64 | uint32 | verdict: 0 not judged, 1 the study's requirements are met, 2 they are not; and of the trace, 4 a cause, 8 nothing missing, 12 unknown |
| 68 | uint32 | motion: 0 rotary (rad, N*m), 1 linear (m, N) |
| 72 | uint8[32] | sha256 of the plant that the gains were tuned on |
| 104 | word[n] | constants, positions counted: float32, or int32 of the scales that the law's header names |
| 104 + 4n | float32[m] | knots, consecutive on 2^e (1 + j/k), rad or m (rad/s or m/s for a feed-forward over speed) |
| 104 + 4(n + m) | word[c][m] | rows: float32, or int32 that hold 19 bits |
| length - 4 | uint32 | CRC-32 (IEEE 802.3, reflected, polynomial 0xEDB88320) of all bytes before |
"""

import struct
import zlib
from dataclasses import dataclass

import numpy as np

from workbench.errors import WorkbenchError

MAGIC, ORDER, VERSION = b"WBTABLE\0", 0x01020304, 1
HEAD = struct.Struct("<8s9I3f4I32s")
FLOAT32, FIXED = 1, 2
ARITHMETICS = {"float32": FLOAT32, "fixed": FIXED}
JUDGED, TRACED = (
    ("not judged", "requirements met", "requirements not met"),
    ("not traced", "cause", "nothing_missing", "unknown"),
)
VERDICTS = tuple(
    f"{JUDGED[v % 4]}; trace: {TRACED[v // 4]}" if v % 4 < len(JUDGED) else "" for v in range(4 * len(TRACED))
)  # by the number of the field


def verdict_of(passed: bool | None, traced: str = "") -> int:
    """Return the verdict's field. passed: whether the study's requirements were met; traced: the trace's verdict, or ""."""
    return (0 if passed is None else 1 if passed else 2) + 4 * (TRACED.index(traced) if traced in TRACED else 0)


FIELDS = (
    "magic", "order", "version", "length", "arithmetic", "law", "constants", "rows", "knots", "per_octave",
    "sample_time", "count", "limit", "bits", "jump", "verdict", "motion", "plant",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Image:
    """The table's fields. constants (n,), rows (c, m): float32, or int32 in fixed point. knots (m,): float32. plant: hex."""

    arithmetic: int
    law: int
    per_octave: int
    sample_time: float
    count: float
    limit: float
    bits: int
    jump: int
    verdict: int
    motion: int
    plant: str
    constants: np.ndarray
    knots: np.ndarray
    rows: np.ndarray

    @property
    def word(self) -> str:
        return "<f4" if self.arithmetic == FLOAT32 else "<i4"

    def bytes(self) -> bytes:
        """The table as the module says."""
        body = self.constants.astype(self.word).tobytes() + self.knots.astype("<f4").tobytes()
        body += self.rows.astype(self.word).tobytes()
        length = HEAD.size + len(body) + 4
        head = HEAD.pack(
            MAGIC, ORDER, VERSION, length, self.arithmetic, self.law, self.constants.size, len(self.rows),
            self.knots.size, self.per_octave, self.sample_time, self.count, self.limit, self.bits, self.jump,
            self.verdict, self.motion, bytes.fromhex(self.plant),
        )  # fmt: skip
        return head + body + struct.pack("<I", zlib.crc32(head + body))


def read(data: bytes, where: str = "the table") -> Image:
    """Return the fields of a table's bytes; WorkbenchError, naming what is wrong, unless they are whole."""

    def insist(good: bool, sentence: str) -> None:
        if not good:
            raise WorkbenchError(f"{where}: {sentence}; export the table again.")

    insist(len(data) >= HEAD.size + 4, f"{len(data)} bytes are fewer than any table has")
    f = dict(zip(FIELDS, HEAD.unpack_from(data), strict=True))
    insist(f["magic"] == MAGIC, "the magic is wrong: this is no table of a firmware")
    insist(f["order"] == ORDER, f"the byte order is 0x{f['order']:08X}, and 0x{ORDER:08X} is read here")
    insist(f["version"] == VERSION, f"the format version is {f['version']}, and {VERSION} is read here")
    insist(f["length"] == len(data), f"it has {len(data)} bytes, and says {f['length']}")
    insist(zlib.crc32(data[:-4]) == struct.unpack("<I", data[-4:])[0], "the CRC-32 is wrong: it is damaged")
    n, c, m = f["constants"], f["rows"], f["knots"]
    insist(len(data) == HEAD.size + 4 * (n + m + c * m) + 4, "its numbers do not fill it")
    insist(f["arithmetic"] in (FLOAT32, FIXED), f"arithmetic {f['arithmetic']} is unknown")
    word = "<f4" if f["arithmetic"] == FLOAT32 else "<i4"
    at = HEAD.size
    values = np.frombuffer(data, word, n, at)
    knots = np.frombuffer(data, "<f4", m, at + 4 * n)
    rows = np.frombuffer(data, word, c * m, at + 4 * (n + m)).reshape(c, m)
    kept = {k: f[k] for k in FIELDS[4:6] + FIELDS[9:-1]}
    return Image(**kept, plant=f["plant"].hex(), constants=values, knots=knots, rows=rows)
