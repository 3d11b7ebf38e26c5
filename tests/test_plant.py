"""Plants: composition, what is refused, and a digest that changes if and only if a fact changes."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.definition import COMMAND, FORCE, TIME, catalogue, find
from workbench.errors import WorkbenchError
from workbench.plant import KINDS, ONE_MASS, TWO_MASS, Geometry, Limits, Plant, places


def declared() -> Plant:
    plant = Plant(ONE_MASS, geometry=Geometry(30.0, 5.0), limits=Limits(3.0, 20.0))
    plant = plant + find("inertia")(inertia=2e-3, fixed=True) + find("viscous_friction")(viscous=0.01)
    return plant + find("presliding_hysteresis")(h0=0.15, x0=1e-3)


# --- composition ------------------------------------------------------------------------------------------------------


def test_a_plant_is_composed_and_not_changed():
    plant = declared()
    more = plant + find("cogging")(order=60.0)
    assert "cogging" not in plant and "cogging" in more and "cogging@axis" in more
    assert more.without("cogging") == plant
    assert more["cogging"].parameters["order"].value == 60.0
    assert plant.swap(find("inertia")(inertia=5.0))["inertia"].parameters["inertia"].value == 5.0
    moved = plant.with_values({"inertia@axis": {"inertia": 4e-3}})
    assert moved["inertia"].parameters["inertia"].value == 4e-3 and moved["inertia"].parameters["inertia"].fixed
    assert plant["inertia"].parameters["inertia"].value == 2e-3


def test_an_effect_acts_once_at_a_place_and_may_act_at_two():
    with pytest.raises(
        WorkbenchError,
        match="effect 'inertia' acts twice at 'axis'; declare it once, or give each of them a label of its own.",
    ):
        declared() + find("inertia")
    two = Plant(TWO_MASS) + find("inertia")(at="motor") + find("inertia")(at="load")
    assert two["inertia@load"].at == "load"
    with pytest.raises(WorkbenchError, match="the plant has 2 effects 'inertia'"):
        two["inertia"]


def test_what_is_not_there_is_refused_with_the_nearest():
    with pytest.raises(WorkbenchError, match="the plant has 0 effects 'inertai'; did you mean 'inertia@axis'"):
        declared()["inertai"]
    with pytest.raises(WorkbenchError, match="the plant has 0 effects 'cogging'"):
        declared().without("cogging")
    with pytest.raises(WorkbenchError, match="unknown plant 'one-mass'; did you mean 'one mass'"):
        Plant("one-mass")


@pytest.mark.parametrize(
    ("kind", "name", "at", "sentence"),
    [
        (ONE_MASS, "inertia", "motor", "effect 'inertia' cannot act at 'motor' on a plant of one mass; known: axis."),
        (
            ONE_MASS,
            "linear_stiffness",
            "joint",
            "effect 'linear_stiffness' cannot act at 'joint' on a plant of one mass",
        ),
        (TWO_MASS, "inertia", "axis", "effect 'inertia' cannot act at 'axis' on a plant of two masses"),
        (ONE_MASS, "transport_delay", "axis", "effect 'transport_delay' cannot act at 'axis'"),
        (TWO_MASS, "stribeck_friction", "joint", "effect 'stribeck_friction' cannot act at 'joint'"),
    ],
)
def test_wrong_places_are_refused(kind, name, at, sentence):
    with pytest.raises(WorkbenchError, match=sentence):
        Plant(kind) + find(name)(at=at)


def test_a_weight_on_a_linear_axis_is_refused():
    with pytest.raises(WorkbenchError, match="effect 'gravity' exists on a rotary axis only; this one is linear."):
        Plant(ONE_MASS, rotary=False) + find("gravity")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", catalogue())
def test_every_effect_composes_wherever_it_can_act(kind, name):
    effect = find(name)
    for at in places(kind, effect):
        assert (Plant(kind) + effect(at=at))[f"{name}@{at}"].at == at
    if effect.port == FORCE:
        assert not any(p.startswith(("command", "sensor")) for p in places(kind, effect))
    if effect.port in (COMMAND, TIME) and "command" in effect.places:
        assert "command" in places(kind, effect)


# --- the digest -------------------------------------------------------------------------------------------------------


def named(before: Plant, after: Plant) -> set[str]:
    """What differs between two digests, by the first words of their lines."""
    lines = set(before.digest_lines()) ^ set(after.digest_lines())
    return {line.split()[0] for line in lines}


CHANGES = {
    "inertia@axis.inertia": lambda p: p.with_values({"inertia@axis": {"inertia": 2.001e-3}}),
    "presliding_hysteresis@axis.x0": lambda p: p.with_values({"presliding_hysteresis@axis": {"x0": 1.001e-3}}),
    "geometry.gear_ratio": lambda p: replace(p, geometry=Geometry(31.0, 5.0)),
    "geometry.pole_pairs": lambda p: replace(p, geometry=Geometry(30.0, 6.0)),
    "limits.drive": lambda p: replace(p, limits=Limits(3.1, 20.0)),
    "limits.speed": lambda p: replace(p, limits=Limits(3.0, 21.0)),
    "rotary": lambda p: replace(p, rotary=False),
    "constant_offset@axis.offset": lambda p: p + find("constant_offset"),
    "viscous_friction@axis.viscous": lambda p: p.without("viscous_friction"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_changed_fact_changes_the_digest_and_is_named(name):
    before = declared()
    after = CHANGES[name](before)
    assert after.digest != before.digest
    assert named(before, after) == {name}


def test_what_behaviour_does_not_depend_on_leaves_the_digest():
    plant = declared()
    assert declared().digest == plant.digest
    assert plant.swap(plant["inertia"].free("inertia")).digest == plant.digest  # held or free: the same axis
    backwards = Plant(ONE_MASS, tuple(reversed(plant.effects)), geometry=plant.geometry, limits=plant.limits)
    assert backwards.digest == plant.digest
    assert plant.with_values({"inertia@axis": {"inertia": 2e-3 * (1 + 1e-13)}}).digest == plant.digest


@settings(max_examples=50, deadline=None)
@given(st.floats(1e-6, 1e3), st.floats(1e-6, 1e3))
def test_digests_differ_exactly_where_nine_digits_do(a, b):
    one, other = (declared().with_values({"inertia@axis": {"inertia": v}}) for v in (a, b))
    assert (one.digest == other.digest) == (f"{a:.9g}" == f"{b:.9g}")
