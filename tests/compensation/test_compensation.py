"""Compensation of named effects: the composed law, in lanes and in the oracle, and what it is worth."""

import numpy as np
import pytest

from workbench.compensation import READ, REFERENCE, Compensator, compensable, compensated, predicted, undone
from workbench.control import fixed_pd
from workbench.definition import find
from workbench.effects.play import play_bank
from workbench.errors import WorkbenchError
from workbench.kernel.step import build
from workbench.plant import ONE_MASS, TWO_MASS, Limits, Plant
from workbench.record import IDENTIFICATION
from workbench.robustness.document import controller_of, of_controller
from workbench.simulation import Loop, ScenarioArrays, simulate
from workbench.simulation.binding import bind
from workbench.simulation.criteria import Criteria
from workbench.simulation.given import REFERENCE as GIVEN
from workbench.simulation.given import given_of
from workbench.simulation.oracle import run_arrays
from workbench.simulation.recorded import record_of
from workbench.simulation.run import run_lanes

LOOP = Loop(5e-4, 2, 0.0, 0.0, 1e-6)
BASE = fixed_pd(60.0, 0.5)
INERTIA, COGGING = find("inertia")(inertia=0.01), find("cogging")(s1=0.1, order=400.0)
PLANT = Plant(ONE_MASS, (INERTIA, find("coulomb_friction")(coulomb=0.2), COGGING), limits=Limits(3.0))
SPRING = find("stop")(stiffness=2000.0, radius=1e-4)  # friction that yields before it slips
YIELDING = Plant(ONE_MASS, (INERTIA, SPRING, COGGING), limits=Limits(3.0))
N = 2000
SLOW = 0.005 * (1.0 - np.cos(2 * np.pi * LOOP.sample_time * np.arange(N)))
BOTH = Compensator.of(PLANT, ("coulomb_friction", "cogging"))


def followed(controller, lanes=1, plant=PLANT):
    return simulate(
        plant, LOOP, controller, ScenarioArrays(lanes), N * LOOP.sample_time, reference=SLOW
    ).following_error


@pytest.fixture(scope="module")
def alone():
    return float(followed(BASE)[0])


def test_lanes_and_the_oracle_agree_to_the_last_bit():
    controller = compensated(BASE, BOTH.but(delay=1, low_pass=300.0))
    lanes = ScenarioArrays(3, noise=0.01, seed=np.arange(3))
    given = given_of({GIVEN: SLOW}, 200, 3)
    bound = bind(PLANT, LOOP, controller, lanes, 200, Criteria(), given=given)
    fast, slow = run_lanes(bound)[0], run_arrays(bound)[0]
    assert all(np.array_equal(fast[n], slow[n] + 0.0) for n in ("q", "v", "u_c"))


def test_friction_that_yields_is_cancelled_from_what_is_measured():
    before = followed(BASE, plant=YIELDING)[0]
    named = Compensator.of(YIELDING, ("stop", "cogging"))
    assert followed(compensated(BASE, named), plant=YIELDING)[0] < before / 5


def test_coulomb_friction_from_what_is_measured_pushes_the_old_way_until_the_axis_turns(alone):
    """Its direction is that of a motion that has not begun, so the reference is its source."""
    assert followed(compensated(BASE, BOTH))[0] > alone / 3


def test_its_gain_may_differ_from_lane_to_lane_and_the_best_is_near_one(alone):
    gains = np.array([0.0, 0.7, 1.0, 1.3])
    made = compensated(BASE, BOTH.but(source=REFERENCE))
    made = type(made)(made.name, made.law, {**made.parameters, "comp_gain": gains})
    found = followed(made, 4)
    assert found[0] == pytest.approx(alone, rel=1e-12)
    assert np.argmin(found) == 2 and max(found[1], found[3]) < 0.8 * alone


def test_a_late_compensation_is_worth_less(alone):
    at_once, later = (followed(compensated(BASE, BOTH.but(source=REFERENCE, delay=d)))[0] for d in (0, 60))
    assert at_once < later < alone


