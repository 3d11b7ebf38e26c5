"""A late clock between two encoders comes before anything in torque, and a joint that a fit lets carry nothing is said."""

import json
from dataclasses import replace

import pytest
from conftest import measured
from made_joints import BAND, K, joint, jointed

from workbench.campaign import load
from workbench.definition import find
from workbench.encoders.clocks import plain
from workbench.finding import CARRIES_NOTHING
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.inverse.wording import idle
from workbench.tracing.candidates import ADDITION, CORRECTION, Offer
from workbench.tracing.decimation import decimate
from workbench.tracing.skew import skew_of
from workbench.tracing.tracing import trace

KNOWN = {"inertia": True, "viscous": True}


def test_a_late_load_encoder_is_the_first_candidate_with_its_value_held():
    inverses = inverse_dynamics([joint(1, late=2e-3, zero=1e-3), joint(2, late=2e-3)], BAND)
    found = skew_of(inverses, jointed(**KNOWN))
    assert (found.candidate.key, found.candidate.kind) == ("clock_skew@sensor.load_position", ADDITION)
    clock = found.candidate.plant["clock_skew@sensor.load_position"]
    assert clock.parameters["offset"].value == pytest.approx(2e-3, rel=0.02)
    assert clock.parameters["skew"].value == 0.0 and all(p.fixed for p in clock.parameters.values())
    (offset, _) = found.parameters
    assert offset.low < 2e-3 < offset.high and not offset.fixed and "ms late" in found.sentence


def test_a_late_motor_encoder_is_told_by_the_drive():
    inverses = inverse_dynamics([joint(1, late=3e-3, motor=True), joint(2, late=3e-3, motor=True)], BAND)
    found = skew_of(inverses, jointed(**KNOWN))
    assert found.candidate.at == "sensor.position"
    assert found.late.values["offset"] == pytest.approx(3e-3, rel=0.05) and "position is read" in found.sentence


def test_a_clock_of_its_own_quartz_that_every_record_starts_anew_is_told_from_one_that_runs_on():
    records = [joint(1, gains=2e-4), joint(2, gains=2e-4), joint(3, gains=2e-4)]
    later = [replace(r, time=r.time + start) for r, start in zip(records, (0.0, 40.0, 95.0), strict=True)]
    found = skew_of(inverse_dynamics(later, BAND), jointed(**KNOWN))
    assert (found.candidate.key, found.candidate.name) == ("restarted_clock@sensor.load_position", "clock_skew")
    assert (
        found.late.values["skew"] == pytest.approx(2e-4, rel=0.02) and "from where each record begins" in found.sentence
    )
    on = [joint(1, gains=2e-4), *(joint(k, late=2e-4 * s, gains=2e-4) for k, s in ((2, 40.0), (3, 95.0)))]
    runs_on = [replace(r, time=r.time + start) for r, start in zip(on, (0.0, 40.0, 95.0), strict=True)]
    found = skew_of(inverse_dynamics(runs_on, BAND), jointed(**KNOWN))
    assert found.candidate.key == "clock_skew@sensor.load_position"
    assert found.late.values["skew"] == pytest.approx(2e-4, rel=0.02)


@pytest.mark.parametrize("law", [{}, {"loop": 0.5}, {"viscous": 3000.0}, {"zero": 1e-3}])
def test_what_is_no_clock_is_no_candidate(law):
    assert skew_of(inverse_dynamics([joint(1, **law), joint(2, **law)], BAND), jointed()) is None


def test_a_weight_that_nobody_declared_is_no_clock():
    swinging = [joint(1, weight=3000.0), joint(2, weight=3000.0)]
    assert skew_of(inverse_dynamics(swinging, BAND), jointed(inertia=True)) is None


def test_lateness_that_is_worth_no_torque_is_no_cause():
    inverses = inverse_dynamics([joint(1, late=1e-4, count=1e-7), joint(2, late=1e-4, count=1e-7)], BAND)
    assert skew_of(inverses, jointed(**KNOWN)) is not None
    assert skew_of(inverses, jointed(**KNOWN), worth=1.0) is None
    assert skew_of(inverses, jointed(**KNOWN), share=1.0) is None


