"""Which values no machine has, and which may stand on their bound because they are a law of their own."""

import numpy as np
import pytest

from workbench.definition import find
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, TWO_MASS, Geometry, Plant
from workbench.record import IDENTIFICATION, Record
from workbench.tracing.plausible import implausible

T = 1e-3 * np.arange(4000)


@pytest.mark.parametrize(
    ("name", "values", "machine"),
    [
        ("load_dependent_friction", {"mu": 0.2, "share": 1.0}, True),  # all of the inertia lies behind the contact
        ("load_dependent_friction", {"mu": 0.2, "share": 0.0}, True),
        ("load_dependent_friction", {"mu": 1.0, "share": 0.5}, False),
        ("presliding_hysteresis", {"h0": 1.0, "x0": 1.0}, False),  # gives way over a metre, of a travel of 0.2
        (
            "presliding_hysteresis",
            {"h0": 1.0, "x0": 0.1},
            False,
        ),  # over half of the travel, by which it has hardly slipped
        ("presliding_hysteresis", {"h0": 1.0, "x0": 1e-3}, True),
        ("slack_cable", {"right": 1.0, "left": 1.0, "place": 0.0, "exponent": 1.0}, True),  # two straight springs
        ("slack_cable", {"right": 1.0, "left": 1.0, "place": 0.0, "exponent": 4.0}, False),
        ("sensor_trend", {"rate": 1e-3}, True),  # 4 mm within the record, of 200
        ("sensor_trend", {"rate": 1e-2}, False),
        ("cable_spring", {"stiffness": 1.0, "preload": 1.0}, True),  # relaxed 5 travels away
        ("cable_spring", {"stiffness": 1.0, "preload": 4.0}, False),  # 20: a constant force
        ("flexible_mode", {"mass": 1.0, "frequency": 1.0, "damping": 0.1}, False),  # swings four times
        ("flexible_mode", {"mass": 1.0, "frequency": 2.0, "damping": 0.1}, True),
        ("kinematic_error", {"sine": 1e-4, "cosine": 1e-4, "order": 50.0}, False),  # 1.6 periods
        ("kinematic_error", {"sine": 1e-4, "cosine": 1e-4, "order": 80.0}, True),  # 2.5
    ],
)
def test_a_share_may_be_all_or_none_and_a_length_or_a_wave_no_longer_than_the_travel(name, values, machine):
    effect = find(name)(**values, at="axis" if "axis" in find(name).places else "sensor.position")
    plant = Plant(ONE_MASS) + find("inertia") + effect
    record = Record("r", IDENTIFICATION, T, {"torque": np.sin(T), "position": 0.1 * np.sin(3.0 * T)})
    assert (implausible(effect, plant, plant, inverse_dynamics([record], 60.0)) == "") is machine


@pytest.mark.parametrize(("order", "machine"), [(20.0, True), (20.1, True), (21.0, False), (1.0, False)])
def test_an_error_once_a_motors_turn_is_one_however_little_of_it_the_travel_holds(order, machine):
    """A belt's pulley errs once a turn of the motor: 0.6 of a period; a wave of any other order, and of the axis' own turn, may be any curve."""
    effect = find("kinematic_error")(sine=1e-4, cosine=1e-4, order=order, at="sensor.position")
    plant = Plant(ONE_MASS, geometry=Geometry(gear_ratio=20.0)) + find("inertia") + effect
    record = Record("r", IDENTIFICATION, T, {"torque": np.sin(T), "position": 0.1 * np.sin(3.0 * T)})
    assert (implausible(effect, plant, plant, inverse_dynamics([record], 60.0)) == "") is machine


@pytest.mark.parametrize(("second", "machine"), [(0.004, True), (0.012, False)])
def test_a_disc_reads_what_all_its_waves_read_together(second, machine):
    """A crank's inertia is an eccentric encoder to the search, of a wave for each harmonic, and together they are more than a degree."""
    disc = find("encoder_eccentricity")(sine=0.007, at="sensor.position")
    wave = find("kinematic_error")(cosine=second, order=2.0, at="sensor.position")
    plant = Plant(ONE_MASS) + find("inertia") + disc + wave
    record = Record("r", IDENTIFICATION, T, {"torque": np.sin(T), "position": 30.0 * np.sin(3.0 * T)})
    assert all((implausible(e, plant, plant, inverse_dynamics([record], 60.0)) == "") is machine for e in (disc, wave))


@pytest.mark.parametrize(("outside", "spring", "machine"), [(2.0, 0.0, True), (-2.0, 0.0, False), (-2.0, 3.0, True)])
def test_what_pushes_an_axis_away_beyond_a_threshold_is_no_bumper(outside, spring, machine):
    """Beside a flexure it may be one that softens."""
    effect = find("piecewise_stiffness")(at="axis", k2=outside, threshold=0.05)
    plant = Plant(ONE_MASS) + find("inertia") + find("linear_stiffness")(at="axis", stiffness=spring) + effect
    record = Record("r", IDENTIFICATION, T, {"torque": np.sin(T), "position": 0.1 * np.sin(3.0 * T)})
    assert (implausible(effect, plant, plant, inverse_dynamics([record], 60.0)) == "") is machine


def test_a_memory_of_a_joint_that_is_longer_than_the_joint_deflects_is_a_spring():
    load = 0.1 * np.sin(3.0 * T)
    channels = {"torque": np.sin(T), "position": load + 5e-3 * np.sin(3.0 * T), "load_position": load}
    seen = inverse_dynamics([Record("r", IDENTIFICATION, T, channels)], 60.0)
    for length, machine in ((5e-3, True), (5e-2, False)):
        effect = find("fading_memory")(at="joint", h=1.0, x0=length)
        plant = Plant(TWO_MASS) + find("inertia")(at="motor") + find("inertia")(at="load") + effect
        assert (implausible(effect, plant, plant, seen) == "") is machine


@pytest.mark.parametrize(("viscous", "machine"), [(0.5, True), (0.1, False)])
def test_friction_that_grows_less_with_speed_brakes_and_does_not_drive(viscous, machine):
    """A controller that gives way with speed looks like it, where nothing else moves the axis. The fastest speed is 0.3."""
    effect = find("nonlinear_viscous_friction")(quadratic=-1.0)
    plant = Plant(ONE_MASS) + find("inertia") + find("viscous_friction")(viscous=viscous) + effect
    record = Record("r", IDENTIFICATION, T, {"torque": np.sin(T), "position": 0.1 * np.sin(3.0 * T)})
    assert (implausible(effect, plant, plant, inverse_dynamics([record], 60.0)) == "") is machine
