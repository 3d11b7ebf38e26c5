"""gains.h: the gain table as C99, written from the template gains.h.in; what it computes is the firmware's own C."""

from pathlib import Path
from string import Template

import numpy as np

from workbench.exporting.document import FORMAT_VERSION
from workbench.firmware.shared import helpers, interpolated, scheduling
from workbench.schedule.tables import Tables

TEMPLATE = Path(__file__).with_name("gains.h.in")
HEAD = """/* What a look-up knows of its table: the last knot's number, the bits of a float below its segment, the first knot's above. */
typedef struct {
    uint32_t last;
    uint32_t shift;
    uint32_t first;
} wb_table_head;
"""
DRIVE_TEMPLATE = Path(__file__).with_name("gains_drive.h.in")


def header(contents: dict, held: Tables) -> bytes:
    """Return the C header of a document and its tables; the template says what is in it."""
    rows, unit, units = held.rows, contents["units"], _units_of(contents)
    p = f"wb_{contents['name']}"
    fields = {
        "p": p,
        "P": p.upper(),
        "name": contents["name"],
        "format_version": FORMAT_VERSION,
        "project_version": contents["project_version"],
        "count": held.count,
        "last": held.count - 1,
        "per_octave": held.per_octave,
        "shift": held.shift,
        "first": held.first,
        "rule": contents["rule"],
        "frozen": int(contents["rule"] == "frozen"),
        "error": int(contents["rule"] == "error"),
        "closing": int(contents["rule"] == "closing"),
        "reversal": _literal(contents["reversal"]),
        "reversal_said": f"{contents['reversal']:.9g}",
        "sample_time": _literal(contents["sample_time"]),
        "sample_time_said": f"{contents['sample_time']:.9g}",
        "crc": f"0x{held.crc:08X}",
        "digest": contents["plant"]["digest"],
        "lines": "\n".join(f" *   {harmless(line)}" for line in contents["plant"]["lines"]),
        "x": unit["knots"],
        "kp_unit": unit["kp"],
        "kd_unit": unit["kd"],
        "tables": "\n\n".join(table(f"{p}_{key}", units[key], row, p.upper()) for key, row in rows.items()),
        **_behind(contents, p.upper()),
        "helpers": HEAD + "\n" + helpers(),
        **scheduling(contents["rule"], p, unit["knots"]),
        **{f"{k}_there": interpolated(f"{p}_{k}[i]", f"{p}_{k}_slope[i]") for k in rows if f"{k}_slope" in rows},
        "checks": "\n".join(f"    crc = wb_crc32_table(crc, {p}_{key}, {p.upper()}_COUNT);" for key in rows),
    }
    fields["drive"] = _drive_part(contents, fields) if "drive" in contents else ""
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(fields).encode()


def _units_of(contents: dict) -> dict[str, str]:
    """Return the unit of each row of the tables."""
    unit = contents["units"]
    units = {"knots": unit["knots"]}
    for key in ("kp", "kd"):
        units |= {key: unit[key], f"{key}_slope": f"({unit[key]})/{unit['knots']}"}
        if "drive" in contents:
            drive = contents["drive"][key]["unit"]
            units |= {f"{key}_drive": drive, f"{key}_drive_slope": f"({drive})/{unit['knots']}"}
    return units


def _behind(contents: dict, name: str) -> dict[str, str]:
    """Return what a header says of the velocity filter and the notch that the gains were tuned with, and their constants."""
    said, defined, notch = "", "", contents.get("notch")
    if "velocity_filter" in contents:
        said += f"\n *   velocity: the difference of two positions, low-passed with {contents['velocity_filter']:.9g} s"
        defined += f"#define {name}_VELOCITY_FILTER {_literal(contents['velocity_filter'])} /**< [s] */\n"
    if notch:
        said += "\n *   behind it, without which the gains keep no margin: (B0 + B1/z + B2/z^2)/(1 + B1/z + A2/z^2), NOTCH_B0 ... NOTCH_A2"
        defined += "".join(f"#define {name}_NOTCH_{k.upper()} {_literal(v)}\n" for k, v in notch.items())
    return {"behind": said, "behind_defined": defined}


def _drive_part(contents: dict, fields: dict) -> str:
    """Return what a header with gains in the drive's units holds beyond the others."""
    drive = contents["drive"]
    own = {f"{key}_drive_unit": drive[key]["unit"] for key in drive}
    own |= {f"{key}_per_si": f"{drive[key]['per_si']:.9g}" for key in drive}
    return Template(DRIVE_TEMPLATE.read_text(encoding="utf-8")).substitute(fields | own)


def _literal(value) -> str:
    """Return the float32 nearest to a number as a C99 literal: hexadecimal, so that no compiler rounds it again."""
    mantissa, _, exponent = float(np.float32(value)).hex().partition("p")
    whole, _, fraction = mantissa.partition(".")
    return f"{whole}.{fraction.rstrip('0') or '0'}p{exponent}f"


def table(name: str, unit: str, row: np.ndarray, prefix: str) -> str:
    """Return one constant array, each entry with its decimal value beside it."""
    entries = "\n".join(
        f"    {_literal(v)}{',' if i + 1 < row.size else ' '} /* [{i}] {float(v):.9g} */" for i, v in enumerate(row)
    )
    return f"/** [{unit}] */\nstatic const float {name}[{prefix}_COUNT] = {{\n{entries}\n}};"


def harmless(line: str) -> str:
    """Return a line that ends and begins no C comment."""
    return line.replace("*/", "* /").replace("/*", "/ *")