def test_from_the_reference_what_is_named_no_longer_costs_following_error(alone):
    assert followed(compensated(BASE, BOTH.but(source=REFERENCE)))[0] < alone / 5


def test_from_an_observer_too():
    watching = Compensator.of(YIELDING, ("stop", "cogging"), source="observer", mass=0.01, bandwidth=200.0)
    assert followed(compensated(BASE, watching), plant=YIELDING)[0] < followed(BASE, plant=YIELDING)[0] / 3


def test_one_law_is_made_for_all_values():
    first, second = (compensated(BASE, BOTH.but(gain=g)) for g in (1.0, 0.5))
    assert first.law is second.law and first.law is not BASE.law
    with pytest.raises(WorkbenchError, match="compensated already"):
        compensated(first, BOTH)


def test_a_document_holds_it_and_gives_the_same_law_back():
    for c in (BOTH, BOTH.but(source="observer", mass=0.01, bandwidth=100.0, delay=2)):
        made = compensated(BASE, c)
        again = controller_of(of_controller(made))
        assert again.law is made.law and dict(again.parameters) == dict(made.parameters)


def test_an_encoder_s_error_is_undone_at_the_reference():
    error = find("encoder_eccentricity")(sine=0.5, at="sensor.position")
    plant = Plant(ONE_MASS, (find("inertia")(inertia=0.01), error), limits=Limits(3.0))
    blind = followed(BASE, plant=plant)[0]
    assert followed(compensated(BASE, Compensator.of(plant, ("encoder_eccentricity",))), plant=plant)[0] < blind / 2


def test_along_a_record_it_adds_what_the_effect_takes():
    t = 1e-3 * np.arange(3000)
    q = 0.03 * np.sin(2 * np.pi * t)
    record = record_of("slow", IDENTIFICATION, PLANT, t, {"torque": 0.0 * t, "position": q}, {}, "a sine")
    adds = predicted(BOTH, record)
    way = np.sign(np.diff(q, prepend=q[0]))
    expected = 0.2 * way + 0.1 * np.sin(400.0 * q)
    assert np.abs(adds - expected)[5:].max() < 0.41 and np.median(np.abs(adds - expected)) < 1e-9


def test_a_play_bank_is_undone_exactly():
    bank = play_bank((0.1, 0.4), (2.0, 1.0, -0.5))
    x = np.cumsum(np.random.default_rng(3).standard_normal(500)) * 0.1

    def run(effect, signal):
        values = {n: p.value for n, p in effect.parameters.items()}
        return np.array([values[n] for n in effect.linear]) @ build(effect).run(
            {"dq": np.diff(signal, prepend=0.0)}, values
        )

    assert np.abs(run(undone(bank), run(bank, x)) - x).max() < 1e-12
    with pytest.raises(WorkbenchError, match="no exact inverse"):
        undone(find("cogging"))


def test_what_no_drive_can_cancel_is_refused_in_a_sentence():
    joint = find("linear_stiffness")(stiffness=100.0, at="joint")
    for effects, said in (
        ((joint,), "acts on both"),
        ((find("inertia")(inertia=1.0),), "take the reference"),
        ((find("transport_delay"),), "no force"),
        ((), "needs an effect"),
    ):
        with pytest.raises(WorkbenchError, match=said):
            Compensator(effects, source=READ)
    for options, said in (
        ({"source": "model"}, "no source"),
        ({"delay": -1}, "whole"),
        ({"source": "observer"}, "mass"),
    ):
        with pytest.raises(WorkbenchError, match=said):
            BOTH.but(**options)
    with pytest.raises(WorkbenchError, match="effects 'coging'"):
        Compensator.of(PLANT, ("coging",))


def test_what_can_be_compensated_of_a_plant_is_said():
    plant = Plant(
        TWO_MASS, (find("inertia")(inertia=1.0, at="motor"), find("coulomb_friction")(coulomb=0.1, at="motor"))
    )
    assert [e.name for e in compensable(plant)] == ["coulomb_friction"]
    assert compensable(PLANT) == PLANT.effects[1:]
