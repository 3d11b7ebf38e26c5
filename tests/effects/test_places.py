"""Where engineers declare springs, dampers, weights and offsets of two masses, and what of it a trace offers by itself."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, TWO_MASS, Plant
from workbench.record import IDENTIFICATION, Record
from workbench.tracing.candidates import WHOLE


@pytest.mark.parametrize(
    ("name", "place", "offered"),
    [
        ("constant_offset", "joint", False),
        ("linear_stiffness", "load", False),
        ("linear_stiffness", "motor", False),
        ("linear_damping", "load", False),
        ("cable_spring", "motor", False),
        ("cable_spring", "load", True),
        ("gravity", "motor", True),
        ("gravity", "load", True),
    ],
)
def test_what_may_be_declared_at_a_body_is_offered_there_only_where_nothing_else_says_it(name, place, offered):
    plant = (
        Plant(TWO_MASS)
        + find("inertia")(at="motor")
        + find("inertia")(at="load")
        + find("linear_stiffness")(at="joint")
    )
    assert (plant + find(name)(at=place)).effects[-1].key == f"{name}@{place}"
    assert ((name, place) in {(c.effect, c.at) for c in WHOLE.candidates(plant)}) is offered


def test_a_damper_of_one_mass_is_viscous_friction_and_is_declared_by_either_name():
    plant = Plant(ONE_MASS) + find("inertia") + find("linear_damping")(at="axis")
    assert ("linear_damping", "axis") not in {
        (c.effect, c.at) for c in WHOLE.candidates(Plant(ONE_MASS) + find("inertia"))
    }
    assert plant.effects[-1].at == "axis"


def test_a_joint_holds_together_and_a_magnet_draws_away_from_the_middle():
    with pytest.raises(WorkbenchError, match="linear_stiffness.stiffness is -5, outside its physical bounds 0 to inf"):
        find("linear_stiffness")(stiffness=-5.0)
    there = find("linear_stiffness")(at="axis", stiffness=-5.0)
    assert there.parameters["stiffness"].value == -5.0
    assert there(at="joint").parameters["stiffness"].lower == 0.0
    closer = replace(find("linear_stiffness").parameters["stiffness"], lower=3.0)
    assert replace(there, at="joint", parameters={"stiffness": closer}).parameters["stiffness"].lower == 3.0


def test_a_magnetic_coupling_softens_as_it_is_wound_up():
    """T = k/n sin(n x) is k x - k n^2/6 x^3 to the third power."""
    k, n = 46.0, 9.0
    soft = find("cubic_stiffness")(k3=-k * n**2 / 6.0)
    assert soft.at == "joint" and soft.parameters["k3"].lower == -np.inf
    x = np.linspace(-0.05, 0.05, 11)
    law = soft.step(SimpleNamespace(q=x), {}, SimpleNamespace(k3=soft.parameters["k3"].value))[1]
    np.testing.assert_allclose(k * x + law, k / n * np.sin(n * x), rtol=3e-3, atol=1e-12)


def test_the_stiffness_of_a_magnetic_bearing_is_identified_with_its_sign():
    t = 1e-3 * np.arange(4000)
    q, w = np.zeros(t.size), np.zeros(t.size)
    for f in (0.7, 3.1, 9.0):
        q, w = q + 1e-3 / f * np.sin(2 * np.pi * f * t), w - 1e-3 / f * (2 * np.pi * f) ** 2 * np.sin(2 * np.pi * f * t)
    force = 1.5 * w - 1154.0 * q - 5e8 * q**3
    record = Record("a", IDENTIFICATION, t, {"force": force, "position": q}, resolution={"position": 1e-9})
    plant = Plant(ONE_MASS, rotary=False)
    for effect in (find("inertia"), find("linear_stiffness")(at="axis"), find("cubic_stiffness")(at="axis")):
        plant += effect
    found = identify(plant, inverse_dynamics([record], 60.0)).plant
    assert found["linear_stiffness@axis"].parameters["stiffness"].value == pytest.approx(-1154.0, rel=0.01)
    assert found["cubic_stiffness@axis"].parameters["k3"].value == pytest.approx(-5e8, rel=0.03)


@pytest.mark.parametrize(
    ("name", "parameter", "free"),
    [
        ("encoder_eccentricity", "zero", {"sensor.position": False, "sensor.load_position": True}),
        ("kinematic_error", "zero", {"joint": True, "sensor.position": False}),
        ("load_dependent_friction", "share", {"axis": True, "load": False}),
    ],
)
def test_what_may_be_free_at_some_places_alone_is_free_there_wherever_the_effect_came_from(name, parameter, free):
    """A load encoder's eccentricity came from the motor's, kept its zero held, and was a kinematic error that has a zero."""
    for first in free:
        for place, expected in free.items():
            moved = find(name)(at=first)(at=place)
            assert moved.parameters[parameter].fixed is not expected, (first, place)
