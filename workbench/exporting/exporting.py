"""export: a schedule as C, JSON, its schema and a binary, all four or none."""

import re
from collections.abc import Iterable, Mapping
from math import isfinite
from os import PathLike
from pathlib import Path

import numpy as np

from workbench.control import RULES
from workbench.errors import WorkbenchError, nearest
from workbench.exporting.binary import pack
from workbench.exporting.changes import insist_same
from workbench.exporting.document import SCHEMA, document, text
from workbench.exporting.header import header
from workbench.exporting.scale import GAINS, scales
from workbench.schedule.tables import tables
from workbench.together import write_together

NAME = re.compile(r"[a-z][a-z0-9_]{0,30}")


def export(
    schedule,
    plant,
    folder: str | PathLike,
    *,
    scale: Mapping | None = None,
    name: str = "gains",
    tuned_lines: Iterable[str] | None = None,
) -> tuple[Path, ...]:
    """Write `<name>.h`, `<name>.json`, `<name>.schema.json` and `<name>.bin` into `folder`, and return their paths.

    schedule: knots (amplitudes, rad or m), kp (N*m/rad or N/m), kd (N*m*s/rad or N*s/m), rule, reversal (rad or m),
    sample_time (s), per_octave, plant_digest. scale: {kp = {unit, per_si}, kd = {unit, per_si}}; gains are then written
    in the drive's units too, value = per_si * (value in SI). name: of the files and, behind "wb_", of the C functions.
    tuned_lines: digest lines of the plant that was tuned, to name a change with; else `schedule.plant_lines`.

    All four files appear, or nothing changes. Raises WorkbenchError for a plant that has changed since tuning (naming
    what changed), for a scale or name that cannot be used, and for a schedule that float32 tables do not hold.
    """
    if not NAME.fullmatch(name):
        raise WorkbenchError(
            f"the name of the gain table is '{name}'; write up to 31 of a-z, 0-9 and _, a letter first."
        )
    insist_same(schedule, plant, tuned_lines)
    factors = scales(scale)
    _insist_on_numbers(schedule)
    drive = factors and {key: np.asarray(getattr(schedule, key), dtype=float) * factors[key].per_si for key in GAINS}
    held = tables(schedule.per_octave, schedule.knots, schedule.kp, schedule.kd, drive)
    contents = document(schedule, plant, held, factors, name)
    files = {
        f"{name}.h": header(contents, held),
        f"{name}.json": text(contents),
        f"{name}.schema.json": SCHEMA.read_bytes(),
        f"{name}.bin": pack(contents, held),
    }
    return write_together(Path(folder), files)


def _insist_on_numbers(schedule) -> None:
    """Raise WorkbenchError for a rule that firmware does not know, or a reversal or sample time that is none."""
    if schedule.rule not in RULES:
        raise WorkbenchError(f"the schedule's rule is '{schedule.rule}'; {nearest(str(schedule.rule), RULES)}")
    for key in ("reversal", "sample_time"):
        value = float(getattr(schedule, key))
        if not (isfinite(value) and 2.0**-60 <= value <= 2.0**60):
            raise WorkbenchError(f"the schedule's {key} is {value!r}; a finite number above zero is needed.")
