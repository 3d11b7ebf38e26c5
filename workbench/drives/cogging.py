"""Cogging as a compensation table: the force to add to the command, over one period of position."""

import numpy as np

from workbench.drives.maps import Map, cells_of, read, values_of
from workbench.errors import WorkbenchError
from workbench.plant import Plant

WHAT = "cogging"


def write(plant: Plant, count: int = 360, *, homing: bool = False) -> str:
    """Return the table of a plant's cogging, `count` rows over its longest period.

    homing: the phase belongs to a power-up, so that the table holds after homing only. WorkbenchError without cogging.
    """
    parts = [e for e in plant.effects if e.name == WHAT]
    if not parts:
        raise WorkbenchError(
            "the plant has no cogging that could be compensated; trace the study, or declare the effect."
        )
    period = 2.0 * np.pi / min(e.parameters["order"].value for e in parts)
    q = np.arange(cells_of(count)) * (period / count)
    y = sum(values_of(e, {"q": q}) for e in parts)
    return Map(WHAT, f"position [{plant.displacement}]", f"force [{plant.effort}]", q, y, float(period), homing).text()


def load(content: str) -> Map:
    """Return the map of a table, checked."""
    return read(content, WHAT)
