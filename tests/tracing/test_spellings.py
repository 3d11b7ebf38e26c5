"""A law by another spelling, under its class' name: a hose that hangs slack, a joint of another power, a wave of many orders."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from test_otherwise import PLANT, recorded

from workbench.definition import find
from workbench.effects import free_maps
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import TWO_MASS, Geometry, Plant
from workbench.record import IDENTIFICATION
from workbench.tracing import (
    free_forms,
    free_law,
    greedy,
    plausible,
    pruning,
    ranking,
    reducing,
    selection,
    spellings,
    waves,
)
from workbench.tracing.answer import Answer
from workbench.tracing.candidates import ADDITION, WHOLE, Candidate, Offer
from workbench.tracing.judge import STANDARD, ScoredCandidate, freedom
from workbench.tracing.state import State


def asked(over, plant=PLANT, *only: str, zero: float = 0.0):
    """The state of a declared model of which a force over position is missing, and what a round says of these effects.

    zero: by which positions read more than `over` is asked at."""
    records = [recorded(n, IDENTIFICATION, s, lambda v: 0.0 * v, 5.0, over) for n, s in (("a", 1.0), ("bb", 0.7))]
    read = ("position", "reference")
    records = [replace(r, channels=r.channels | {n: r.channels[n] + zero for n in read}) for r in records]
    state = State(plant, inverse_dynamics(records, 50.0))
    return state, ranking.step(state, lambda _: None, Offer(only=set(only)))


def test_a_hose_that_hangs_slack_until_a_place_is_a_cable_spring_by_another_law():
    state, judgements = asked(lambda q: 3.0 * np.maximum(q - 0.1, 0.0) ** 1.5, PLANT, "cable_spring")
    taut = spellings.better_spelled(state, judgements[0], STANDARD, Offer())
    assert (taut.candidate.effect, taut.candidate.name) == ("slack_cable", "cable_spring")
    values = {
        n: p.value
        for n, p in free_law.refitted_as(state, taut, STANDARD).state.plant[taut.candidate.key].parameters.items()
    }
    assert values["place"] == pytest.approx(0.1, abs=0.02) and values["exponent"] == pytest.approx(1.5, abs=0.2)
    assert values["left"] < 0.02 * values["right"]


def test_a_straight_spring_needs_no_other_spelling():
    state, judgements = asked(lambda q: 0.4 * (q - 0.05), PLANT, "cable_spring")
    assert judgements[0].score.earns and spellings.better_spelled(state, judgements[0], STANDARD, Offer()) is None


def test_a_wave_of_many_orders_is_its_class_and_a_bump_at_one_place_is_none():
    several = lambda q: 0.08 * (np.sin(24 * q) + np.sin(37 * q + 1.0) + np.sin(61 * q + 2.0) + np.sin(83 * q))  # noqa: E731
    bump = lambda q: 0.3 * np.exp(-(((q - 0.1) / 0.02) ** 2))  # noqa: E731
    named = []
    for over in (several, bump):
        state, judgements = asked(over, PLANT, "cogging")
        wave = next(j for j in judgements if j.candidate.effect == "cogging")
        named.append(waves.orders_say_it(state, wave, (1.0 - STANDARD.near) * state.errors.total, STANDARD, Offer()))
    assert named == [True, False]


def test_springs_of_another_power_are_offered_where_the_cubic_one_is():
    plant = Plant(TWO_MASS)
    for effect, at in (("inertia", "motor"), ("inertia", "load"), ("linear_stiffness", "joint")):
        plant = plant + find(effect)(at=at)
    own = tuple(find(n) for n in ("power_law_stiffness", "slack_cable"))
    found = {(c.effect, c.at) for c in Offer(own=own).candidates(plant) if c.effect in {e.name for e in own}}
    assert found == {("power_law_stiffness", "joint"), ("slack_cable", "load")}
    assert not {"power_law_stiffness", "slack_cable"} & {c.effect for c in WHOLE.candidates(plant)}


def test_a_root_of_speed_is_found_where_no_traced_formula_takes_anything_of_it(monkeypatch):
    """Beside a friction that varies with place nothing led, though a root of speed took nine tenths of what was left."""
    root = lambda v: 0.4 * np.sign(v) * np.abs(v) ** 0.3  # noqa: E731
    records = [recorded(n, IDENTIFICATION, s, root) for n, s in (("a", 1.0), ("bb", 0.7))]
    state = State(PLANT, inverse_dynamics(records, 50.0))
    found = free_law.otherwise_spelled(state, [], STANDARD)
    assert (found.candidate.effect, found.candidate.name) == ("power_law_friction", "nonlinear_viscous_friction")
    assert found.score.gain > 0.9 and found.state is not None
    assert free_law.otherwise_spelled(found.state, [], STANDARD) is None  # nothing is left
    assert free_law.otherwise_spelled(state, [found], STANDARD) is None  # of its class
    assert free_law.otherwise_spelled(state, [], STANDARD, Offer(only={"cogging"})) is None  # nobody asks for its class
    wave = ranking.step(state, lambda _: None, Offer(only={"cogging"}))[0]
    led = replace(wave, state=state, score=replace(wave.score, gain=0.5, earns=True))
    for leads, added in (([[led], []], ["cogging", "power_law_friction"]), ([[]], [])):
        rounds = iter(leads)
        monkeypatch.setattr(greedy, "step", lambda *_, r=rounds: next(r, []))
        monkeypatch.setattr(greedy, "free_law", lambda *_: None)
        steps = greedy.extended(state, state.inverses, lambda _: None, Offer(), STANDARD, lambda s: s)
        assert [s.added.candidate.effect for s in steps if s.added] == added  # of a declared model alone none is asked


def test_three_slopes_are_a_gap_at_special_values_of_their_special_case():
    law = SimpleNamespace(candidate=SimpleNamespace(key="law", plant={"law": find("three_slope_stiffness")}))
    assert {"piecewise_stiffness", "backlash"} <= spellings.special_cases(law)


def test_three_slopes_of_a_data_sheet_are_a_piecewise_stiffness_and_no_other_power():
    def slopes(q):
        beyond = lambda x: np.sign(q) * np.maximum(np.abs(q) - x, 0.0)  # noqa: E731
        return 1.0 * q + 3.0 * beyond(0.06) + 6.0 * beyond(0.18)

    state, judgements = asked(
        slopes, PLANT + find("linear_stiffness")(at="axis"), "cubic_stiffness", "piecewise_stiffness"
    )
    assert judgements[0].score.earns
    best = spellings.better_spelled(state, judgements[0], STANDARD, Offer(), judgements)
    assert (best.candidate.effect, best.candidate.name) == ("three_slope_stiffness", "piecewise_stiffness")
    plant = free_law.refitted_as(state, best, STANDARD).state.plant
    values = {n: p.value for n, p in plant[best.candidate.key].parameters.items()}
    assert values["threshold"] == pytest.approx(0.18, abs=0.02) and values["k3"] == pytest.approx(6.0, rel=0.2)
    assert values["threshold"] * values["share"] == pytest.approx(0.06, abs=0.02)


def test_rest_is_asked_of_dry_friction_where_a_friction_with_memory_took_its_place():
    (rigid,) = (c for c in WHOLE.candidates(PLANT) if c.effect == "lugre_friction" and c.instead)
    last = SimpleNamespace(plant=rigid.plant)
    found = selection.Selection(
        None, SimpleNamespace(plant=PLANT), Answer([SimpleNamespace(candidate=rigid)], None, last), (), (), ()
    )
    assert {e.key for e in found.dry.effects} == {e.key for e in PLANT.effects} != {e.key for e in found.found.effects}


def test_a_spelled_law_is_asked_again_as_itself_and_keeps_its_name():
    state, judgements = asked(lambda q: 3.0 * np.maximum(q - 0.1, 0.0) ** 1.5, PLANT, "cable_spring")
    taut = spellings.better_spelled(state, judgements[0], STANDARD, Offer())
    offer = spellings.with_spelling(taut, Offer(only={"cogging"}))
    assert set(offer.only) == {"cogging", "slack_cable"} and [e.name for e in offer.own] == ["slack_cable"]
    assert spellings.with_spelling(judgements[0], Offer()) == Offer()
    bare = replace(taut, candidate=replace(taut.candidate, part=""))
    assert spellings.called_as(bare, taut).candidate.name == "cable_spring"


def test_a_wave_that_hardly_returns_gives_way_to_a_hose_that_pulls_at_one_end():
    over = lambda q: 0.6 * (1.0 - np.exp(-((np.maximum(q - 0.08, 0.0) / 0.06) ** 1.5)))  # noqa: E731
    state, judgements = asked(over, PLANT, "cable_spring", "cogging")
    found = [j for j in judgements if j.candidate.effect == "cogging"]
    wide = [replace(w, refitted=SimpleNamespace(plant=w.candidate.plant.swap(w.candidate.plant[w.candidate.key](order=9.0)))) for w in found]  # fmt: skip
    narrow = [replace(w, refitted=SimpleNamespace(plant=w.candidate.plant.swap(w.candidate.plant[w.candidate.key](order=90.0)))) for w in found]  # fmt: skip
    others = [j for j in judgements if j.candidate.effect != "cogging"]
    assert spellings.no_wave(state, [*wide, *others], wide[0], STANDARD) == others
    assert spellings.no_wave(state, [*narrow, *others], narrow[0], STANDARD) == [*narrow, *others]


def test_a_hose_that_pushes_alike_at_both_ends_is_no_wave_of_less_than_two_periods():
    """A wave of one period takes most of it, and may be any curve: that curve is named, as what is no wave."""
    state, judgements = asked(lambda q: 0.5 * np.cos(10.0 * q) + 0.3 * np.exp(-q), PLANT, "cogging")
    best = greedy.leading(judgements)
    assert best.candidate.effect == "cogging" and spellings.hardly_returns(best, state)
    free = free_law.free_law(state, judgements, best, [], STANDARD)
    assert (free.candidate.effect, free.candidate.name) == ("force_over_position", "cable_spring")
    assert free.errors.total < (1.0 - STANDARD.near) * state.errors.total


def test_a_skin_that_is_stretched_near_both_ends_is_two_springs_of_few_numbers_and_no_curve():
    """A wave of one period leads, a spring with a play about zero takes a third of what it takes, and two springs of their own as much as the curve."""
    state, judgements = asked(lambda q: 3.0 * np.maximum(q - 0.12, 0.0) - 1.5 * np.maximum(-0.2 - q, 0.0), PLANT, "cogging", "piecewise_stiffness")  # fmt: skip
    wave = next(j for j in judgements if j.candidate.effect == "cogging")
    law = free_law._curve_of(state, wave, [], STANDARD, Offer())
    assert (law.candidate.effect, law.candidate.name) == ("end_stops", "piecewise_stiffness")
    assert free_law._curve_of(state, wave, [], STANDARD, Offer(only={"cogging", "cable_spring"})).candidate.name == "cable_spring"  # fmt: skip
    assert free_law._curve_of(state, wave, [wave], STANDARD, Offer()).candidate.name == "cogging"


def test_beside_a_curve_over_place_a_wave_of_three_periods_is_what_its_formula_left():
    state, judgements = asked(lambda q: 0.4 * np.cos(30.0 * q), PLANT, "cogging", "cable_spring")
    wave = next(j for j in judgements if j.candidate.effect == "cogging")
    spring = next(j for j in judgements if j.candidate.effect == "cable_spring")
    assert not spellings.hardly_returns(wave, state) and spellings.hardly_returns(wave, state, plausible.BESIDE)
    assert free_law.free_law(state, [wave], wave, [], STANDARD) is None
    assert free_law.free_law(state, [wave], wave, [wave], STANDARD) is None
    assert free_law.free_law(state, [wave], wave, [spring], STANDARD).candidate.name == "cable_spring"


@pytest.mark.parametrize(("periods", "shape", "name"), [(1.4, np.heaviside, ""), (1.4, None, "cyclic_friction"), (6.0, None, "cyclic_friction")])  # fmt: skip
def test_drag_in_a_part_of_the_stroke_is_no_friction_that_returns(periods, shape, name):
    """Waves of one period and its third and fifth draw a window; a sine of it, and friction of several periods, is cyclic."""
    travel = 0.6
    record = recorded("a", IDENTIFICATION, 1.0, lambda v: 0.0 * v)
    q = record.channels["reference"]
    wave = np.sin(2.0 * np.pi * periods / travel * q)
    drag = shape(wave, 0.5) if shape else wave
    dragged = record.channels["torque"] + 0.2 * drag * np.gradient(q, record.dt)
    record = replace(record, channels={**record.channels, "torque": dragged})
    state = State(PLANT, inverse_dynamics([record], 50.0))
    declared, fewer = [e.key for e in PLANT.effects], [e.key for e in PLANT.effects[:-1]]

    def leads(known):
        (first,) = ranking.step(state, lambda _: None, Offer(only={"cyclic_friction"}, declared=known))
        assert first.score.gain > 0.5 and np.ptp(q) == pytest.approx(travel, rel=0.1)
        return first.candidate.effect if first.score.earns else ""

    assert leads(declared) == name
    whole = Offer(only={"cyclic_friction"}, declared=declared)
    steps = greedy.extended(state, state.inverses, lambda _: None, whole, STANDARD, lambda after: after)
    assert (steps[0].added is None) == (not name)  # nor is the curve of its class a steadier law
    assert leads(fewer) == "cyclic_friction"  # beside what was found it is asked as any other wave


@pytest.mark.parametrize(("turns", "rotary", "order", "seen"), [(1.07, True, 0.94, True), (1.07, True, 0.8, False), (0.98, True, 1.0, False), (1.07, False, 0.94, False), (1.07, False, 1.9, True)])  # fmt: skip
def test_what_lives_in_place_returns_with_a_turn_of_a_rotary_axis(turns, rotary, order, seen):
    """Friction of a table that is turned to and fro by a little more than a turn: of its three orders the first comes out at 0.94."""
    motion = SimpleNamespace(q=np.linspace(0.0, 2.0 * np.pi * turns, 100))
    wave = find("cyclic_friction")(order=order)
    assert plausible.returns(wave, [SimpleNamespace(motion=motion)], rotary=rotary) == seen


@pytest.mark.parametrize(("name", "hardly"), [("cyclic_friction", False), ("cogging", True)])
def test_a_turn_shows_friction_to_return_and_a_cable_winds_on(name, hardly):
    """A hose on a table that is turned by a little more than a turn is no cogging of its one turn."""
    plant = PLANT + find(name)(order=0.94)
    state = SimpleNamespace(plant=PLANT, inverses=[SimpleNamespace(motion=SimpleNamespace(q=np.linspace(0.0, 6.7, 9)))])
    candidate = Candidate(name, "axis", ADDITION, plant)
    assert PLANT.rotary and spellings.hardly_returns(SimpleNamespace(candidate=candidate, refitted=SimpleNamespace(plant=plant)), state) is hardly  # fmt: skip
    assert spellings.hardly_returns(SimpleNamespace(candidate=candidate, refitted=None), state) is False


def test_a_disc_that_is_in_the_model_is_a_harmonic_of_its_axis_no_gears_curve_is_offered_beside():
    """Of one mass the gear's error stands at the encoder, where a disc's has turns and no order."""
    state, _ = asked(lambda q: 0.0 * q, PLANT, "cogging")
    long = [
        SimpleNamespace(motion=SimpleNamespace(**vars(p.motion) | {"q": 20.0 * p.motion.q})) for p in state.inverses
    ]
    geared = replace(PLANT, geometry=Geometry(gear_ratio=3.0))
    disc = find("encoder_eccentricity")(at="sensor.position", turns=3.0)
    assert free_forms._of_angle(geared, long, "sensor.position") is not None
    assert free_forms._of_angle(geared + disc, long, "sensor.position") is None


def test_a_slack_cable_beside_a_declared_spring_is_that_one_which_stiffens():
    """A valve's second spring, from 27 mm on."""
    over = lambda q: 3.0 * np.maximum(q - 0.1, 0.0) ** 1.5  # noqa: E731
    for plant, name in ((PLANT, "cable_spring"), (PLANT + find("linear_stiffness")(at="axis", stiffness=0.1), "piecewise_stiffness")):  # fmt: skip
        state, judgements = asked(over, plant, "cable_spring", "cubic_stiffness", "piecewise_stiffness")
        slack = next(j for j in spellings.spelled(state, [next(j for j in judgements if j.candidate.effect == "cable_spring")], STANDARD, Offer()) if j.candidate.effect == "slack_cable")  # fmt: skip
        assert slack.candidate.name == "cable_spring" and spellings.sprung("axis", state) == (name != "cable_spring")
        straight = replace(slack, errors=state.errors, candidate=next(j for j in judgements).candidate)
        assert spellings.better_spelled(state, straight, STANDARD, Offer(), judgements).candidate.name == name


