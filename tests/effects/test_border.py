"""What is written of an effect otherwise than it is fitted: what is held of it is held, whatever else is free."""

from math import atan2, hypot
from pathlib import Path

import numpy as np
import pytest

from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.identification.by_record import held
from workbench.identification.fit import identify
from workbench.inverse.balances import predicted
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, Record, Source

MGL, PHASE = 1.9, 0.4
ALONE = Plant(ONE_MASS) + find("inertia")(inertia=0.02)


def declared(name: str, values: dict[str, float], **fixed: bool):
    return find(name).declared(values, fixed, "campaign.toml")


def weight(fixed: dict[str, bool] | None = None, mgl: float = MGL, phase: float = PHASE):
    return declared("gravity", {"mgl": mgl, "phase": phase}, **(fixed or {}))


@pytest.fixture(scope="module")
def inverses():
    """An arm that swings by a radian, of which inertia and weight are all."""
    t = np.arange(4000) / 1000.0
    q = np.sin(2 * np.pi * 0.8 * t) + 0.3 * np.sin(2 * np.pi * 1.9 * t)
    a = np.gradient(np.gradient(q, 1e-3), 1e-3)
    drive = 0.02 * a + MGL * np.sin(q + PHASE)
    record = Record(
        "swing", IDENTIFICATION, t, {"torque": drive, "position": q}, {}, Source(Path("made"), "", "made", {}), {}
    )
    return inverse_dynamics([record], 20.0)


@pytest.mark.parametrize(("fixed", "free"), [
    ({"mgl": True, "phase": False}, ["phase"]), ({"mgl": False, "phase": True}, ["mgl"]),
    ({"mgl": False, "phase": False}, ["sine", "cosine"]), ({"mgl": True, "phase": True}, []), ({"mgl": True}, ["phase"]),
])  # fmt: skip
def test_of_a_weight_what_is_held_is_held_and_nothing_else(fixed, free, inverses):
    effect = weight(fixed)
    assert [n for n, p in effect.parameters.items() if not p.fixed] == free
    both = [predicted(inverses[0], ALONE + e) for e in (effect, weight())]
    assert np.allclose(*both, atol=1e-12)


def test_a_weight_that_is_known_keeps_it_where_its_phase_is_fitted(inverses):
    """Free, both amplitudes would take what the data sheet has wrong, and nobody would be told."""
    for mgl, left in ((MGL, 0.01), (0.9 * MGL, 0.05)):
        fit = identify(ALONE + weight({"mgl": True, "phase": False}, mgl, 0.1), inverses)
        found = fit.plant["gravity@axis"].outside
        assert found["mgl"].value == mgl and found["phase"].value == pytest.approx(PHASE, abs=0.05)
        assert (fit.identification > left) == (mgl != MGL)


def test_a_weight_at_a_known_place_is_found_by_its_size_alone(inverses):
    fit = identify(ALONE + weight({"mgl": False, "phase": True}, 0.1), inverses)
    assert fit.plant["gravity@axis"].parameters["mgl"].value == pytest.approx(MGL, rel=0.01)


def test_two_weights_as_they_are_written_share_one_step():
    """A kernel is kept under its step, and a round of the search makes hundreds of plants."""
    one, other = weight({"mgl": True, "phase": False}), weight({"mgl": True, "phase": False}, 2.0)
    assert one.step == other.step and hash(one.step) == hash(other.step)
    assert {*one.outside} == {*weight().outside} == {"mgl", "phase"}


def test_a_rate_that_is_held_holds_the_length_whatever_the_height_is():
    values = {"h0": 3.0, "a": 2000.0}
    held = declared("presliding_hysteresis", values, h0=False, a=True).parameters
    assert held["x0"].fixed and not held["h0"].fixed
    free = declared("presliding_hysteresis", values, h0=True, a=False).parameters
    assert not free["x0"].fixed and free["h0"].fixed


def test_a_cable_s_stiffness_may_be_held_and_its_rest_free():
    cable = declared("cable_spring", {"stiffness": 4.0, "rest": 0.2}, stiffness=True, rest=False)
    assert cable.parameters["stiffness"].fixed and not cable.parameters["preload"].fixed


def test_a_cable_s_rest_may_be_held_and_its_stiffness_free():
    """Inside, a free preload beside a free stiffness would move the rest."""
    cable = declared("cable_spring", {"stiffness": 4.0, "rest": 0.2}, stiffness=False, rest=True)
    assert cable.parameters["rest"].fixed and not cable.parameters["stiffness"].fixed
    assert cable.linear == ("stiffness",)


@pytest.mark.parametrize("name", ["gravity", "cable_spring", "cogging", "kinematic_error", "presliding_hysteresis"])
def test_an_effect_of_which_nothing_is_written_is_held_as_the_catalogue_holds_it(name):
    assert {n: p.fixed for n, p in declared(name, {}).parameters.items()} == {n: p.fixed for n, p in find(name).parameters.items()}  # fmt: skip


@pytest.mark.parametrize(("name", "values", "fixed", "stay"), [
    ("cable_spring", {"stiffness": 4.0, "rest": 0.2}, {"stiffness": True, "rest": False}, {"stiffness"}),
    ("cable_spring", {"stiffness": 4.0, "rest": 0.2}, {"stiffness": False, "rest": True}, {"rest"}),
    ("presliding_hysteresis", {"h0": 3.0, "a": 2000.0, "d": 0.8}, {"h0": False, "a": True, "d": True}, {"a", "d"}),
    ("gravity", {"mgl": 0.0, "phase": 0.0}, {"mgl": False, "phase": False}, set()),
    ("gravity", {"mgl": 1.0, "phase": 0.4}, {"mgl": True, "phase": True}, {"mgl", "phase"}),
])  # fmt: skip
def test_what_is_held_of_an_effect_is_that_of_which_nothing_inside_is_free(name, values, fixed, stay):
    assert {*held(declared(name, values, **fixed))} == stay


def test_amplitudes_are_those_of_the_weight_that_is_written():
    p = weight().parameters
    s, c = p["sine"].value, p["cosine"].value
    assert (hypot(s, c), atan2(c, s)) == (pytest.approx(MGL), pytest.approx(PHASE))


def test_a_value_that_is_none_inside_is_said_as_it_is_written():
    with pytest.raises(WorkbenchError, match="campaign.toml"):
        declared("presliding_hysteresis", {"h0": 1.0, "a": -2.0})
