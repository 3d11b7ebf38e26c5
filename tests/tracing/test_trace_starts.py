"""Which orders records can show, and effects that a study offers the trace beside those of the catalogue."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from made_joints import JL, RATE, K, joint, jointed, waved

from workbench.definition import find
from workbench.inverse.bodies import POSITION
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.plant import ONE_MASS, TWO_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record, Source
from workbench.tracing import search
from workbench.tracing.budget import BUDGET, Budget
from workbench.tracing.candidates import WHOLE, Offer
from workbench.tracing.judge import ahead
from workbench.tracing.search import within_reach
from workbench.tracing.starts import lateness, resolved, starts, strokes
from workbench.tracing.tracing import trace

COUNT, DT, BAND = 1e-4, 2e-3, 50.0
T = DT * np.arange(20000)
SOURCE = Source(Path("made"), "", "made", {})


def inverses(position: np.ndarray, force: np.ndarray, count: float = COUNT) -> tuple[InverseDynamics, ...]:
    channels = {"position": position.copy(), "force": force.copy()}
    record = Record("made", IDENTIFICATION, T.copy(), channels, {}, SOURCE, {"position": count} if count else {})
    return inverse_dynamics([record], BAND)


def test_no_order_is_finer_than_half_of_what_the_counts_sample():
    """At 5 mm/s and below a wave of two counts passes in the band, so the encoder is what limits."""
    slow = inverses(0.05 * np.sin(0.1 * T), 0 * T)
    assert resolved(slow) == pytest.approx(np.pi / COUNT)


@pytest.mark.parametrize("channel", ["position", "load_position"])
def test_two_encoders_tell_where_a_clock_starts(channel):
    """A clock that is late and gains: to one encoder as much as the other is early."""
    late, gains = 1e-3, -1e-4
    records = [joint(k, late=late, gains=gains, motor=channel == "position") for k in (1, 2)]
    plant = jointed(inertia=True, viscous=True)
    found = lateness(inverse_dynamics(records, 30.0), plant, channel)
    assert found["time"] == pytest.approx(late, rel=0.05) and found["drift"] == pytest.approx(gains, rel=0.05)


def test_one_encoder_tells_nothing_of_its_clock():
    axis = Plant(ONE_MASS, ()) + find("inertia")(inertia=1.0)
    assert lateness(inverses(np.sin(T), 0 * T), axis, "position") == {}


def test_no_order_passes_faster_than_the_evaluation_filter():
    """A ramp at 2 m/s: f_c = 50 Hz is an order of 2 pi 50/2 per metre."""
    fast = inverses(2.0 * T, 0 * T, count=0.0)
    assert resolved(fast) == pytest.approx(2 * np.pi * BAND / 2.0, rel=0.01)


def test_a_residual_that_follows_the_counts_starts_no_wave_of_their_pitch():
    """Rounded to counts, a position seen through a wave of the encoder's own pitch is constant or slow: an alias."""
    q = np.round(0.05 * np.sin(0.1 * T) / COUNT) * COUNT
    given = inverses(q, np.cos(2 * np.pi / (1.01 * COUNT) * q))
    plant = Plant(ONE_MASS, rotary=False) + find("coulomb_friction")
    found = starts(find("cogging"), given, [given[0].motion.u], plant)
    assert found and max(s["order"] for s in found) <= np.pi / COUNT


def test_a_budget_bounds_how_many_starts_a_candidate_has():
    given = inverses(0.05 * np.sin(0.1 * T), np.sin(3.0 * T))
    plant = Plant(ONE_MASS, rotary=False) + find("coulomb_friction")
    every = starts(find("presliding_hysteresis"), given, [given[0].motion.u], plant)
    few = starts(find("presliding_hysteresis"), given, [given[0].motion.u], plant, Budget(strokes=2))
    assert len(few) == 2 < len(every) and few[0] == every[0] and few[-1] == every[-1]
    assert (
        starts(find("cogging"), given, [given[0].motion.u], plant, Budget(starts=1))
        == starts(find("cogging"), given, [given[0].motion.u], plant)[:1]
    )