def test_folds_that_close_at_one_end_are_found_though_a_wave_leads_of_which_nothing_is_certain():
    """The spring of a bellows is declared, and beside it no straight one takes what a few blocks hold."""
    state, judgements = asked(
        lambda q: 3.0 * np.maximum(q - 0.1, 0.0),
        PLANT + find("linear_stiffness")(at="axis", stiffness=0.1),
        "cable_spring",
        "cogging",
    )
    wave, straight = (next(j for j in judgements if j.candidate.effect == e) for e in ("cogging", "cable_spring"))
    assert not straight.score.earns
    wave = replace(wave, score=replace(wave.score, gain=0.4, earns=False))
    folds = free_law.steadier(state, [wave, straight], STANDARD)
    assert (folds.candidate.effect, folds.candidate.name) == ("slack_cable", "piecewise_stiffness")
    assert folds.score.earns and folds.score.gain > 0.9


def test_bumpers_at_both_ends_that_are_not_alike_are_found_where_each_is_met():
    """A cubic spring takes most of them, and pays for it about the middle; of a play about zero both places are wrong."""
    stops = lambda q: 4.0 * np.maximum(q - 0.2, 0.0) - 2.0 * np.maximum(-0.12 - q, 0.0)  # noqa: E731
    state, judgements = asked(stops, PLANT, "cable_spring", "cubic_stiffness", "piecewise_stiffness")
    found = spellings.better_spelled(state, judgements[0], STANDARD, Offer(), judgements)
    assert (found.candidate.effect, found.candidate.name) == ("end_stops", "piecewise_stiffness")
    ends = free_law.refitted_as(state, found, STANDARD).state.plant[found.candidate.key].parameters
    assert ends["upper"].value == pytest.approx(0.2, abs=0.01) and ends["lower"].value == pytest.approx(-0.12, abs=0.01)
    assert ends["right"].value == pytest.approx(4.0, rel=0.1) and ends["left"].value == pytest.approx(2.0, rel=0.1)


