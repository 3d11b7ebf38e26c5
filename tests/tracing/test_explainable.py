"""What counts as explainable: a line that a force makes, and not the hum of the mains in the reported drive."""

import numpy as np
import pytest

from workbench.definition import find
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, Record
from workbench.tracing.criteria import Criteria
from workbench.tracing.explainable import explainable
from workbench.tracing.state import State

DT, N, INERTIA, BAND = 1e-3, 20000, 0.02, 90.0
T = DT * np.arange(N)


def left(reported: float, felt: float, frequency: float) -> float:
    """Return the line of a residual: of a sine in the reported drive alone, and of a force that moves the axis. Sizes in N*m."""
    w = 2 * np.pi * frequency
    q = 0.5 * np.sin(3.0 * T) - felt / INERTIA / w**2 * np.sin(w * T)
    drive = -0.5 * 9.0 * INERTIA * np.sin(3.0 * T) + reported * np.sin(w * T)
    drive += 2e-4 * np.random.default_rng(1).standard_normal(N)
    record = Record("r", IDENTIFICATION, T, {"torque": drive, "position": q})
    plant = Plant(ONE_MASS) + find("inertia")(inertia=INERTIA)
    return explainable(State(plant, inverse_dynamics([record], BAND)), Criteria()).line


@pytest.mark.parametrize("frequency", [50.0, 59.9])
def test_hum_of_the_mains_in_the_reported_drive_is_not_explainable(frequency):
    assert left(0.005, 0.0, frequency) == 0.0


def test_a_force_of_the_same_frequency_that_moves_the_axis_is():
    assert left(0.0, 0.005, 50.0) > 0.02


def test_a_line_beside_the_mains_is():
    assert left(0.0, 0.005, 43.0) > 0.02
