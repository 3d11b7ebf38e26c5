"""Which gains are possible at all: of which plants, and from which amplitude on."""

from math import isfinite

import numpy as np

from workbench.design.design import Designed, design
from workbench.errors import WorkbenchError
from workbench.plant import TWO_MASS, Plant
from workbench.task.task import Task
from workbench.tuning import OutOfReach, TuningGoal

RAISED = 6  # attempts with the lowest amplitude raised: friction is described anew at each
_TWO_MASSES = (
    "gains over amplitude are those of one mass with one encoder, and this plant is two masses; `workbench trace` closes the "
    "loop of a cascade around it."
)


def check_plant(plant: Plant) -> None:
    """Raise WorkbenchError, with what would mend it, where no gains can be tuned for a plant as it is declared."""
    if not isfinite(plant.limits.drive):
        raise WorkbenchError(
            "campaign.toml states no limit of the drive, and without one the fastest gains are infinite; "
            "state actuator_limit there."
        )
    if plant.kind == TWO_MASS:
        raise WorkbenchError(_TWO_MASSES)


def design_from_lowest(plant: Plant, amplitudes: np.ndarray, goal: TuningGoal, task: Task, **options) -> Designed:
    """Return the design from the lowest amplitude on that allows any gains. Arguments as of `design`.

    tuning.OutOfReach where less than a decade of amplitudes would be left: a schedule over that would be none.
    """
    for _ in range(RAISED):
        try:
            return design(plant, amplitudes, goal, task, **options)
        except OutOfReach as e:
            if e.lowest is None or amplitudes[-1] < 10.0 * e.lowest:
                raise
            reason = e
            amplitudes = np.geomspace(e.lowest, amplitudes[-1], amplitudes.size)
    raise reason