def test_the_search_keeps_orders_between_one_period_of_travel_and_what_is_resolved():
    given = inverses(0.05 * np.sin(0.1 * T), 0 * T)
    plant = Plant(ONE_MASS, rotary=False) + find("cogging")(order=1e6)
    p = within_reach(plant, given)["cogging"].parameters["order"]
    assert p.lower == pytest.approx(2 * np.pi / np.ptp(given[0].motion.q))
    assert p.upper == p.value == pytest.approx(np.pi / COUNT)


def test_where_the_zeros_of_encoders_were_found_no_wave_has_a_zero_of_its_own():
    """It could be any, since the joint's mean torque is no reading there: far away, the gear's ratio makes a ripple of a torque that is not there."""
    for zeroed in (False, True):
        offered = {c.key: c.plant[c.key] for c in Offer(zeroed=zeroed).candidates(jointed(inertia=True, viscous=True))}
        for key in ("kinematic_error@joint", "encoder_eccentricity@sensor.load_position"):
            assert offered[key].parameters["zero"].fixed is zeroed


# --- a study's own effects ------------------------------------------------------------------------------------------------


def test_what_a_study_offers_is_a_candidate_like_any_other():
    plant = Plant(ONE_MASS, rotary=False) + find("coulomb_friction")
    known = {s.effect for s in WHOLE.candidates(plant)}
    offered = (find("presliding_length"), find("cogging")(order=7.0, label="pitch"))
    assert {s.effect for s in Offer(own=offered).candidates(plant)} - known == {"presliding_length", "cogging pitch"}
    # a second source of the direction of motion at one place is not offered, whoever offers it
    held = plant + find("presliding_hysteresis")
    assert "presliding_length" not in {s.effect for s in Offer(own=offered).candidates(held)}


def test_an_offered_presliding_length_is_found_and_comes_out_right():
    q = 1e-3 * np.sin(0.8 * T) + 0.4e-3 * np.sin(2.3 * T)
    w, force = 0.0, np.zeros(T.size)
    for i, step in enumerate(np.diff(q, prepend=q[0])):
        w = min(max(w + step, -2e-4), 2e-4)
        force[i] = 3.0 * w / 2e-4
    force += 0.02 * np.random.default_rng(1).normal(size=T.size)
    given = inverses(q, force, count=1e-7)
    plant = Plant(ONE_MASS, rotary=False) + find("constant_offset") + find("coulomb_friction")
    names = ("presliding_length", "fading_memory", "stribeck_friction", "coulomb_asymmetry")
    found = trace(plant, given, most=2, only=names, own=(find("presliding_length"),))
    assert found.added == ("presliding_length",)
    values = {e.parameter: e.value for e in found.after.estimates}
    assert values["length"] == pytest.approx(2e-4, rel=0.01) and values["coulomb"] == pytest.approx(3.0, rel=0.01)


def test_an_order_that_the_rig_makes_known_is_held():
    turn = find("cogging")(label="turn")
    turn = replace(
        turn, parameters={**turn.parameters, "order": replace(turn.parameters["order"], value=900.0, fixed=True)}
    )
    q = 0.02 * np.sin(0.8 * T) + 0.011 * np.sin(2.3 * T)
    force = 5.0 * np.tanh(1e3 * np.gradient(q, DT)) + np.sin(900.0 * q + 0.4)
    given = inverses(q, force + 0.05 * np.random.default_rng(2).normal(size=T.size), count=1e-7)
    plant = Plant(ONE_MASS, rotary=False) + find("coulomb_friction")
    found = trace(plant, given, most=1, only=("cogging turn", "cable_spring"), own=(turn,))
    assert found.added == ("cogging",) and found.causes[0].effect == "cogging turn"
    values = {e.parameter: e.value for e in found.causes[0].parameters}
    assert values["amplitude"] == pytest.approx(1.0, rel=0.02) and values["phase"] == pytest.approx(0.4, abs=0.02)
    assert values["order"] == pytest.approx(900.0)