@pytest.mark.parametrize(("order", "named"), [(1.0, "encoder_eccentricity"), (16.0, "kinematic_error")])
def test_waves_of_an_encoder_over_one_turn_of_its_axis_are_its_eccentricity(order, named):
    """What shows most in the acceleration is their second harmonic, so that the nearest formula is a kinematic error of order 2."""
    plant = replace(PLANT, geometry=Geometry(gear_ratio=order))
    state, judgements = asked(lambda q: 0.0 * q, plant, "kinematic_error", "encoder_eccentricity")
    error = free_maps.angle_over_angle(order, 2, "sensor.position")
    j = ScoredCandidate(
        Candidate(error.name, error.at, ADDITION, plant + error), judgements[0].score, judgements[0].errors, 4
    )
    fitted = replace(j, refitted=SimpleNamespace(plant=plant + error))
    assert (reducing.reduced_to(fitted, state, STANDARD) or "kinematic_error") == named


def test_what_leads_by_gain_and_not_by_certainty_is_asked_for_a_steadier_law():
    first, sure = (SimpleNamespace(refitted=True, score=SimpleNamespace(gain=g, earns=e), candidate=SimpleNamespace(key=k)) for g, e, k in ((0.25, False, "b"), (0.07, True, "a")))  # fmt: skip
    alone = SimpleNamespace(refitted=None, score=SimpleNamespace(gain=0.9, earns=False), candidate=SimpleNamespace(key="c"))  # fmt: skip
    assert greedy._most_first([sure, alone, first]) == [first, sure, alone]


