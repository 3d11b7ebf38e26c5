"""What warms friction up is a temperature that was logged, or else the heat that it makes: time is no stand-in for either where an axis cools down
in between."""

from dataclasses import replace

import numpy as np
import pytest
from test_otherwise import DT, PLANT, recorded

from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.inverse.dynamics import inverse_dynamics
from workbench.motion import motion
from workbench.output_error.free_run import free_run
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.simulation import Scenario, open_loop
from workbench.tracing import trace
from workbench.tracing.candidates import WHOLE, Offer

BEGUN = (
    ("a", IDENTIFICATION, 1.0, 18.0, 47.0),
    ("bb", IDENTIFICATION, 0.7, 52.0, 33.0),
    ("ccc", VALIDATION, 0.8, 22.0, 41.0),
)
ROOM = 273.15 + 20.0


def rubbing(v, warm):
    """Dry friction whose level falls to 0.6 of what it is when cold, and viscous friction to a third: (n,) N*m."""
    return 0.3 * np.sign(v) * 0.4 * np.expm1(-warm / 18.0) + 0.1 * v * np.expm1(-0.028 * warm)


def warmed(logged=True, law=rubbing, begun=BEGUN, rests=600.0):
    """Records of an axis that warms up, cools down, and is cold again where it is validated; a thermocouple reads tenths of a kelvin."""
    found = []
    for k, (name, role, speed, first, last) in enumerate(begun):
        t = DT * np.arange(round(8.0 / DT))
        degrees = last + (first - last) * np.exp(-t / 4.0)
        one = recorded(name, role, speed, lambda v, w=degrees - 20.0: law(v, w), 8.0)
        read = np.round(10.0 * (degrees + 0.05 * np.sin(0.7 * t))) / 10.0 + 273.15
        channels = one.channels | ({"temperature": read} if logged else {})
        found.append(replace(one, time=one.time + rests * k, channels=channels, units={}))
    return found


def test_friction_that_goes_with_a_logged_temperature_is_a_drift_with_that_law():
    found = trace(
        PLANT, inverse_dynamics(warmed(), 50.0), only={"friction_drift", "thermal_friction", "stribeck_friction"}
    )
    cause = found.causes[0]
    assert (found.verdict, found.added, cause.form) == ("cause", ("friction_drift",), "thermal_friction")
    assert "Its law is that of thermal friction" in cause.sentence and cause.share_validation > 0.9
    values = {e.parameter: e.value for e in cause.parameters}
    warmer = (
        -np.expm1(-values["bend"] * 20.0) / values["bend"]
    )  # both by one bend: where most of the records are, not at the reference
    assert values["rate"] * warmer == pytest.approx(0.12 * np.expm1(-20.0 / 18.0), rel=0.1)
    assert values["viscous_rate"] * warmer == pytest.approx(0.1 * np.expm1(-0.028 * 20.0), rel=0.2)


def test_where_time_says_as_much_the_temperature_leads_and_time_is_no_rival_of_the_same_name():
    """An axis that does nothing but warm up: what drifts with it drifts with time, too, until it cools down."""
    steady = (
        ("a", IDENTIFICATION, 1.0, 20.0, 27.0),
        ("bb", IDENTIFICATION, 0.7, 26.0, 31.0),
        ("ccc", VALIDATION, 0.8, 30.5, 34.0),
    )
    records = warmed(begun=steady, rests=8.5)
    found = trace(
        PLANT, inverse_dynamics(records, 50.0), only={"friction_drift", "thermal_friction", "stribeck_friction"}
    )
    cause = found.causes[0]
    assert (found.added, cause.form, cause.rivals) == (("friction_drift",), "thermal_friction", ())


def test_a_law_of_temperature_is_asked_where_every_record_has_one():
    with_it, without = warmed(), warmed(logged=False)
    asked = []
    for records in (with_it, without, [*with_it[:2], without[2]]):
        logged = [n for n in ("temperature",) if all(n in r.channels for r in records)]
        asked.append("thermal_friction" in {c.effect for c in Offer(logged=logged).candidates(PLANT)})
    assert asked == [True, False, False] and "thermal_friction" not in {c.effect for c in WHOLE.candidates(PLANT)}