def test_starts_of_a_wave_that_has_no_size_yet_are_not_all_tried():
    """Of a map two starts that come to the same tell that none changes anything; what adds a column is tried everywhere."""
    tried = []
    options = [np.array([float(k)]) for k in range(5)]

    def costs(*values, beside=None):
        tried.clear()
        left = list(values)
        cost = lambda theta, roughly: (tried.append(theta), left.pop(0))[1]  # noqa: E731
        return search.worth(SimpleNamespace(cost=cost, beside=beside), options, BUDGET.refined)

    assert costs(2.0, 2.0, 1.0, 1.0, 1.0) == [2.0, 2.0] and len(tried) == 2
    assert len(costs(2.0, 2.0, 1.0, 1.0, 1.0, beside="a force")) == 5
    assert len(costs(2.0, 1.9, 1.0, 1.0, 1.0)) == 5
    assert len(costs(np.inf, np.inf, 1.0, 1.0, 1.0)) == 5  # outside its domain, which the next may not be


@pytest.mark.parametrize("at", ["motor", "joint"])
def test_strokes_reach_from_counts_to_what_is_travelled_there(at):
    """An axis that turns by 2 rad, a joint that gives way by 10 mrad, counts of 0.1 mrad."""
    t = np.linspace(0.0, 1.0, 1001)
    joint = (None, {POSITION: 5e-3 * np.sin(30 * t)})
    bodies = SimpleNamespace(body=lambda plant, place: joint)
    given = [SimpleNamespace(motion=SimpleNamespace(q=np.sin(7 * t), counts=1e-4), bodies=bodies)]
    found = np.array(strokes(given, None, at))
    reach = 0.2 * 2.0 if at == "motor" else 0.5 * 10e-3
    np.testing.assert_allclose(found[[0, -1]], [4e-4, reach], rtol=0.01)
    assert np.all(np.diff(found) > 0) and found.size <= 6
    assert np.max(found[1:] / found[:-1]) <= 8.0


def test_a_gap_of_a_stiff_joint_is_begun_within_what_the_joint_gives_way():
    """The joint gives way by some 10 urad, and a gap of its default half width, 0.1 mrad, would hold all of it."""
    t = np.arange(3000) / RATE
    load, passing = waved(t, 3, 0), JL * waved(t, 3, 2)
    motor = load + passing / (100.0 * K)
    record = Record("r", IDENTIFICATION, t, {"torque": passing, "position": motor, "load_position": load}, {}, SOURCE)
    found, plant = inverse_dynamics([record], BAND), jointed(inertia=True)
    gap = find("backlash")
    begun = [np.exp(s["half_width"]) for s in starts(gap, found, [passing], plant + gap)]
    gives = np.ptp(motor - load)
    assert (
        len(begun) > 1
        and max(begun) == pytest.approx(0.5 * gives, rel=0.1)
        and gives < gap.parameters["half_width"].value
    )


def offered(plant: Plant) -> dict[str, Plant]:
    """Return key -> plant of each candidate."""
    return {s.key: s.plant for s in Offer(declared=[e.key for e in plant.effects]).candidates(plant)}


def test_two_waves_share_the_zero_of_the_angle_between_two_encoders():
    first = find("kinematic_error")(at="joint", order=52.0)
    assert not first.parameters["zero"].fixed
    second = offered(Plant(TWO_MASS) + find("linear_stiffness") + first)["kinematic_error 2@joint"][
        "kinematic_error 2@joint"
    ]
    assert second.parameters["zero"].fixed and not second.parameters["order"].fixed


def test_the_second_eccentricity_of_a_disc_is_its_second_harmonic():
    disc = find("encoder_eccentricity")(at="sensor.load_position")
    (again,) = [
        p for key, p in offered(Plant(TWO_MASS) + disc).items() if key == "encoder_eccentricity 2@sensor.load_position"
    ]
    turns = again["encoder_eccentricity 2@sensor.load_position"].parameters["turns"]
    assert turns.value == 2.0 and turns.fixed


def test_what_bends_a_spring_to_ground_is_offered_beside_a_declared_one_and_a_bumper_without_any():
    bare = Plant(ONE_MASS, rotary=False) + find("inertia")
    sprung = bare + find("linear_stiffness")(at="axis")
    assert "cubic_stiffness@axis" in offered(sprung) and "cubic_stiffness@axis" not in offered(bare)
    key = "piecewise_stiffness@axis"
    assert not offered(sprung)[key][key].parameters["k1"].fixed
    about_zero = offered(bare)[key][key].parameters["k1"]
    assert about_zero.fixed and about_zero.value == 0.0
    # one that is met at once is a spring, and gives way to it
    assert [[c.yields for c in WHOLE.candidates(p) if c.key == key] for p in (bare, sprung)] == [[True], [False]]
    assert not offered(Plant(TWO_MASS))["piecewise_stiffness@joint"]["piecewise_stiffness@joint"].parameters["k1"].fixed


