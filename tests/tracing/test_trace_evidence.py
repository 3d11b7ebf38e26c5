"""What counts as evidence in a trace: of two effects at once, of noisy columns, of fast motion, of long steps of a fold."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import rig

from workbench.campaign import Campaign, load
from workbench.definition import find
from workbench.identification.cross_validation import HeldOut, followed
from workbench.identification.fit import fitted_on
from workbench.identification.problem import Problem
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.plant import ONE_MASS, TWO_MASS, Geometry, Plant
from workbench.tracing import ranking
from workbench.tracing.answer import Answer
from workbench.tracing.candidates import WHOLE, Candidate, brought, without
from workbench.tracing.decimation import decimate
from workbench.tracing.greedy import Step, earned, promised, spent
from workbench.tracing.judge import STANDARD, ScoredCandidate, judged
from workbench.tracing.orders import stranger
from workbench.tracing.ranking import simplest_first
from workbench.tracing.result import CAUSE, NOTHING, CandidateScore
from workbench.tracing.state import State
from workbench.tracing.tracing import trace

FINE, COARSE = rig.COUNT, 15.0 * rig.COUNT


def made(folder: Path, seed: int, *missing: str, over: float = 4.0, **options) -> Campaign:
    rig.campaign(folder, seed, missing, over / rig.LEVEL, short=True, **options)
    return load(folder)


def searched(campaign: Campaign) -> tuple[list[InverseDynamics], list[InverseDynamics]]:
    """InverseDynamics of the identification records: whole, and as a search looks at them."""
    whole = fitted_on(inverse_dynamics(campaign.records, campaign.bandwidth))
    return whole, decimate(whole)


def candidate(campaign: Campaign, key: str) -> Candidate:
    return next(s for s in WHOLE.candidates(campaign.plant) if s.key == key)


def judgement(gain: float, scatter: float, *, earns: bool = False, state: object = True) -> ScoredCandidate:
    c = CandidateScore("cogging", "axis", "addition", gain, scatter, 0.1, 0.1, earns, "")
    return ScoredCandidate(SimpleNamespace(key="cogging@axis"), c, None, 3, state=state)


# --- two effects at once --------------------------------------------------------------------------------------------------


def test_of_two_effects_that_show_in_different_blocks_both_are_found(tmp_path):
    """Each leaves the other's blocks as they are, so that neither gain is certain before the other one is in."""
    campaign = made(
        tmp_path, 303069, "sensor_trend", "actuator_lag", over=11.7, noise=2.2e-3, memory=3.6e-3, rate=5000, band=100.0
    )
    offered = ("sensor_trend", "actuator_lag", "transport_delay", "clock_skew", "creep")
    found = trace(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth), only=offered)
    assert found.verdict == CAUSE and set(found.added) == {"sensor_trend", "actuator_lag"}
    for cause in found.causes:
        assert cause.share_validation > 0.3
    assert found.after.identification < 0.1 * found.before.identification


@pytest.mark.parametrize(
    ("gain", "scatter", "state", "provisional"),
    [
        (0.5, 0.2, True, True),
        (0.5, 0.3, True, False),  # not even two standard errors
        (0.1, 0.01, True, False),  # too little to be plain
        (0.5, 0.2, None, False),  # not one that leads
    ],
)
def test_provisional_is_a_plain_gain_that_is_not_certain(gain, scatter, state, provisional):
    j = judgement(gain, scatter, state=state)
    assert promised([j, judgement(0.9, 0.1)], STANDARD) is (j if provisional else None)
    assert promised([], STANDARD) is None


@pytest.mark.parametrize(("gain", "added"), [(0.3, True), (0.1, False)])
def test_of_what_a_search_with_rest_was_certain_of_a_plain_gain_is_enough_where_the_axis_moves(gain, added):
    j = judgement(gain, 0.2, state=True)
    assert promised([j], STANDARD) is None
    assert promised([j], STANDARD, [j.candidate.key]) is (j if added else None)


