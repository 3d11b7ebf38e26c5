"""gains.bin: the gain table for a drive's flash, little-endian throughout.

| offset | type | what |
|---|---|---|
| 0 | char[8] | magic "WBGAINS" and a zero |
| 8 | uint32 | format version, 1 |
| 12 | uint32 | header length H in bytes: where the payload begins, a multiple of 8 |
| 16 | uint32 | number of knots m |
| 20 | uint32 | number of rows n: 5, or 9 with gains in the drive's units |
| 24 | uint32 | knots an octave, a power of two |
| 28 | uint32 | rule: 0 following, 1 frozen, 2 error, 3 closing |
| 32 | float32 | reversal threshold, rad or m |
| 36 | float32 | sample time, s |
| 40 | uint32 | CRC-32 of the payload |
| 44 | uint32 | length L of the text in bytes |
| 48 | uint8[32] | sha256 of the plant |
| 80 | char[L] | UTF-8, one "key value" a line: versions, units, factors, the plant's lines ("plant key value") |
| 80 + L | zeros | up to H - 4 |
| H - 4 | uint32 | CRC-32 of the bytes 0 ... H - 5 |
| H | float32[n][m] | payload: the rows in the order of `workbench.schedule.tables` |

Both CRCs are CRC-32 of IEEE 802.3 (reflected, polynomial 0xEDB88320). Nothing follows the payload.
"""

import struct
import zlib
from os import PathLike
from pathlib import Path

import numpy as np

from workbench.control import RULES
from workbench.errors import WorkbenchError
from workbench.exporting.document import FORMAT_VERSION
from workbench.readers.files import regular
from workbench.schedule.tables import DRIVE_ROWS, ROWS, Tables

MAGIC = b"WBGAINS\0"
FIXED = struct.Struct("<8s6I2f2I32s")
CRC = struct.Struct("<I")
NAMES = (ROWS, ROWS + DRIVE_ROWS)


def pack(contents: dict, held: Tables) -> bytes:
    """Return gains.bin of a document and its tables."""
    said = _facts(contents).encode()
    length = -(-(FIXED.size + len(said) + CRC.size) // 8) * 8
    fixed = FIXED.pack(
        MAGIC,
        FORMAT_VERSION,
        length,
        held.count,
        len(held.rows),
        held.per_octave,
        RULES.index(contents["rule"]),
        contents["reversal"],
        contents["sample_time"],
        held.crc,
        len(said),
        bytes.fromhex(contents["plant"]["digest"]),
    )
    header = (fixed + said).ljust(length - CRC.size, b"\0")
    return header + CRC.pack(zlib.crc32(header)) + held.payload


def _facts(contents: dict) -> str:
    """Return the text block: "key value" lines of everything that has no place of its own."""
    lines = [f"{key} {contents[key]}" for key in ("project_version", "name")]
    lines += [
        f"{key} {contents[key]!r}" for key in ("reversal", "sample_time", "interpolation_error") if key in contents
    ]
    lines += [f"velocity_filter {contents['velocity_filter']!r}"] if "velocity_filter" in contents else []
    lines += [f"notch.{key} {value!r}" for key, value in contents.get("notch", {}).items()]
    lines += [f"unit.{key} {unit}" for key, unit in contents["units"].items()]
    for key, entry in contents.get("drive", {}).items():
        lines += [f"drive.{key}.unit {entry['unit']}", f"drive.{key}.per_si {entry['per_si']!r}"]
    return "\n".join(lines + [f"plant {line}" for line in contents["plant"]["lines"]]) + "\n"


def load_binary(path: str | PathLike) -> dict:
    """Return what gains.bin at `path` holds: the header's fields, "text", and "tables" (Tables).

    Raises WorkbenchError, naming file and field, where the magic, the version, a length or either CRC-32 is wrong; every
    single flipped bit of the file is found.
    """
    try:
        data = regular(Path(path)).read_bytes()
    except OSError as error:
        raise WorkbenchError(f"{path} cannot be read ({error.strerror}); name a gain table, gains.bin.") from error

    def insist(good: bool, sentence: str):
        if not good:
            raise WorkbenchError(f"{path}: {sentence}; export the table again.")

    insist(len(data) >= FIXED.size + CRC.size and data[:8] == MAGIC, "magic: this is not a binary gain table")
    _, version, length, m, n, octave, rule, reversal, period, crc, size, sha = FIXED.unpack_from(data)
    insist(version == FORMAT_VERSION, f"format version is {version}, and {FORMAT_VERSION} is read here")
    insist(
        FIXED.size + size + CRC.size <= length <= len(data), f"header length is {length}, which does not fit the file"
    )
    (own,) = CRC.unpack_from(data, length - CRC.size)
    insist(own == zlib.crc32(data[: length - CRC.size]), "the header's CRC-32 is wrong: the file is damaged")
    insist(n in map(len, NAMES), f"number of rows is {n}; 5 or 9 are known")
    insist(rule < len(RULES), f"rule is {rule}; 0 (following), 1 (frozen), 2 (error) and 3 (closing) are known")
    insist(len(data) == length + 4 * m * n, f"the file has {len(data)} bytes, and {length + 4 * m * n} are declared")
    insist(crc == zlib.crc32(data[length:]), "the payload's CRC-32 is wrong: the file is damaged")
    rows = np.frombuffer(data, "<f4", offset=length).astype(np.float32).reshape(n, m)
    names = next(names for names in NAMES if len(names) == n)
    return {
        "format_version": version,
        "rule": RULES[rule],
        "reversal": reversal,
        "sample_time": period,
        "crc32": crc,
        "digest": sha.hex(),
        "text": data[FIXED.size : FIXED.size + size].decode(),
        "tables": Tables(octave, dict(zip(names, rows, strict=True))),
    }