def test_a_bumper_takes_no_place_among_the_candidates_that_are_fitted_with_everything_free():
    by = {c.key: c for c in WHOLE.candidates(Plant(ONE_MASS, rotary=False) + find("inertia"))}
    keys = ("cogging@axis", "piecewise_stiffness@axis", "cable_spring@axis", "creep@axis")
    order = [SimpleNamespace(candidate=by[key]) for key in keys]
    assert [ahead(order, n) for n in (1, 2, 9)] == [order[:1], order[:3], order]


def test_a_slide_that_meets_a_bumper_at_both_ends_has_no_cable():
    """Rubber beyond 60 mm of 80: 3000 N/m; nothing pulls in between, and no spring is declared."""
    rng = np.random.default_rng(5)

    def record(name: str, role: str, w: float) -> Record:
        t = T[:3000]
        q = 0.08 * np.sin(w * t) * np.cos(0.31 * w * t)
        a = np.gradient(np.gradient(q, DT, edge_order=2), DT, edge_order=2)
        bumper = 3000.0 * np.sign(q) * np.maximum(np.abs(q) - 0.06, 0.0)
        drive = 8.0 * a + bumper + 0.3 * rng.standard_normal(t.size)
        return Record(name, role, t, {"position": q, "force": drive}, {}, SOURCE, {"position": 1e-6})

    plant = Plant(ONE_MASS, rotary=False) + find("inertia")(inertia=7.0)
    records = [
        record("slow", IDENTIFICATION, 3.0),
        record("fast", IDENTIFICATION, 7.0),
        record("moves", VALIDATION, 5.0),
    ]
    only = {"cable_spring", "cogging", "piecewise_stiffness", "slack_cable"}
    found = trace(plant, inverse_dynamics(records, BAND), only=only)
    assert found.verdict == "cause" and [c.effect for c in found.causes] == ["piecewise_stiffness"]
    assert found.after.plant["piecewise_stiffness"].parameters["threshold"].value == pytest.approx(0.06, abs=1e-3)


def test_a_flexure_that_meets_a_progressive_bumper_has_a_second_spring_and_no_cogging():
    """The bumper, beyond 3 mm of 4.5: 8000 N/m^1.2 to the power 1.2, which is no formula of the catalogue."""
    rng = np.random.default_rng(3)

    def record(name: str, role: str, w: float) -> Record:
        t = T[:2000]
        q = 4.5e-3 * np.sin(w * t) * np.sin(0.37 * w * t + 0.4)
        a = np.gradient(np.gradient(q, DT, edge_order=2), DT, edge_order=2)
        bumper = 8000.0 * np.sign(q) * np.maximum(np.abs(q) - 3e-3, 0.0) ** 1.2
        drive = 1.2 * a + 850.0 * q + bumper + 0.02 * rng.standard_normal(t.size)
        return Record(name, role, t, {"position": q, "force": drive}, {}, SOURCE, {"position": 1e-7})

    plant = Plant(ONE_MASS, rotary=False) + find("inertia")(inertia=1.2) + find("linear_stiffness")(at="axis")
    records = [
        record("slow", IDENTIFICATION, 3.0),
        record("fast", IDENTIFICATION, 9.0),
        record("moves", VALIDATION, 5.0),
    ]
    found = trace(plant, inverse_dynamics(records, BAND), only={"cogging", "piecewise_stiffness"})
    assert found.verdict == "cause" and [c.effect for c in found.causes] == ["piecewise_stiffness"]


def test_a_composite_is_not_offered_beside_a_part_of_it():
    bare = Plant(ONE_MASS) + find("inertia") + find("coulomb_friction")
    assert "lugre_friction@axis" in offered(bare)
    assert "lugre_friction@axis" not in offered(bare + find("stribeck_friction"))