def test_of_what_is_certain_and_explains_no_more_than_a_simpler_law_the_simpler_one_is_asked_for_a_steadier_law():
    """A bumper that few blocks meet, beside a wave that draws it and is certain: its class' other spelling is asked, and not the wave's."""
    simple, wave = (SimpleNamespace(refitted=True, score=SimpleNamespace(gain=g, earns=e), candidate=SimpleNamespace(key=k)) for g, e, k in ((0.54, False, "b"), (0.59, True, "a")))  # fmt: skip
    assert greedy._most_first([simple, wave]) == [simple, wave]
    assert greedy._most_first([wave, simple]) == [wave, simple]


def test_a_spring_that_stiffens_to_many_times_its_stiffness_leads_by_its_other_spelling():
    """Of straight springs none comes near to what friction behind a gap takes of it; a cubic one takes all of it."""
    over = lambda q: 100.0 * q**3  # noqa: E731
    state, judgements = asked(over, PLANT, "cable_spring", "friction_behind_gap")
    gap, straight = judgements[0], next(j for j in judgements if j.candidate.effect == "cable_spring")
    assert gap.candidate.effect == "friction_behind_gap" and straight.score.gain < STANDARD.near * gap.score.gain
    assert spellings.better_spelled(state, gap, STANDARD, Offer()) is None
    found = spellings.better_spelled(state, gap, STANDARD, Offer(), judgements)
    assert (found.candidate.effect, found.candidate.name) == ("hardening_cable", "cable_spring")
    assert found.score.gain > 0.99