@pytest.mark.parametrize(
    ("left", "is_spent"),
    # noise of 0.006: 0.1, 0.47, 0.53 and 1.9 % of the drive above it
    [(0.0061, True), (0.0076, True), (0.0080, False), (0.02, False)],
)
def test_nothing_further_is_asked_where_less_is_left_than_a_further_cause_takes(left, is_spent):
    drive, record = np.ones(1000), SimpleNamespace(name="a")
    motion = SimpleNamespace(record=record, u=drive, keep=slice(0, 1000))

    def state(share: float) -> SimpleNamespace:
        errors = HeldOut(np.full(10, share**2 * 100.0))
        return SimpleNamespace(errors=errors, power=1000.0, inverses=[SimpleNamespace(motion=motion, counts=None)])

    assert spent(state(left), state(0.06), {"a": 0.006}, STANDARD) == is_spent
    assert not spent(
        state(left), state(left + 1e-4), {"a": 0.006}, STANDARD
    )  # little was taken, and its law may be another one


def test_what_was_added_on_credit_goes_where_nothing_earns_its_place_after_it():
    first, provisional, later = judgement(0.5, 0.1, earns=True), judgement(0.4, 0.2), judgement(0.9, 0.1, earns=True)
    steps = [Step([first], first), Step([provisional], provisional, provisional=True), Step([], None)]
    assert earned(steps) == [steps[0], Step([provisional], None)]
    assert earned(steps[:2]) == [steps[0], Step([provisional], None)]
    kept = [Step([provisional], provisional, provisional=True), Step([later], later), Step([], None)]
    assert earned(kept) == kept
    assert earned([Step([provisional], None)]) == [Step([provisional], None)]


def test_an_effect_that_a_later_one_takes_the_place_of_is_no_cause():
    """Coulomb friction comes first; once something else is in, friction with memory stands in its stead."""
    declared = Plant(ONE_MASS) + find("inertia") + find("viscous_friction")
    first = next(s for s in WHOLE.candidates(declared) if s.key == "coulomb_friction@axis")
    last = next(s for s in WHOLE.candidates(first.plant) if s.instead and s.effect == "presliding_hysteresis")
    added = [replace(judgement(0.5, 0.1), candidate=s, state=SimpleNamespace(plant=s.plant)) for s in (first, last)]
    standing = Answer(added, SimpleNamespace(plant=declared)).standing
    assert standing.added == added[1:]
    names = {e.key for e in brought(declared, last, last.plant).effects}
    assert names == {*(e.key for e in declared.effects), "presliding_hysteresis@axis"}
    assert {e.key for e in without(last.plant, last, declared).effects} == {e.key for e in declared.effects}


# --- noisy columns --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "first, others, seed, measured",
    [
        ("inertia", ("flexible_mode", "creep"), 303076, {"count": COARSE, "noise": 2.5e-3, "rate": 2000, "band": 200.0}),
        ("linear_damping", ("transport_delay", "actuator_lag"), 707072,
         {"noise": 1.522088238775224e-3, "rate": 1000, "band": 100.0, "ratio": 30.0}),
    ],
    ids=["of the drive", "of the load"],
)  # fmt: skip
def test_what_counts_alone_explain_is_no_cause(tmp_path, first, others, seed, measured):
    """An inertia leans on its noisy column in the drive's balance, a damping of the joint on what both encoders' counts make
    of the deflection's rate in the load's."""
    campaign = made(tmp_path, seed, base="undamped", **measured)
    found = trace(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth), only=(first, *others))
    assert found.verdict == NOTHING and found.added == ()
    assert found.ranked[0].effect == first


# --- fast motion ----------------------------------------------------------------------------------------------------------


def test_a_short_wave_at_speed_is_judged_on_whole_records(tmp_path):
    """Order 200 passes at up to 200 Hz here: decimated records leave twice the floor of it, whole ones the floor."""
    campaign = made(
        tmp_path, 303049, "kinematic_error", over=2.4181143438098935, base="coulomb", noise=0.0033646931922237146,
        memory=0.009826372773993484, rate=2000, ratio=100.0,
    )  # fmt: skip
    offered = ("kinematic_error", "cogging", "inertia")
    found = trace(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth), only=offered)
    assert found.verdict == CAUSE and found.added == ("kinematic_error",)
    assert {e.parameter: e.value for e in found.causes[0].parameters}["order"] == pytest.approx(200.0, rel=1e-3)