def test_a_temperature_that_changes_nothing_is_not_missing():
    found = trace(
        PLANT, inverse_dynamics(warmed(law=lambda v, w: 0.0 * v), 50.0), only={"friction_drift", "thermal_friction"}
    )
    assert (found.verdict, found.added) == ("nothing_missing", ())


def test_a_declared_law_of_temperature_without_a_channel_is_refused_with_a_sentence():
    plant = PLANT + find("thermal_friction")(rate=-0.01)
    with pytest.raises(WorkbenchError, match="reads 'temperature', which record 'a' does not have"):
        trace(plant, inverse_dynamics(warmed(logged=False), 50.0))


def axis():
    plant = PLANT.swap(PLANT["inertia@axis"](inertia=0.01)).swap(PLANT["viscous_friction@axis"](viscous=0.02))
    return plant.without("coulomb_friction@axis") + find("thermal_friction")(viscous_rate=-1e-3, rate=0.0, bend=1e-4)


def test_an_axis_coasts_farther_when_it_is_warm():
    """v = v0 exp(-b t/J): what is left of a speed after a second says the viscous friction at the scenario's temperature."""
    scenarios = [Scenario(speed=1.0, temperature=ROOM + d) for d in (0.0, 10.0)]
    run = open_loop(axis(), np.zeros((1001, 2)), 1e-3, 4, scenarios=scenarios, record=("v",))
    left = run["v"][-1]
    assert left == pytest.approx(np.exp(-np.array([0.02, 0.01]) / 0.01), rel=2e-3)


def test_a_temperature_over_time_stands_in_the_place_of_a_scenarios():
    warm = np.full(1001, ROOM + 10.0)
    run = open_loop(
        axis(), np.zeros((1001, 1)), 1e-3, 4, scenarios=[Scenario(speed=1.0)], temperature=warm, record=("v",)
    )
    assert run["v"][-1, 0] == pytest.approx(np.exp(-1.0), rel=2e-3)


def test_a_free_run_is_at_the_temperature_that_was_logged():
    """The drive of a record moves the same plant to where it was, by the temperature of each moment and by no other."""
    t, counts = 1e-3 * np.arange(4001), 1e-7
    warm, drive = ROOM + 5.0 * t, 0.05 * np.sin(3.0 * t)
    q = open_loop(axis(), drive, 1e-3, 4, temperature=warm)["q"][:, 0]
    made = recorded("a", IDENTIFICATION, 1.0, lambda v: 0.0 * v, 4.001)
    channels = {"torque": drive, "position": q, "temperature": warm}
    record = replace(made, time=t, channels=channels, units={}, resolution={"position": counts})
    at_room = replace(record, channels=channels | {"temperature": np.full(t.size, ROOM)})
    assert free_run(axis(), motion(record, 50.0)).error < 0.02 * free_run(axis(), motion(at_room, 50.0)).error


class Heated:
    """Friction whose contact its own power warms up and a rest cools: a level that falls with the heat, by up to a quarter."""

    def __init__(self):
        self.heat = 0.0

    def __call__(self, v):
        heats = np.empty(v.size)
        for k, speed in enumerate(np.abs(v)):
            heats[k] = self.heat = self.heat + DT * (0.12 * speed - 0.25 * self.heat)
        return -0.35 * (1.0 - np.exp(-heats)) * np.sign(v)


def test_friction_that_warms_itself_up_and_cools_at_rest_is_a_drift_with_that_law():
    """What earlier motion left is in each record's beginning, less what cooled in the gap between them."""
    law, records = Heated(), []
    motions = (
        ("a", IDENTIFICATION, 1.0),
        ("bb", IDENTIFICATION, 0.7),
        ("ccc", IDENTIFICATION, 1.5),
        ("dddd", VALIDATION, 0.7),
    )
    for k, (name, role, speed) in enumerate(motions):
        one = recorded(name, role, speed, law, 10.0)
        records.append(replace(one, time=one.time + 18.0 * k))
        law.heat *= np.exp(-0.25 * 8.0)
    found = trace(
        PLANT,
        inverse_dynamics(records, 50.0),
        only={"friction_drift", "stribeck_friction", "nonlinear_viscous_friction"},
    )
    cause = found.causes[0]
    assert (found.verdict, found.added, cause.form) == ("cause", ("friction_drift",), "self_heating_friction")
    assert cause.share_validation > 0.8
    assert {e.parameter: e.value for e in cause.parameters}["settling"] == pytest.approx(0.25, rel=0.5)
