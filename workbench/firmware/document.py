"""The table as JSON, with a schema: every field of the image, its unit and its scale, for people and programs."""

import json
from pathlib import Path

import numpy as np

from workbench import __version__
from workbench.errors import WorkbenchError
from workbench.firmware.image import FIXED, FLOAT32, VERDICTS, VERSION, Image
from workbench.firmware.make import Firmware
from workbench.firmware.units import power_of, unit

SCHEMA = Path(__file__).with_name("firmware.schema.json")
FORMAT = "servo-workbench firmware table"
NAMES = {FLOAT32: "float32", FIXED: "fixed"}
KEYS = ("per_octave", "sample_time", "count", "limit", "bits", "jump")


def formats(made: Firmware) -> tuple[list, list]:
    """Return the fractional bits of constants and of columns; None each in float32."""
    scales = getattr(made.reference, "scales", None)
    if scales is None:
        return [None] * made.image.constants.size, [None] * len(made.numbers.columns)
    return [f.bits for f in scales.constants], [scales.column(n).bits for n in made.numbers.columns]


def _numbers_of(values: np.ndarray) -> list:
    """Words as JSON holds them: floats that read back to the same float32, or integers."""
    return [float(v) if values.dtype.kind == "f" else int(v) for v in values]


def document(made: Firmware) -> dict:
    """Return the table as a document; firmware.schema.json says what each key means."""
    image, stages = made.image, made.numbers.stages
    constants, columns = formats(made)
    rows = iter(image.rows)
    out = {
        "$schema": f"{made.source.name}.schema.json",
        "format": FORMAT,
        "format_version": VERSION,
        "project_version": __version__,
        "licence": "No licence is claimed on this file.",
        "name": made.source.name,
        "law": {"name": stages.law.name, "code": f"0x{image.law:08X}", "encoder": stages.feedback},
        "arithmetic": NAMES[image.arithmetic],
        "motion": "linear" if image.motion else "rotary",
        **{key: getattr(image, key) for key in KEYS},
        "verdict": VERDICTS[image.verdict],
        "plant": image.plant,
        "constants": [
            {"name": c.identifier, "formula": c.formula, "unit": unit(c.power, made.source.effort), "value": value}
            | ({} if bits is None else {"fractional_bits": bits})
            for c, bits, value in zip(stages.constants, constants, _numbers_of(image.constants), strict=True)
        ],
        "knots": [float(k) for k in image.knots],
        "columns": [],
        "crc32": f"0x{int.from_bytes(image.bytes()[-4:], 'little'):08X}",
    }
    for name, bits in zip(stages.columns, columns, strict=True):
        entry = {
            "name": name,
            "unit": unit(power_of(f"gain.{name}"), made.source.effort),
            "gains": _numbers_of(next(rows)),
        }
        if bits is None:
            entry["slopes"] = _numbers_of(next(rows))
        else:
            entry["fractional_bits"] = bits
        out["columns"].append(entry)
    return out


def text(contents: dict) -> str:
    return json.dumps(contents, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def load(path) -> Image:
    """Return the image that a document holds, checked by schema and CRC-32; WorkbenchError names what is wrong."""
    import jsonschema

    try:
        contents = json.loads(Path(path).read_bytes())
        jsonschema.validate(contents, json.loads(SCHEMA.read_bytes()))
    except OSError as error:
        raise WorkbenchError(f"{path} cannot be read ({error.strerror}); name a firmware table in JSON.") from error
    except ValueError as error:
        raise WorkbenchError(f"{path} is not JSON ({error}); export the table again.") from error
    except jsonschema.ValidationError as error:
        raise WorkbenchError(f"{path}: {error.json_path[2:]}: {error.message}; export the table again.") from error
    fixed = contents["arithmetic"] == "fixed"
    kind = np.int32 if fixed else np.float32
    rows = [r for c in contents["columns"] for r in ([c["gains"]] if fixed else [c["gains"], c["slopes"]])]
    image = Image(
        arithmetic=FIXED if fixed else FLOAT32,
        law=int(contents["law"]["code"], 16),
        **{key: contents[key] for key in KEYS},
        verdict=VERDICTS.index(contents["verdict"]),
        motion=("rotary", "linear").index(contents["motion"]),
        plant=contents["plant"],
        constants=np.array([c["value"] for c in contents["constants"]], kind),
        knots=np.array(contents["knots"], np.float32),
        rows=np.array(rows, kind).reshape(len(rows), len(contents["knots"])),
    )
    crc = int.from_bytes(image.bytes()[-4:], "little")
    if crc != int(contents["crc32"], 16):
        raise WorkbenchError(
            f"{path}: crc32 is {contents['crc32']}, but the table gives 0x{crc:08X}: it was changed; export it again."
        )
    return image