def test_records_that_disagree_make_nothing_plain():
    late = skew_of(inverse_dynamics([joint(1, late=2e-3), joint(2, late=2e-3)], BAND), jointed(**KNOWN)).late.measured
    other = replace(late.records["r1"], value=5e-3, low=4.9e-3, high=5.1e-3)
    assert plain(late) and not plain(replace(late, records={**late.records, "r1": other}))


def test_a_clock_that_is_declared_is_not_asked_for_again():
    plant = jointed() + find("clock_skew")(at="sensor.load_position")
    assert skew_of(inverse_dynamics([joint(1, late=2e-3)], BAND), plant) is None


def test_a_value_that_the_angle_told_is_no_correction():
    """Only what was declared may have been declared wrong."""
    plant = jointed(**KNOWN) + find("clock_skew")(at="sensor.load_position", offset=2e-3, fixed=True)
    declared = [e.key for e in jointed(**KNOWN).effects]
    kinds = {s.key: s.kind for s in Offer(declared=declared).candidates(plant)}
    assert "clock_skew@sensor.load_position" not in kinds and kinds["inertia@load"] == CORRECTION


def test_a_joint_without_stiffness_carries_nothing_and_a_sound_one_carries():
    inverses = inverse_dynamics([joint(1), joint(2)], BAND)
    sound = identify(jointed(**KNOWN), inverses).plant
    assert idle(inverses, sound) is None
    assert sound["linear_stiffness@joint"].parameters["stiffness"].value == pytest.approx(K, rel=0.02)
    still = sound.with_values({"linear_stiffness@joint": {"stiffness": 0.0}, "linear_damping@joint": {"damping": 0.0}})
    found = idle(inverses, still)
    assert found.kind == CARRIES_NOTHING and "no torque" in found.sentence
    loose = idle(inverses, sound.with_values({"linear_stiffness@joint": {"stiffness": 1e-3 * K}}))
    assert "of the load's balance" in loose.sentence and loose.evidence["error"] > 0.9


def test_a_joint_of_which_no_law_is_declared_lacks_its_stiffness():
    """Declared with damping alone it carries nothing, and what it carries is what is missing."""
    moves = replace(joint(3, name="moves"), role="validation")
    declared = jointed(**KNOWN).without("linear_stiffness@joint")
    found = trace(
        declared, inverse_dynamics([joint(1), joint(2), moves], BAND), only={"linear_stiffness", "clock_skew"}
    )
    assert [c.effect for c in found.causes] == ["linear_stiffness"]
    stiffness = found.after.plant["linear_stiffness@joint"].parameters["stiffness"].value
    assert stiffness == pytest.approx(K, rel=0.02)


@pytest.mark.parametrize("name", ["kr300_axis1", "kr300_axis1_JmJl", "kr300_axis3", "kr300_axis3_JmJl"])
def test_the_clock_of_a_robots_link_encoder_is_the_first_candidate(name):
    campaign = load(measured("measured", name))
    inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    found = skew_of(inverses, campaign.plant)
    assert found.candidate.key == "clock_skew@sensor.load_position"
    assert 2.6e-3 < found.late.values["offset"] < 3.3e-3
    before = {e.key: e for e in campaign.plant.effects}  # nothing else is touched, a fixed inertia least
    assert {e.key: e for e in found.candidate.plant.effects if e.key in before} == before


@pytest.mark.parametrize("name", ["kr300_axis1", "kr300_axis1_JmJl"])
def test_of_a_stiff_robot_axis_the_fit_says_that_its_joint_carries_nothing(name):
    campaign = load(measured("measured", name))
    inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    assert idle(inverses, identify(campaign.plant, inverses).plant).kind == CARRIES_NOTHING


def test_of_two_masses_only_the_campaign_that_lacks_a_clock_gets_one(data):
    truth = json.loads((measured("campaigns_d") / "truth.json").read_text())
    for name in ("d01", "d08", "d14", "d17", "d21", "d27", "d30"):
        campaign = load(measured("campaigns_d", name))
        found = skew_of(decimate(inverse_dynamics(campaign.records, campaign.bandwidth)), campaign.plant)
        assert (found is not None) == ("clock_skew" in truth[name]["missing"]), name
        if found:
            assert found.late.values["offset"] == pytest.approx(truth[name]["parameters"]["skew_s"], rel=0.02)
