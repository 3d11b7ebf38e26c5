"""What leaves for the drive: the recommended controller first, then the others, all for one plant."""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from workbench.compensation import Compensated, Compensator
from workbench.control import Controller
from workbench.control.notched import OWN as NOTCH
from workbench.errors import WorkbenchError
from workbench.exporting.numbers import export_numbers
from workbench.firmware.compensation_make import compensation_firmware
from workbench.firmware.make import ARITHMETICS
from workbench.plant import Plant
from workbench.task.task import Task
from workbench.together import write_together

UNITS = {  # of the numbers of every law; F and x are the plant's own
    "kp": "F/x", "kd": "F*s/x", "kv": "1/s", "kvp": "F*s/x", "ki": "F/x", "speed_limit": "x/s", "deceleration": "x/s^2",
    "gate": "x", "mass": "F*s^2/x", "per_first": "s/x", "scale": "1", **dict.fromkeys(NOTCH, "1"),
}  # fmt: skip
LAWS = {
    "fixed_pd": "u = kp (r - y) - kd vh",
    "scheduled_pd": "u = scale (kp (r - y) - kd vh), kp and kd of the table beside",
    "pi_cascade": "v_r = clip(kv (r - y), speed_limit); u = kvp (v_r - vh) + ki integral of (v_r - vh) dt",
    "profile_pi": (
        "v_r = sgn(r - y) min(kv |r - y|, sqrt(2 deceleration |r - y| - (deceleration/kv)^2), speed_limit); "
        "u = kvp (v_r - vh) + ki integral of (v_r - vh) dt where |r - y| <= gate"
    ),
}
BEHIND = "; behind it (notch_b0 + notch_b1/z + notch_b2/z^2)/(1 + notch_b1/z + notch_a2/z^2)"
FED = ("feed_forward.h", "feed_forward.json")  # the friction that a law feeds forward, by speed
CONTENTS = "contents.json"
TABLE = "gains"


def leave(
    tuned: Mapping[str, object], first: str, plant: Plant, sample_time: float, folder: Path, table: str = "",
    task: Task | None = None,
) -> None:  # fmt: skip
    """Write the numbers of every controller (name -> controller(lanes)) whose law has no table, and contents.json.

    first: the recommended one. table: name of the one that the gain table beside them is of. task: of which a compensation's
    firmware is written, beside the numbers of the law. Contents names the controllers in
    order, the recommended first, each with its files, and the digest of the plant that all of them were tuned for.
    """
    entries = []
    for name in sorted(tuned, key=lambda n: n != first):
        controller = tuned[name].controller(1)
        tabled = "kp" in controller.law.columns
        files = [f"{TABLE}.h", f"{TABLE}.json", f"{TABLE}.bin"] if tabled and name == table else []
        if not tabled or (
            files and controller.velocity_filter is not None
        ):  # a table's own filter and notch stand beside it
            numbers = _numbers_of(controller, plant)
            files += [p.name for p in export_numbers(name, _law_of(controller), numbers, sample_time, plant, folder)]
            files += list(FED) if controller.tables and not tabled else []
        entry = {"controller": name, "recommended": name == first, "law": controller.law.name, "files": files}
        if isinstance(controller, Compensated) and task is not None:
            entry["compensation"] = _leave_compensation(controller.compensator, plant, task, folder)
        entries.append(entry)
    content = {
        "format": "servo-workbench gains",
        "recommended": first,
        "controllers": [e for e in entries if e["files"]],
        "plant": {"digest": plant.digest, "lines": list(plant.digest_lines())},
    }
    write_together(Path(folder), {CONTENTS: (json.dumps(content, indent=1) + "\n").encode()})


def _law_of(controller: Controller) -> str:
    """Return a law in words, with the notch behind it."""
    law = LAWS.get(controller.law.name.split(",")[0], controller.law.name)
    return law + (BEHIND if set(NOTCH) <= set(controller.law.parameters) else "")


def _leave_compensation(compensator: Compensator, plant: Plant, task: Task, folder: Path) -> dict[str, object]:
    """Write the firmware of a compensation in every arithmetic that holds it, and return what contents.json says of it."""
    said: dict[str, object] = {"effects": [e.key for e in compensator.effects], "source": compensator.source}
    travel = (task.start - abs(task.step), task.start + abs(task.step))
    for arithmetic in ARITHMETICS:
        place = f"compensation/{arithmetic}"
        try:
            made = compensation_firmware(compensator, task.loop, plant, arithmetic, travel=travel)
            files = write_together(Path(folder) / place, made.exported())
            said[arithmetic] = [f"{place}/{p.name}" for p in files]
        except WorkbenchError as e:
            said[arithmetic] = f"not written: {e}"
    return said


def _numbers_of(controller, plant: Plant) -> dict[str, tuple[float, str]]:
    """Return name -> (value, unit) of every parameter of a controller's law; of a compensated one, of the law alone."""
    if isinstance(controller, Compensated):
        return _numbers_of(controller.base, plant)
    out = {}
    for name, value in controller.parameters.items():
        if name not in UNITS:
            raise WorkbenchError(
                f"the number '{name}' of controller '{controller.name}' has no unit to be exported with."
            )
        unit = UNITS[name].replace("F", plant.effort).replace("x", plant.displacement)
        out[name] = (float(value if getattr(value, "ndim", 0) == 0 else value[0]), unit)
    if controller.velocity_filter is not None:
        out["velocity_filter"] = (float(np.ravel(controller.velocity_filter)[0]), "s")
    return out
