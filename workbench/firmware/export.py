"""A firmware written into a folder: C sources, and the table as C, binary, Intel HEX, JSON with its schema, and A2L."""

import re
from os import PathLike
from pathlib import Path

from workbench.errors import WorkbenchError
from workbench.firmware.a2l import a2l
from workbench.firmware.compensation_make import CompensationFirmware
from workbench.firmware.document import SCHEMA, document, text
from workbench.firmware.hexfile import intel_hex
from workbench.firmware.make import Firmware
from workbench.together import write_together

NAME = re.compile(r"[a-z][a-z0-9_]{0,30}")
TABLE = """/*
 * The table of {name}: see workbench.firmware.image for its fields. Generated; no licence is claimed on this file.
 * Plant {plant}; law 0x{law:08X}; CRC-32 0x{crc:08X}.
 */
#ifndef WB_{NAME}_TABLE_H
#define WB_{NAME}_TABLE_H

#include <stdint.h>

static const uint8_t wb_{name}_table_bytes[{size}] = {{
{rows}
}};

static const uint8_t wb_{name}_plant[32] = {{
{digest}
}};

#endif
"""


def _array(data: bytes) -> str:
    """Bytes as a C initialiser, twelve a line."""
    lines = [data[i : i + 12] for i in range(0, len(data), 12)]
    return ",\n".join("    " + ", ".join(f"0x{b:02X}" for b in line) for line in lines)


def _table_header(made: Firmware | CompensationFirmware) -> str:
    """Return the table as a C array, and the digest of the plant that it was made for."""
    data, name = made.image.bytes(), made.source.name
    return TABLE.format(
        name=name, NAME=name.upper(), plant=made.image.plant, law=made.image.law, crc=int.from_bytes(data[-4:], "little"),
        size=len(data), rows=_array(data), digest=_array(bytes.fromhex(made.image.plant)),
    )  # fmt: skip


def files_of(made: Firmware, address: int = 0) -> dict[str, bytes]:
    """Return file name -> content of everything that is exported. address: of the table in flash, for HEX and A2L."""
    name = made.source.name
    if not NAME.fullmatch(name):
        raise WorkbenchError(f"the name of the firmware is '{name}'; write up to 31 of a-z, 0-9 and _, a letter first.")
    if not 0 <= address <= 2**32 - len(made.image.bytes()):
        raise WorkbenchError(f"the table's address is {address}; one of 32 bits is needed.")
    texts = made.files | {
        f"{name}_table.h": _table_header(made),
        f"{name}.hex": intel_hex(made.image.bytes(), address),
        f"{name}.json": text(document(made)),
        f"{name}.schema.json": SCHEMA.read_text(encoding="utf-8"),
        f"{name}.a2l": a2l(made, address),
    }
    found = {n: t.encode() for n, t in texts.items()} | {f"{name}.bin": made.image.bytes()}
    return found | (_beside(made.compensation, address + len(made.image.bytes())) if made.compensation else {})


def _beside(made: CompensationFirmware, address: int) -> dict[str, bytes]:
    """Return the tables of a compensation, behind that of its law; its sources are among the law's."""
    name, data = made.source.name, made.image.bytes()
    texts = {f"{name}_table.h": _table_header(made), f"{name}.hex": intel_hex(data, address)}
    return {n: t.encode() for n, t in texts.items()} | {f"{name}.bin": data}


def export_firmware(made: Firmware, folder: str | PathLike, address: int = 0) -> tuple[Path, ...]:
    """Write a firmware into `folder`, all files or none, and return their paths. Raises WorkbenchError as `files_of`."""
    return write_together(Path(folder), files_of(made, address))
