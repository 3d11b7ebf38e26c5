"""The numbers of a controller that is no table, for firmware: a C header, a JSON document and a binary, under one CRC-32.

The binary is little-endian: magic "WBNUMBER", uint32 format version, uint32 count n, float32[n] in the order of the document,
uint8[32] the sha256 of the plant, uint32 CRC-32 of everything before it.
"""

import json
import struct
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError
from workbench.exporting.header import harmless
from workbench.firmware.naming import slug
from workbench.plant import Plant
from workbench.together import write_together

MAGIC, VERSION = b"WBNUMBER", 1
HEAD = """/* {title}: the numbers of a controller, SI. Sample time {sample_time:.9g} s.
{law}
 * Plant {digest}:
{lines}
 */
#ifndef WB_{NAME}_H
#define WB_{NAME}_H

{numbers}
#define WB_{NAME}_SAMPLE_TIME {sample} /* s */
#define WB_{NAME}_CRC 0x{crc:08X}u /* of the float32 numbers, little-endian, in this order */

#endif
"""


def export_numbers(
    title: str, law: str, numbers: Mapping[str, tuple[float, str]], sample_time: float, plant: Plant, folder: Path
) -> tuple[Path, ...]:
    """Write `<slug of title>.h`, `.json` and `.bin` into a folder, all or none; return their paths.

    law: what the numbers mean, in words. numbers: name -> (value, unit), SI. plant: that they were tuned for.
    WorkbenchError where float32 does not hold a number, or a folder cannot be written.
    """
    name = slug(title)
    values = np.array([v for v, _ in numbers.values()], dtype=float)
    if not (np.isfinite(values) & (np.abs(values) <= np.finfo(np.float32).max)).all():
        raise WorkbenchError(f"'{title}': a number is not finite in float32, which the header holds.")
    held = values.astype("<f4").tobytes()
    crc = zlib.crc32(held)
    document = {
        "format": "servo-workbench numbers",
        "format_version": VERSION,
        "controller": title,
        "law": law,
        "sample_time": sample_time,
        "numbers": {n: {"value": v, "unit": u} for n, (v, u) in numbers.items()},
        "crc32": f"{crc:08x}",
        "plant": {"digest": plant.digest, "lines": list(plant.digest_lines())},
    }
    body = MAGIC + struct.pack("<2I", VERSION, values.size) + held + bytes.fromhex(plant.digest)
    files = {
        f"{name}.h": _header(name, title, law, numbers, sample_time, plant, crc).encode(),
        f"{name}.json": (json.dumps(document, indent=1) + "\n").encode(),
        f"{name}.bin": body + struct.pack("<I", zlib.crc32(body)),
    }
    return write_together(Path(folder), files)


def _header(
    name: str, title: str, law: str, numbers: Mapping[str, tuple[float, str]], sample_time: float, plant: Plant, crc: int
) -> str:  # fmt: skip
    """Return the C header of numbers. name: that of its constants."""
    rows = (
        f"#define WB_{name.upper()}_{slug(n).upper()} {float(np.float32(v))!r}f /* {v:.9g} {u} */"
        for n, (v, u) in numbers.items()
    )
    return HEAD.format(
        title=harmless(title),
        law=f" * {harmless(law)}",
        digest=plant.digest,
        lines="\n".join(f" *   {harmless(line)}" for line in plant.digest_lines()),
        NAME=name.upper(),
        numbers="\n".join(rows),
        sample=f"{float(np.float32(sample_time))!r}f",
        sample_time=sample_time,
        crc=crc,
    )


def load_numbers(path: Path) -> np.ndarray:
    """Return the numbers of a binary, float32; WorkbenchError where it is not whole."""
    data = Path(path).read_bytes()
    if data[:8] != MAGIC or zlib.crc32(data[:-4]) != struct.unpack("<I", data[-4:])[0]:
        raise WorkbenchError(f"{path}: these are no numbers of a controller, or they are damaged (CRC-32).")
    (count,) = struct.unpack("<I", data[12:16])
    return np.frombuffer(data, "<f4", count, 16)
