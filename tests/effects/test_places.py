"""Where engineers declare springs, dampers, weights and offsets of two masses, and what of it a trace offers by itself."""

import pytest

from workbench.definition import find
from workbench.plant import ONE_MASS, TWO_MASS, Plant
from workbench.tracing.candidates import candidates_of


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
    assert ((name, place) in {(c.effect, c.at) for c in candidates_of(plant)}) is offered


def test_a_damper_of_one_mass_is_viscous_friction_and_is_declared_by_either_name():
    plant = Plant(ONE_MASS) + find("inertia") + find("linear_damping")(at="axis")
    assert ("linear_damping", "axis") not in {
        (c.effect, c.at) for c in candidates_of(Plant(ONE_MASS) + find("inertia"))
    }
    assert plant.effects[-1].at == "axis"