def test_a_spring_that_is_met_near_one_end_leads_though_one_with_a_play_is_nearer_to_it_than_a_straight_one():
    """Every law of the leading one's class is asked for its spellings, however little of it its own formula takes. Slack to the other side it is a
    bumper, as the spring with a play is, and bears that name."""
    hose = lambda q: 3.0 * np.maximum(q - 0.15, 0.0)  # noqa: E731
    state, judgements = asked(hose, PLANT, "cable_spring", "piecewise_stiffness", zero=0.05)
    play, straight = judgements[0], next(j for j in judgements if j.candidate.effect == "cable_spring")
    assert play.candidate.effect == "piecewise_stiffness" and straight.score.gain < STANDARD.resembles * play.score.gain
    found = spellings.better_spelled(state, play, STANDARD, Offer(), judgements)
    assert (found.candidate.effect, found.candidate.name) == ("slack_cable", "piecewise_stiffness")
    assert found.score.gain > 0.99


@pytest.mark.parametrize("odd", [True, False])
def test_a_bumper_at_one_end_stands_for_friction_of_values_that_no_machine_has(monkeypatch, odd):
    """However little a bumper that is met at both ends alike takes of it: here, met in the middle of the other half of the stroke, nothing."""
    bumper = lambda q: 30.0 * np.maximum(q - 0.15, 0.0)  # noqa: E731
    state, judgements = asked(bumper, PLANT, "piecewise_stiffness", "friction_behind_gap", zero=-0.1)
    met = next(j for j in judgements if j.candidate.effect == "piecewise_stiffness")
    assert met.score.gain < 0.0
    (stop,) = (k for k in spellings.spelled(state, [met], STANDARD, Offer()) if k.candidate.effect == "end_stops")
    gap = next(j for j in judgements if j.candidate.effect == "friction_behind_gap")
    gap = replace(gap, errors=stop.errors, score=replace(gap.score, gain=stop.score.gain))  # as if it drew all of that
    monkeypatch.setattr(spellings, "absurd", lambda j, _: odd and j is gap)
    found = spellings.commoner(state, [gap, met], gap, STANDARD, Offer())
    assert (found and (found.candidate.effect, found.candidate.name)) == (("end_stops", "piecewise_stiffness") if odd else None)  # fmt: skip


