"""gains.json: the gain table for people and programs, checked by gains.schema.json when it is read back."""

import json
from os import PathLike
from pathlib import Path

import numpy as np

from workbench import __version__
from workbench.control.notched import COEFFICIENTS
from workbench.errors import WorkbenchError
from workbench.exporting.changes import digest
from workbench.readers.files import regular
from workbench.schedule.tables import Tables, tables

SCHEMA = Path(__file__).with_name("gains.schema.json")
FORMAT = "servo-workbench gains"
FORMAT_VERSION = 1


def document(schedule, plant, held: Tables, scale, name: str) -> dict:
    """Return the document of a gain table; the schema says what each key means, in which unit."""
    out = {
        "$schema": f"{name}.schema.json",
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "project_version": __version__,
        "name": name,
        "units": _units(plant),
        "rule": schedule.rule,
        "reversal": float(schedule.reversal),
        "sample_time": float(schedule.sample_time),
        "per_octave": held.per_octave,
        "knots": floats(schedule.knots),
        "kp": floats(schedule.kp),
        "kd": floats(schedule.kd),
    }
    out |= _behind(schedule)
    error = getattr(schedule, "interpolation_error", None)
    if error is not None and np.ndim(error) == 0 and np.isfinite(error):
        out["interpolation_error"] = float(error)
    if scale is not None:
        out["drive"] = {
            key: {"unit": s.unit, "per_si": s.per_si, "gains": floats(np.asarray(getattr(schedule, key)) * s.per_si)}
            for key, s in scale.items()
        }
    out["payload"] = {"rows": list(held.rows), "crc32": f"0x{held.crc:08X}"}
    out["plant"] = {"digest": plant.digest, "lines": list(plant.digest_lines())}
    return out


def _behind(schedule) -> dict[str, object]:
    """Return the velocity filter and the notch that the gains were tuned with, where there are such."""
    filtered, notch = (getattr(schedule, n, None) for n in ("velocity_filter", "numbers"))
    out = {} if filtered is None else {"velocity_filter": float(filtered)}
    return out if notch is None else out | {"notch": dict(zip(COEFFICIENTS, map(float, notch), strict=True))}


def _units(plant) -> dict[str, str]:
    """Return the SI unit of each quantity of a table."""
    x, f = plant.displacement, plant.effort
    return {"knots": x, "kp": f"{f}/{x}", "kd": f"{f}*s/{x}", "reversal": x, "sample_time": "s"}


def floats(values) -> list[float]:
    """Return an array as floats, which JSON writes so that they read back to the last bit."""
    return [float(v) for v in np.asarray(values, dtype=float)]


def text(contents: dict) -> bytes:
    """Return a document as JSON, one value a line."""
    return (json.dumps(contents, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()


def tables_of(contents: dict, where: str = "gains.json") -> Tables:
    """Return the float32 tables of a document; WorkbenchError where knots or gains do not make some."""
    drive = contents.get("drive")
    gains = None if drive is None else {key: drive[key]["gains"] for key in ("kp", "kd")}
    return tables(contents["per_octave"], contents["knots"], contents["kp"], contents["kd"], gains, where)


def load(path: str | PathLike) -> dict:
    """Return the document at `path` (gains.json), checked whole.

    Checked are the schema, the knots, the CRC-32 of the float32 tables, and that the plant's digest is over its lines.
    Raises WorkbenchError, naming file and key, for the first of these that fails.
    """
    again = "export the table again"
    try:
        contents = json.loads(regular(Path(path)).read_bytes(), parse_constant=_refuse, parse_int=_whole)
    except OSError as error:
        raise WorkbenchError(f"{path} cannot be read ({error.strerror}); name a gain table, gains.json.") from error
    except (ValueError, RecursionError) as error:
        raise WorkbenchError(f"{path} is not JSON ({error}); {again}.") from error
    _check(contents, path)
    held = tables_of(contents, str(path))
    said, rows = contents["payload"]["crc32"], contents["payload"]["rows"]
    if rows != list(held.rows):
        raise WorkbenchError(f"{path}: payload.rows is {rows}, but the tables are {list(held.rows)}; {again}.")
    if int(said, 16) != held.crc:
        raise WorkbenchError(
            f"{path}: payload.crc32 is {said}, but the tables give 0x{held.crc:08X}: they were changed after the export;"
            f" {again}."
        )
    if digest(contents["plant"]["lines"]) != contents["plant"]["digest"]:
        raise WorkbenchError(
            f"{path}: plant.digest is not the digest of plant.lines: they were changed after the export; {again}."
        )
    return contents


def _check(contents, path) -> None:
    """Raise WorkbenchError for the most telling breach of the schema."""
    import jsonschema  # 0.1 s: only when a table is read

    validator = jsonschema.Draft202012Validator(json.loads(SCHEMA.read_bytes()))
    error = jsonschema.exceptions.best_match(validator.iter_errors(contents))
    if error is not None:
        key = error.json_path.removeprefix("$").removeprefix(".") or "the document"
        said = error.message if len(error.message) <= 160 else f"it breaks the rule '{error.validator}'"
        raise WorkbenchError(f"{path}: {key}: {said}; mend it as {SCHEMA.name} says, or export the table again.")


def _whole(digits: str) -> int:
    """Return a whole number that is one of a float's range, too; ValueError where it is larger."""
    try:
        float(found := int(digits))
    except OverflowError:
        raise ValueError(f"a whole number of {len(digits)} digits is none of a gain table") from None
    return found


def _refuse(constant: str):
    """Refuse NaN and Infinity, which Python reads but JSON does not have."""
    raise ValueError(f"{constant} is not a number of JSON")