# --- long steps of a fold -------------------------------------------------------------------------------------------------


def test_shape_parameters_that_are_hard_to_tell_apart_are_judged_by_what_they_do(tmp_path):
    """Two springs in series that harden have four parameters, and most of a fold's step runs along what they share."""
    campaign = made(
        tmp_path, 303002, "multi_body_compliance", over=2.7, base="elastic", noise=2.85e-3, memory=7.5e-3, rate=2000,
        band=200.0, ratio=50.0,
    )  # fmt: skip
    _, decimated = searched(campaign)
    found = judged(State(campaign.plant, decimated), candidate(campaign, "multi_body_compliance@joint"), STANDARD)[
        "score"
    ]
    assert found.gain > 0.9 and found.earns
    assert found.held_out < 1.1 * found.nrmse


def test_a_fold_follows_a_step_only_as_far_as_its_own_data_bear_it_out(tmp_path):
    campaign = made(tmp_path, 101)
    _, decimated = searched(campaign)
    state = State(campaign.plant, decimated)
    problem, solution = Problem(campaign.plant, decimated), state.solution
    rows = np.arange(solution.residual.size // 2)
    stay = followed(problem, solution, np.zeros(solution.theta.size), rows)
    rng = np.random.default_rng(3)
    for size in (0.01, 0.3, 3.0):
        left = followed(problem, solution, size * rng.standard_normal(solution.theta.size), rows)
        assert left[rows] @ left[rows] <= (1.0 + 1e-12) * (stay[rows] @ stay[rows])


# --- what dresses two effects ---------------------------------------------------------------------------------------------


def test_a_wave_as_long_as_the_travel_is_none_where_gravity_takes_as_much(tmp_path):
    """It ends at its bound, the travel, and is not seen to return."""
    campaign = made(
        tmp_path, 303059, "encoder_eccentricity", "gravity", noise=1.0591513196445384e-3, memory=0.014612415926384362,
        ratio=50.0,
    )  # fmt: skip
    offered = ("cogging", "gravity", "encoder_eccentricity")
    found = trace(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth), only=offered)
    assert found.steps[0][0].effect == "gravity"
    assert set(found.added) == {"encoder_eccentricity", "gravity"}


# --- equals ---------------------------------------------------------------------------------------------------------------


def test_of_equals_the_usual_effect_and_the_one_that_reads_less_lead(monkeypatch):
    """Dahl's friction and one that follows Masing's rule are the same along a motion that never turns within their length."""
    errors = HeldOut(np.full(8, 0.1))

    def candidate(name: str, gain: float, freedom: int) -> ScoredCandidate:
        c = CandidateScore(name, "axis", "addition", gain, 0.03, 0.1, 0.1, True, "")
        of = SimpleNamespace(
            key=name,
            effect=name,
            at="axis",
            plant={name: find(name)},
            family="",
            yields=False,
            kind="addition",
        )
        return ScoredCandidate(of, c, errors, freedom, refitted=object())

    fading, presliding, lugre = (
        candidate(*x)
        for x in (("fading_memory", 0.101, 2), ("presliding_hysteresis", 0.1, 2), ("lugre_friction", 0.11, 4))
    )
    monkeypatch.setattr(ranking, "absurd", lambda j, state: False)
    state = SimpleNamespace(power=1.0, errors=HeldOut(np.full(8, 0.2)))

    def leads(*judgements: ScoredCandidate) -> ScoredCandidate:
        return simplest_first(judgements, STANDARD, state)[0]

    assert leads(fading, presliding, lugre) is presliding
    plainly = candidate("fading_memory", 0.12, 2)
    assert leads(plainly, presliding, lugre) is plainly
    assert leads(fading, lugre) is fading
    # along a motion that goes one way friction that varies with place is a force that does
    friction, cogging = candidate("cyclic_friction", 0.11, 5), candidate("cogging", 0.1, 5)
    assert leads(friction, cogging) is cogging
    # over two seconds an offset that drifts is an offset; a delay, which reads nothing, is no force
    drift, offset, delay = (
        candidate(*x, 1) for x in (("sensor_trend", 0.11), ("constant_offset", 0.1), ("transport_delay", 0.1))
    )
    assert leads(drift, offset) is offset and leads(drift, delay) is drift