def test_what_comes_to_nothing_when_it_is_asked_again_stays_by_the_state_that_has_it(monkeypatch):
    """A fit may begin where a later addition made up for what it takes, and end there."""
    state, judgements = asked(lambda q: 0.6 * (q - 0.05) + 0.12 * np.sin(40.0 * q), PLANT, "cable_spring", "cogging")
    first = judgements[0]
    second = ranking.step(first.state, lambda _: None, Offer(only={"cogging", "cable_spring"}))[0]
    assert {first.candidate.effect, second.candidate.effect} == {"cable_spring", "cogging"}
    nothing = replace(first, score=replace(first.score, gain=0.0, earns=False), refitted=None, state=None)
    monkeypatch.setattr(pruning, "step", lambda *_: [nothing])
    for needless, left in ((False, [first, second]), (True, [second])):
        answer = Answer([first, second], state)
        if needless:  # the state without it says as much
            monkeypatch.setattr(pruning, "State", lambda *_, **__: second.state)
        found = pruning.pruned(answer, PLANT, [judgements], lambda _: None, Offer(), STANDARD)
        assert [j.candidate.key for j in found.added] == [j.candidate.key for j in left]


@pytest.mark.parametrize(
    ("hardens", "corner", "stays"), [(6.0, 0.0, "cubic_stiffness"), (0.0, 9.0, "piecewise_stiffness")]
)
def test_of_two_laws_that_make_each_other_needless_the_simpler_stays_if_it_says_as_much_alone(
    monkeypatch, hardens, corner, stays
):
    """Whichever was found first is asked, and beside the later one it takes nothing: a joint with a round corner was two parts in series."""
    over = lambda q: 0.6 * q + hardens * q**3 + corner * np.sign(q) * np.maximum(np.abs(q) - 0.1, 0.0)  # noqa: E731
    plant = PLANT + find("linear_stiffness")(at="axis")
    state, judgements = asked(over, plant, "cubic_stiffness", "piecewise_stiffness")
    cubic = next(j for j in judgements if j.candidate.effect == "cubic_stiffness")
    first = free_law.refitted_as(state, cubic, STANDARD)
    (again,) = ranking.step(first.state, lambda _: None, Offer(only={"piecewise_stiffness"}))
    second = free_law.refitted_as(first.state, again, STANDARD)
    nothing = replace(first, score=replace(first.score, gain=0.0, earns=False), refitted=None, state=None)
    monkeypatch.setattr(pruning, "step", lambda *_: [nothing])
    monkeypatch.setattr(pruning, "still_earns", lambda *_: False)
    found = pruning.pruned(Answer([first, second], state), plant, [], lambda _: None, Offer(), STANDARD)
    assert [j.candidate.effect for j in found.added] == [stays]
    assert stays in {e.name for e in found.last.plant.effects}


