"""A constant force beside dry friction: a part of that friction is its asymmetry, more is a load."""

from types import SimpleNamespace

import pytest
from test_otherwise import PLANT, recorded

from workbench.definition import find
from workbench.effects.free_bank import hysteresis_bank
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, TWO_MASS, Plant
from workbench.record import IDENTIFICATION
from workbench.tracing import ranking
from workbench.tracing.candidates import ADDITION, Offer
from workbench.tracing.judge import STANDARD
from workbench.tracing.one_sided import ASYMMETRY, OFFSET, PART, _dry_friction, asked_freely, one_sided
from workbench.tracing.state import State

FRICTION = 0.3  # N*m, of the records


def judgement(
    effect: str, plant: Plant, kind: str = ADDITION, *, earns: bool = True, family: str = "", at: str = "axis"
):
    return SimpleNamespace(
        candidate=SimpleNamespace(effect=effect, at=at, key=f"{effect}@{at}", kind=kind, family=family),
        refitted=SimpleNamespace(plant=plant),
        score=SimpleNamespace(earns=earns),
    )


def asymmetry(difference: float, friction: float = 10.0, **more):
    plant = Plant(ONE_MASS) + find("coulomb_friction")(coulomb=friction)
    return judgement(ASYMMETRY, plant + find(ASYMMETRY)(coulomb_difference=difference), **more)


OF_A_LOAD = judgement(OFFSET, Plant(ONE_MASS) + find(OFFSET), family="force over position")


@pytest.mark.parametrize(("share", "asymmetric"), [(0.9 * PART, True), (-0.9 * PART, True), (1.1 * PART, False), (-3.0, False)])  # fmt: skip
def test_at_most_half_of_the_dry_friction_is_its_asymmetry_and_more_a_load(share, asymmetric):
    other = asymmetry(10.0 * share)
    assert one_sided(OF_A_LOAD, [OF_A_LOAD, other]) is (other if asymmetric else OF_A_LOAD)


def test_of_two_masses_a_constant_at_the_load_is_the_asymmetry_of_the_motor_s_friction():
    """The joint carries a constant from one body to the other, and a lead screw's came out at the load."""
    load = judgement(OFFSET, Plant(TWO_MASS) + find(OFFSET)(at="load"), at="load")
    plant = Plant(TWO_MASS) + find("coulomb_friction")(at="motor", coulomb=10.0)
    motor = judgement(ASYMMETRY, plant + find(ASYMMETRY)(at="motor", coulomb_difference=3.0), at="motor")
    assert one_sided(load, [load, motor]) is motor
    plant = plant + find("coulomb_friction")(at="load", coulomb=10.0)
    own = judgement(ASYMMETRY, plant + find(ASYMMETRY)(at="load", coulomb_difference=3.0), at="load")
    assert one_sided(load, [load, motor, own]) is own


def test_what_is_not_certain_has_no_friction_or_is_no_missing_force_stays():
    unsure, smooth = asymmetry(1.0, earns=False), asymmetry(1.0, friction=0.0)
    for level in ([unsure], [smooth], []):
        assert one_sided(OF_A_LOAD, level) is OF_A_LOAD
    corrected = judgement(OFFSET, OF_A_LOAD.refitted.plant, "correction")
    assert one_sided(corrected, [asymmetry(1.0)]) is corrected
    spring = judgement("cable_spring", OF_A_LOAD.refitted.plant)
    assert one_sided(spring, [asymmetry(1.0)]) is spring


def test_beside_an_asymmetry_that_is_a_constant_no_curve_over_position_is_asked():
    """It would be the constant, and what else lives there, and be named after the constant."""
    waves, best = judgement("cogging", OF_A_LOAD.refitted.plant, family="force over position"), asymmetry(1.0)
    assert asked_freely(best, [best, OF_A_LOAD, waves]) == [best]
    large = asymmetry(9.0)
    assert asked_freely(large, [large, OF_A_LOAD, waves]) == [large, OF_A_LOAD, waves]
    assert asked_freely(waves, [waves, OF_A_LOAD]) == [waves, OF_A_LOAD]


def test_dry_friction_is_what_slides_whatever_law_it_has():
    coulomb = find("coulomb_friction")(coulomb=2.0)
    hysteresis = find("presliding_hysteresis")(h0=3.0, x0=1e-3)
    bank = hysteresis_bank((1e-4, 3e-4, 1e-3), (0.5, 0.8, 1.0), 4.0, "axis")
    for effects, friction in (((coulomb,), 2.0), ((hysteresis,), 3.0), ((bank,), 4.0), ((), 0.0)):
        assert _dry_friction(Plant(ONE_MASS, effects), "axis") == pytest.approx(friction)
        assert _dry_friction(Plant(ONE_MASS, effects), "load") == 0.0


@pytest.mark.parametrize(("force", "name"), [(0.25 * FRICTION, ASYMMETRY), (0.9 * FRICTION, OFFSET)])
def test_of_a_round_the_one_leads_that_the_friction_says(force, name):
    records = [recorded(n, IDENTIFICATION, s, lambda v: force + 0.0 * v, 5.0) for n, s in (("a", 1.0), ("bb", 0.7))]
    state = State(PLANT, inverse_dynamics(records, 50.0))
    leads = ranking.step(state, lambda _: None, Offer(only={OFFSET, ASYMMETRY, "cable_spring"}), STANDARD)[0]
    assert leads.candidate.effect == name and leads.score.earns