@pytest.mark.parametrize(
    ("rare", "further", "same"), [(False, 0.006, False), (True, 0.006, True), (True, 0.012, False)]
)
def test_a_rare_law_leads_where_it_takes_plainly_more_than_another_one(rare, further, same):
    """further: rms that the first takes beyond the other, over the drive's."""
    of = SimpleNamespace(key="k", plant={"k": SimpleNamespace(rare=rare)})
    power, blocks = 1.0, 8
    left = np.full(blocks, 1e-4 / blocks)
    best, other = (
        SimpleNamespace(candidate=of, errors=HeldOut(e), score=SimpleNamespace(gain=0.9))
        for e in (left, left + further**2 / blocks)
    )
    assert ranking.alike(best, other, STANDARD, power) == same


@pytest.mark.parametrize(("further", "same"), [(0.09, True), (0.12, False)])
def test_a_simpler_effect_that_leaves_a_tenth_of_the_drive_more_does_not_explain_the_same(further, same):
    """An offset takes 97 % of a residual that is nearly all of the drive, gravity 99 %: what it takes more is no near law's."""
    of = SimpleNamespace(key="k", plant={"k": SimpleNamespace(rare=False)})
    blocks = 8
    left = np.full(blocks, 1e-3 / blocks)
    best, other = (
        SimpleNamespace(candidate=of, errors=HeldOut(e), score=SimpleNamespace(gain=1.0 - e.sum()))
        for e in (left, left + further**2 / blocks)
    )
    assert ranking.alike(best, other, STANDARD, 1.0) == same


def test_values_that_no_machine_has_lead_only_where_no_plausible_effect_takes_nearly_as_much(monkeypatch):
    """A creep whose rates lie at their bound is a spring, and takes a little more of an axis that also has a hose."""
    creep, spring, drift = (
        SimpleNamespace(
            candidate=SimpleNamespace(key=name), score=SimpleNamespace(gain=gain, earns=True), refitted=object()
        )
        for name, gain in (("creep", 0.87), ("cable_spring", 0.85), ("sensor_trend", 0.3))
    )
    monkeypatch.setattr(ranking, "absurd", lambda j, state: j is creep)
    assert ranking._sound([creep, spring, drift], STANDARD, None) is spring
    assert ranking._sound([creep, drift], STANDARD, None) is creep
    assert ranking._sound([spring, creep], STANDARD, None) is spring


@pytest.mark.parametrize(("order", "strange"), [(282.0, False), (235.4, False), (23.5, False), (100.0, True)])
def test_a_further_wave_is_of_one_mechanism_where_orders_stand_as_small_numbers(order, strange):
    first, more = (find("cogging")(label=label, order=n) for label, n in (("", 47.0), ("2", order)))
    plant = Plant(ONE_MASS) + first + more
    assert stranger(more, plant, [swung(0.5)]) == strange


def test_orders_of_the_axis_and_of_its_motor_are_none_where_the_travel_holds_a_turn():
    geometry = Geometry(gear_ratio=16.0)
    first, more = (find("kinematic_error")(at="joint", label=label, order=n) for label, n in (("", 16.0), ("2", 3.0)))
    plant = replace(Plant(TWO_MASS), geometry=geometry) + first + more
    assert not stranger(more, plant, [swung(7.0)])
    assert stranger(more, plant, [swung(6.0)])  # three waves a turn, of which the travel holds less than a turn
    of_motor = more(order=40.0)
    assert not stranger(of_motor, plant.swap(of_motor), [swung(7.0)])  # 5/2 of the motor's turn
    assert stranger(more, replace(plant, rotary=False), [swung(7.0)])


def swung(travel: float) -> SimpleNamespace:
    return SimpleNamespace(motion=SimpleNamespace(q=np.array([0.0, travel])))
