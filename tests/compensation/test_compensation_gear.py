"""A gear's kinematic error on two masses: undone where the reference of the motor enters, for a loop on the motor's encoder."""

import pytest

from workbench.cancellation.following import Slow, worth
from workbench.compensation import Compensator
from workbench.control import fixed_pd, pi_cascade
from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.plant import TWO_MASS, Geometry, Limits, Plant
from workbench.simulation import Loop

LOOP = Loop(1e-3, 4, 0.0, 1e-3, 1e-7, 1e-7, "load_position")
PLANT = Plant(
    TWO_MASS,
    (
        find("inertia")(inertia=0.007, at="motor"), find("inertia")(inertia=0.002, at="load"),
        find("linear_stiffness")(stiffness=2000.0, at="joint"), find("linear_damping")(damping=0.5, at="joint"),
        find("kinematic_error")(sine=4e-4, order=100.0, at="joint"),
    ),
    geometry=Geometry(gear_ratio=50.0), limits=Limits(3.3, 12.0),
)  # fmt: skip
NAMED = Compensator.of(PLANT, ("kinematic_error",), source="reference")
SLOW = Slow(0.02, 0.1)


def test_a_loop_on_the_motor_leaves_a_fifth_of_the_gears_error_and_a_mismatch_its_share():
    """Without it the load is off by the whole error, 0.4 mrad: the motor's loop does not see it."""
    found = worth(PLANT, LOOP, pi_cascade(200.0, 3.0, 60.0, 10.0, motor_position=True), NAMED, SLOW)
    assert found.errors[0.0] == pytest.approx(4e-4, rel=0.3)
    assert found.ratio >= 5.0
    assert found.errors[0.7] == pytest.approx(0.3 * found.errors[0.0], rel=0.4)


def test_on_the_outputs_encoder_the_loop_sees_the_error_itself_and_the_compensation_is_refused():
    with pytest.raises(WorkbenchError, match="motor's encoder"):
        worth(PLANT, LOOP, fixed_pd(100.0, 3.0, motor_speed=True), NAMED, SLOW)