def test_what_leads_without_a_law_that_takes_nothing_now_does_not_hold_it(monkeypatch):
    """A drum's weight took nothing beside the eccentricity that had come in another one's stead; what led without it was an asymmetry, and no better."""
    state, judgements = asked(lambda q: 0.6 * (q - 0.05) + 0.12 * np.sin(40.0 * q), PLANT, "cable_spring", "cogging")
    first = judgements[0]
    second = ranking.step(first.state, lambda _: None, Offer(only={"cogging", "cable_spring"}))[0]
    other = ranking.step(second.state, lambda _: None, Offer(only={"gravity"}))[0]
    leads = free_law.refitted_as(second.state, other, STANDARD)
    leads = replace(leads, errors=second.state.errors, score=replace(other.score, gain=0.1, earns=True))
    monkeypatch.setattr(pruning, "step", lambda *_: [leads])
    monkeypatch.setattr(pruning, "_better", lambda *_: False)
    monkeypatch.setattr(pruning, "_alone", lambda *_: None)
    for takes, left in ((True, [first, second]), (False, [second])):
        monkeypatch.setattr(pruning, "still_earns", lambda *_, takes=takes: takes)
        found = pruning.pruned(Answer([first, second], state), PLANT, [], lambda _: None, Offer(), STANDARD)
        assert [j.candidate.key for j in found.added] == [j.candidate.key for j in left]


@pytest.mark.parametrize(("less", "asked_again"), [(0.1, True), (0.0, False)])
def test_those_before_what_took_another_one_s_stead_with_less_left_are_asked_once_more(monkeypatch, less, asked_again):
    state, _ = asked(lambda q: 0.6 * (q - 0.05) + 0.12 * np.sin(40.0 * q), PLANT, "cable_spring", "cogging")
    names = ("cable_spring", "cogging", "gravity", "sensor_trend")
    candidates = {c.effect: c for c in Offer(only=set(names)).candidates(state.plant)}
    total = state.errors.total

    def judgement(name, left):
        errors, score = SimpleNamespace(total=left), SimpleNamespace(effect=name, earns=True, gain=0.5)
        stands = SimpleNamespace(plant=PLANT, inverses=[], errors=errors)
        return ScoredCandidate(candidates[name], score, errors, 0, None, state=stands)

    first, second, third = (judgement(n, total) for n in names[:3])
    better, order = judgement(names[3], (1.0 - less) * total), []

    def step(*_):
        order.append(len(order))
        return [better if len(order) == 2 else [first, better][(len(order) - 1) % 2]]

    monkeypatch.setattr(pruning, "step", step)
    monkeypatch.setattr(pruning, "without", lambda plant, *_: plant)
    monkeypatch.setattr(pruning, "State", lambda *_, **__: state)
    monkeypatch.setattr(pruning, "bent_gap", lambda *_: False)
    monkeypatch.setattr(pruning, "leading", lambda judgements: judgements[0])
    monkeypatch.setattr(pruning, "still_earns", lambda *_: True)
    monkeypatch.setattr(pruning, "_better", lambda *_: True)
    monkeypatch.setattr(Answer, "standing", property(lambda answer: answer))
    answer = Answer([first, second, third], state, pruned=third.state)
    found = pruning.pruned(answer, PLANT, [], lambda _: None, Offer(), STANDARD)
    assert [j.candidate.effect for j in found.added] == ["cable_spring", "sensor_trend", "gravity"]
    assert len(order) == (4 if asked_again else 2)


def test_a_memory_of_the_declared_friction_that_comes_in_the_stead_of_a_needless_law_is_weighed_beside_all_others(
    monkeypatch,
):
    """Of a worm gear that hangs and drags more than in proportion, friction that gives way took what the drag and the weight take after it."""
    state, judgements = asked(lambda q: 0.6 * (q - 0.05) + 0.12 * np.sin(40.0 * q), PLANT, "cable_spring", "cogging")
    first = judgements[0]
    second = ranking.step(first.state, lambda _: None, Offer(only={"cogging", "cable_spring"}))[0]
    memory, wave = (
        free_law.refitted_as(second.state, j, STANDARD)
        for j in ranking.step(second.state, lambda _: None, Offer(only={"lugre_friction", "gravity"}))[:2]
    )
    if memory.candidate.effect != "lugre_friction":
        memory, wave = wave, memory
    needless = replace(first, score=replace(first.score, earns=False))
    for stead, order in ((memory, [second, memory]), (wave, [wave, second])):
        leads = replace(stead, score=replace(stead.score, gain=0.5, earns=True))
        monkeypatch.setattr(pruning, "step", lambda *_, j=leads: [j])
        found = pruning.pruned(Answer([needless, second], state), PLANT, [], lambda _: None, Offer(), STANDARD)
        assert [j.candidate.key for j in found.added] == [j.candidate.key for j in order]


