"""A gear's kinematic error as a compensation table: what to take off the reading, over one period of the motor's angle."""

import numpy as np

from workbench.drives.maps import Map, cells_of, read, values_of
from workbench.errors import WorkbenchError
from workbench.plant import Plant

WHAT = "kinematic error"
NAME = "kinematic_error"


def write(plant: Plant, count: int = 360, *, homing: bool = True) -> str:
    """Return the table, `count` rows over the longest period of the motor's position as it is seen at the output.

    homing: the phase belongs to a power-up, as it does unless the motor's encoder is absolute. WorkbenchError without one.
    """
    parts = [e for e in plant.effects if e.name == NAME]
    if not parts:
        raise WorkbenchError(
            "the plant has no kinematic error that could be compensated; trace the study, or declare it."
        )
    period = 2.0 * np.pi / min(e.parameters["order"].value for e in parts)
    q = np.arange(cells_of(count)) * (period / count)
    y = sum(values_of(e, {"q": 0.0 * q, "motor_q": q}) for e in parts)
    x = plant.displacement
    return Map(WHAT, f"motor position at the output [{x}]", f"error [{x}]", q, y, float(period), homing).text()


def load(content: str) -> Map:
    """Return the map of a table, checked."""
    return read(content, WHAT)