@pytest.mark.parametrize(("fewer", "stays"), [(0, True), (1, False)])
def test_another_law_is_the_simpler_one_by_what_the_model_has_with_all_that_was_added_later(monkeypatch, fewer, stays):
    """Beside the second wave of an encoder's disc its first one says with fewer values what a cogging says; it has more than the cogging had alone."""
    state, judgements = asked(lambda q: 0.6 * (q - 0.05) + 0.12 * np.sin(40.0 * q), PLANT, "cable_spring", "cogging")
    first = judgements[0]
    second = ranking.step(first.state, lambda _: None, Offer(only={"cogging", "cable_spring"}))[0]
    another = ranking.step(second.state, lambda _: None, Offer(only={"gravity"}))[0]
    another = free_law.refitted_as(second.state, another, STANDARD)
    least = freedom(second.state.plant) - fewer
    score = replace(another.score, gain=0.5, earns=True)
    leads = replace(another, errors=second.state.errors, freedom=least, score=score)
    assert leads.freedom > first.freedom
    monkeypatch.setattr(pruning, "step", lambda *_: [leads])
    found = pruning.pruned(Answer([first, second], state), PLANT, [], lambda _: None, Offer(), STANDARD)
    assert (found.added[0].candidate.key == first.candidate.key) == stays


@pytest.mark.parametrize(("mu", "itself"), [(0.08, True), (0.02, True), (0.0, False)])
def test_a_coefficient_of_friction_is_not_nothing_beside_the_share_of_inertia_that_a_gear_passes(mu, itself):
    """Both are numbers without a unit: what is small beside the other springs of a law is nothing, and a share is none of them."""
    state, judgements = asked(lambda q: 0.0 * q, PLANT, "load_dependent_friction")
    (j,) = judgements
    plant = j.candidate.plant.with_values({j.candidate.key: {"mu": mu, "share": 0.99}})
    fitted = replace(j, refitted=SimpleNamespace(plant=plant))
    assert reducing.reduced_to(fitted, state, STANDARD) == (None if itself else "")


@pytest.mark.parametrize(("share", "itself"), [(0.5, False), (2.0, True)])
def test_a_delay_that_turns_the_fastest_of_the_band_by_less_than_practical_size_is_none(share, itself):
    """What it takes of any drive is at most 2 pi f delay: beside a lag that says it all a search leaves 0.4 us of a delay, which is not 0."""
    state, judgements = asked(lambda q: 0.0 * q, PLANT, "transport_delay")
    j = judgements[0]
    turn = STANDARD.practical / (2.0 * np.pi * state.inverses[0].motion.filter.bandwidth)
    late = j.candidate.plant.with_values({j.candidate.key: {"delay": share * turn}})[j.candidate.key]
    assert reducing.by_values(late, state, STANDARD) == (None if itself else "")


@pytest.mark.parametrize(("offset", "law"), [(0.05, "relieved_friction"), (0.0, "load_dependent_friction")])
def test_an_offset_of_the_drive_is_no_load_of_a_nut_that_a_spring_presses(offset, law):
    """In the model all that stands still counts as carried; what is not is the law's own number, and the cause is friction over load."""

    def rubbing(name, speed):
        plain = recorded(name, IDENTIFICATION, speed, lambda v: 0.0 * v, 8.0, lambda q: 1.2 * q + offset)
        q = plain.channels["reference"]
        rubs = 0.25 * np.abs(1.2 * q) * np.sign(np.gradient(q))
        return replace(plain, channels={**plain.channels, "torque": plain.channels["torque"] + rubs})

    plant = PLANT + find("linear_stiffness")(at="axis", stiffness=1.0) + find("constant_offset")
    state = State(plant, inverse_dynamics([rubbing("a", 1.0), rubbing("bb", 0.7)], 50.0))
    steps = greedy.extended(
        state,
        state.inverses,
        lambda _: None,
        Offer(only={"load_dependent_friction"}),
        STANDARD,
        lambda s: s,
    )
    added = steps[0].added
    assert (added.candidate.effect, added.candidate.name) == (law, "load_dependent_friction")
    values = {n: p.value for n, p in added.state.plant[added.candidate.key].parameters.items()}
    assert values["mu"] == pytest.approx(0.25, rel=0.05)
    assert values.get("relief", 0.0) == pytest.approx(offset, abs=0.02)


def test_a_flexure_that_hardens_about_another_place_than_its_declared_springs_is_a_cubic_spring():
    """Not two slopes: beside the spring the cable's law is a smooth one of that spring."""
    over = lambda q: 100.0 * (q - 0.05) ** 3  # noqa: E731
    plant = PLANT + find("linear_stiffness")(at="axis", stiffness=0.1)
    state, judgements = asked(over, plant, "cable_spring", "cubic_stiffness", "piecewise_stiffness", zero=0.05)
    hard = next(
        j
        for c in judgements
        for j in spellings.spelled(state, [c], STANDARD, Offer())
        if j.candidate.effect == "hardening_cable"
    )
    assert spellings.as_of_a_spring(hard, state).candidate.name == "cubic_stiffness"
