"""One composite in the place of its parts; presliding beside Coulomb friction."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from test_near_law import PLANT, inverses, stops

from workbench.definition import find
from workbench.effects.free_maps import angle_over_angle
from workbench.inverse.balances import predicted
from workbench.plant import ONE_MASS, TWO_MASS, Geometry, Plant
from workbench.tracing import composing
from workbench.tracing.answer import Answer
from workbench.tracing.candidates import ADDITION, WHOLE, Candidate, Offer
from workbench.tracing.composing import composed, decomposed, of_one_disc, of_the_axis
from workbench.tracing.discs import behind_the_gear
from workbench.tracing.evidence import CORRECTION
from workbench.tracing.judge import STANDARD, ScoredCandidate, judged, refitted_as, scored_as
from workbench.tracing.state import State
from workbench.tracing.tracing import trace

BARE = PLANT.without("coulomb_friction")
LUGRE = find("lugre_friction")(sigma0=0.3 / 4e-4, sigma1=0.3, x0=4e-4, ratio=0.6, speed=0.15)
PARTS = (
    find("presliding_hysteresis")(h0=0.3, x0=4e-3, d=0.5),
    find("stribeck_friction")(drop=0.3, speed=0.15),
)


def found(names, *law, declared=PLANT):
    """The answer of a search that found effects of these names beside a declared plant, one after another, where this friction is."""
    (still,) = inverses(lambda t, q, way: 0.0 * t)
    plant = BARE
    for effect in law:
        plant = plant + effect
    force = predicted(still, plant) - predicted(still, BARE)
    noise = 0.002 * np.random.default_rng(3).standard_normal(force.size)
    declared = state = State(declared, inverses(lambda t, q, way: force + noise))
    added = []
    for name in names:
        candidate = next(c for c in WHOLE.candidates(state.plant) if c.effect == name and c.at == "axis")
        j = ScoredCandidate(candidate, **judged(state, candidate, STANDARD))
        added.append(refitted_as(state, j, STANDARD))
        state = added[-1].state
    return Answer(added, declared)


def found_in_parts(*law, declared=BARE):
    return found(("presliding_hysteresis", "stribeck_friction"), *law, declared=declared)


def test_presliding_and_a_peak_that_bristles_say_in_one_law_are_lugre_friction():
    answer = found_in_parts(LUGRE)
    one = composed(answer, BARE, STANDARD, Offer())
    assert [j.candidate.name for j in one.added] == ["lugre_friction"]
    assert one.last.errors.total <= answer.last.errors.total + STANDARD.practical**2 * answer.last.power
    assert {e.key for e in one.last.plant.effects} == {e.key for e in (BARE + LUGRE).effects}
    assert one.last.plant["lugre_friction"].parameters["x0"].value == pytest.approx(4e-4, rel=0.1)


def test_beside_dry_friction_that_is_declared_they_are_what_is_missing_each():
    """A screw whose balls give way over 1.5 um lacked Stribeck's peak, and was said to lack LuGre friction."""
    answer = found_in_parts(LUGRE, declared=PLANT)
    assert composed(answer, PLANT, STANDARD, Offer()) is answer


def test_parts_that_no_bristles_of_one_length_say_stay_two():
    answer = found_in_parts(*PARTS)
    assert composed(answer, BARE, STANDARD, Offer()) is answer
    alone = Answer(answer.added[:1], answer.declared)
    assert composed(alone, BARE, STANDARD, Offer()) is alone


@pytest.mark.parametrize(("order", "name"), [(40.0, "encoder_eccentricity"), (50.0, "kinematic_error")])
def test_a_wave_that_stands_to_a_disc_as_two_to_one_is_the_disc_s_whichever_was_found_first(order, name):
    state = State(replace(PLANT, geometry=Geometry(gear_ratio=30.0)), inverses(lambda t, q, way: 0.5 * way))
    added = []
    for effect in ("kinematic_error", "encoder_eccentricity"):
        found = (c for c in WHOLE.candidates(state.plant) if (c.effect, c.at) == (effect, "sensor.position"))
        candidate = next(found)
        at = {"order": order} if effect == "kinematic_error" else {"turns": 20.0}
        candidate = replace(candidate, plant=candidate.plant.swap(candidate.plant[candidate.key](**at, fixed=True)))
        j = ScoredCandidate(candidate, **judged(state, candidate, STANDARD))
        added.append(refitted_as(state, j, STANDARD))
        state = added[-1].state
    answer = of_one_disc(Answer(added, added[0].state))
    assert [j.candidate.name for j in answer.added] == [name, "encoder_eccentricity"]
    assert [j.candidate.effect for j in answer.added] == ["kinematic_error", "encoder_eccentricity"]
    declared = of_one_disc(Answer(added[:1], added[0].state, state))  # the disc's first wave is no addition
    assert [j.candidate.name for j in declared.added] == [name]


@pytest.mark.parametrize(
    ("order", "name"), [(2.0, "encoder_eccentricity"), (2.3, "kinematic_error"), (1.0, "kinematic_error")]
)
def test_of_two_encoders_a_wave_of_the_joint_is_the_second_one_of_a_disc(order, name):
    """A cycloid's output encoder erred once and twice a turn, and the second wave was its gear's."""
    plant = Plant(TWO_MASS) + find("encoder_eccentricity")(at="sensor.load_position")
    plant = plant + find("kinematic_error")(at="joint", order=order)
    of = {e.name: Candidate(e.name, e.at, ADDITION, plant) for e in plant.effects}
    last = SimpleNamespace(plant=plant, inverses=())
    added = [ScoredCandidate(of[n], None, None, 0, None, state=last) for n in sorted(of)]
    answer = of_one_disc(Answer(added, last))
    assert [j.candidate.name for j in answer.added] == ["encoder_eccentricity", name]


@pytest.mark.parametrize(("order", "ratio", "name"), [(16.0, 16.0, "encoder_eccentricity"), (32.0, 16.0, "kinematic_error"), (1.0, 1.0, "kinematic_error"), (16.5, 16.0, "kinematic_error")])  # fmt: skip
def test_of_one_encoder_a_wave_once_a_turn_of_the_motor_is_the_motors_disc(order, ratio, name):
    """A loader's lift with a magnetic encoder on its motor was told of its gear; a wave generator's two waves a turn are the gear's."""
    plant = Plant(ONE_MASS, geometry=Geometry(gear_ratio=ratio))
    plant = plant + find("kinematic_error")(at="sensor.position", order=order, sine=1e-4)
    last = SimpleNamespace(plant=plant, inverses=())
    added = [
        ScoredCandidate(
            Candidate("kinematic_error", "sensor.position", ADDITION, plant), None, None, 0, None, state=last
        )
    ]
    assert [j.candidate.name for j in of_one_disc(Answer(added, last)).added] == [name]


@pytest.mark.parametrize(
    ("turn", "ratio", "behind"),
    [
        (2**26, 144.0, True),
        (100 * 8192, 100.0, False),
        (1_296_000, 30.0, False),
        (2**20, 64.0, False),
        (2**20 + 0.3, 144.0, False),
        (2**17, 1.0, False),
        (101 * 4096, 50.5, False),
        (2**24, 50.5, True),
    ],
    ids=[
        "26 bits",
        "of the motor's turn",
        "either",
        "a ratio of two's power",
        "counts nothing whole",
        "no gear",
        "half a tooth",
        "24 bits",
    ],
)
def test_of_a_turn_that_holds_no_whole_number_of_counts_no_disc_errs(turn, ratio, behind):
    """A telescope's worm of 144 teeth errs once a turn of its motor, and its encoder of 26 bits can sit behind it alone."""
    wave = find("kinematic_error")(at="sensor.position", order=ratio, sine=1e-4)
    plant = Plant(ONE_MASS, geometry=Geometry(gear_ratio=ratio)) + wave
    count = 2.0 * np.pi / turn
    assert behind_the_gear(plant, count) is behind
    assert not behind_the_gear(plant, 0.0)
    motion = SimpleNamespace(motion=SimpleNamespace(counts=count))
    last = SimpleNamespace(plant=plant, inverses=[motion])
    candidate = Candidate("kinematic_error", "sensor.position", ADDITION, plant)
    (named,) = of_one_disc(Answer([ScoredCandidate(candidate, None, None, 0, None, state=last)], last)).added
    assert named.candidate.name == ("kinematic_error" if behind or ratio == 1.0 else "encoder_eccentricity")


@pytest.mark.parametrize(("kind", "at", "name"), [(ONE_MASS, "sensor.position", "encoder_eccentricity"), (TWO_MASS, "joint", "kinematic_error")])  # fmt: skip
def test_the_reading_of_a_slide_errs_in_waves_by_its_encoders_disc(kind, at, name):
    """A syringe pump's magnetic ring on its screw erred once and twice in its lead, and nothing says how far the pump goes in a turn."""
    plant = Plant(kind, rotary=False)
    plant = plant + find("kinematic_error")(at=at, order=2 * np.pi / 2e-3, sine=1e-5)
    plant = plant + find("kinematic_error")(at=at, order=4 * np.pi / 2e-3, sine=3e-6, label="2")
    last = SimpleNamespace(plant=plant, inverses=())
    candidates = [Candidate(e.named, at, ADDITION, plant) for e in plant.effects]
    added = [ScoredCandidate(c, None, None, 0, None, state=last) for c in candidates]
    named = {j.candidate.name.partition(" ")[0] for j in of_one_disc(Answer(added, last)).added}
    assert named == {name}


@pytest.mark.parametrize(("first", "second", "name"), [(2e-4, 1e-4, "encoder_eccentricity"), (1e-4, 2e-4, "kinematic_error")])  # fmt: skip
def test_a_curve_over_the_motors_turn_is_its_discs_where_its_first_harmonic_leads(first, second, name):
    plant = Plant(ONE_MASS, geometry=Geometry(gear_ratio=16.0))
    curve = angle_over_angle(16.0, 2, "sensor.position")(sine1=first, cosine2=second)
    plant = plant + curve
    last = SimpleNamespace(plant=plant, inverses=())
    candidate = Candidate(curve.named, curve.at, ADDITION, plant, stands="kinematic_error")
    (named,) = of_one_disc(Answer([ScoredCandidate(candidate, None, None, 0, None, state=last)], last)).added
    assert (named.candidate.name, named.candidate.stands) == (name, name)


@pytest.mark.parametrize(
    ("alone", "dry", "name"),
    [(0.03, 0.1, "stribeck_friction"), (0.3, 0.1, "lugre_friction"), (0.03, 1.2, "lugre_friction")],
    ids=["gives way a little", "the peak is half of it", "gives way much"],
)
def test_lugre_friction_in_the_place_of_dry_friction_is_a_peak_where_it_gives_way_a_little(
    monkeypatch, alone, dry, name
):
    """Two axes of strain wave gears with bristles of 0.1 mrad, where Coulomb friction is declared, lacked a Stribeck peak and were told of LuGre
    friction. alone, dry: what a peak leaves beside the free virgin curve, and beside the declared law, of a drive of power 100."""
    curved = PLANT.without("coulomb_friction") + find("presliding_hysteresis")
    candidate = next(c for c in WHOLE.candidates(PLANT) if (c.effect, c.at) == ("lugre_friction", "axis") and c.instead)
    last = SimpleNamespace(plant=candidate.plant, inverses=(), power=100.0, errors=SimpleNamespace(total=0.01))

    def state(plant, _):
        keys = {e.name for e in plant.effects}
        left = 0.5 if "stribeck_friction" not in keys else dry if "coulomb_friction" in keys else alone
        return SimpleNamespace(errors=SimpleNamespace(total=left))

    monkeypatch.setattr(composing, "State", state)
    monkeypatch.setattr(composing, "without", lambda *_: curved)
    monkeypatch.setattr(composing, "as_declared", lambda *_: PLANT)
    answer = decomposed(
        Answer([ScoredCandidate(candidate, None, None, 0, None, state=last)], last), PLANT, STANDARD, ()
    )
    assert [(j.candidate.name, j.candidate.effect) for j in answer.added] == [(name, "lugre_friction")]


def test_a_length_beside_ideal_coulomb_friction_is_presliding_and_no_near_law():
    seen = inverses(lambda t, q, way: 0.5 * way + stops(q, 3e-4, 0.1))
    found = trace(PLANT, seen)
    assert [c.effect for c in found.causes] == ["presliding_hysteresis"]
    assert found.after.plant["coulomb_friction"].parameters["coulomb"].value == pytest.approx(0.5, rel=0.05)


@pytest.mark.parametrize(("rest", "beside", "name"), [(0.0, "", "linear_stiffness"), (0.05, "", "cable_spring"), (0.05, "constant_offset", "linear_stiffness"), (0.0, "gravity", "cable_spring")])  # fmt: skip
def test_a_spring_that_is_relaxed_at_zero_is_the_axis_own_and_one_at_rest_elsewhere_a_cable(rest, beside, name):
    """A constant force that is declared is all of its preload, and no rest is told; a weight holds a part of it."""
    pulls = 0.8
    records = inverses(lambda t, q, way: pulls * (q - rest) + 0.01 * np.random.default_rng(5).standard_normal(t.size))
    plant = PLANT + find(beside) if beside else PLANT
    declared = State(plant, records)
    candidate = next(c for c in WHOLE.candidates(plant) if (c.effect, c.at) == ("cable_spring", "axis"))
    j = ScoredCandidate(candidate, **judged(declared, candidate, STANDARD))
    answer = Answer([refitted_as(declared, j, STANDARD)], declared)
    one = of_the_axis(answer, plant, STANDARD)
    assert [j.candidate.name for j in one.added] == [name]
    (spring,) = (e for e in one.last.plant.effects if e.name == name)
    assert spring.parameters["stiffness"].value == pytest.approx(pulls, rel=0.1 if beside == "gravity" else 0.05)
    assert (one is answer) == (name == "cable_spring")
    assert one.added[0].score.earns or beside == "gravity"  # which says nearly all of a straight spring


def test_a_rest_that_is_certain_is_a_cable_s_however_little_it_takes():
    noise = np.random.default_rng(5).standard_normal
    records = inverses(lambda t, q, way: 0.8 * (q - 0.01) + 0.1 * noise(t.size), seconds=40.0)
    declared = State(PLANT, records)
    candidate = next(c for c in WHOLE.candidates(PLANT) if (c.effect, c.at) == ("cable_spring", "axis"))
    j = ScoredCandidate(candidate, **judged(declared, candidate, STANDARD))
    answer = Answer([refitted_as(declared, j, STANDARD)], declared)
    spring = PLANT + find("linear_stiffness")(at="axis", stiffness=0.8)
    told = scored_as(State(spring, answer.last.inverses), answer.added[0].candidate, answer.last, STANDARD)[0]
    assert not told.earns and told.gain < STANDARD.share
    assert of_the_axis(answer, PLANT, STANDARD) is answer


@pytest.mark.parametrize(("phase", "noise", "name"), [(0.0, 0.1, "linear_stiffness"), (0.3, 0.1, "gravity"), (0.0, 0.01, "gravity")])  # fmt: skip
def test_a_weight_that_hangs_at_zero_on_a_travel_that_does_not_bend_its_sine_is_a_spring(phase, noise, name):
    drawn = np.random.default_rng(5).standard_normal
    declared = State(PLANT, inverses(lambda t, q, way: 0.8 * np.sin(q + phase) + noise * drawn(t.size)))
    candidate = next(c for c in WHOLE.candidates(PLANT) if (c.effect, c.at) == ("gravity", "axis"))
    j = ScoredCandidate(candidate, **judged(declared, candidate, STANDARD))
    answer = of_the_axis(Answer([refitted_as(declared, j, STANDARD)], declared), PLANT, STANDARD)
    assert [j.candidate.name for j in answer.added] == [name]
    if name == "linear_stiffness":
        assert answer.last.plant["linear_stiffness@axis"].parameters["stiffness"].value == pytest.approx(0.8, rel=0.05)


@pytest.mark.parametrize(("phase", "hangs"), [(0.0, True), (0.02, True), (-0.04, True), (0.06, False), (0.35, False), (np.pi, False)])  # fmt: skip
def test_a_weight_hangs_where_the_encoder_reads_zero_by_its_phase(phase, hangs):
    """Beside a constant that is free a short travel tells no phase, and no weight that others left out hangs there; nor does one that stands on its head."""
    assert composing._hangs(find("gravity")(sine=2.0 * np.cos(phase), cosine=2.0 * np.sin(phase))) == hangs
    assert not composing._hangs(find("cable_spring")(stiffness=2.0))


@pytest.mark.parametrize(("by", "name"), [(lambda q: 0.4 * q, "linear_stiffness"), (lambda q: 0.3 * np.sin(q + 0.46), "gravity")])  # fmt: skip
def test_a_weight_of_which_both_numbers_would_be_wrong_is_a_spring_that_says_as_much_with_one(by, name):
    """One that is only too small stays where a data sheet says that it hangs, 0.46 rad from the encoder's zero."""
    held = find("gravity")(sine=0.9, cosine=0.446)
    plant = PLANT + replace(held, parameters={n: replace(p, fixed=True) for n, p in held.parameters.items()})
    drawn = np.random.default_rng(5).standard_normal
    records = inverses(lambda t, q, way: np.sin(q + 0.46) + by(q) + 0.05 * drawn(t.size))
    declared = State(plant, records)
    candidate = next(c for c in WHOLE.candidates(plant) if c.effect == "gravity" and c.kind == CORRECTION)
    j = ScoredCandidate(candidate, **judged(declared, candidate, STANDARD))
    answer = of_the_axis(Answer([refitted_as(declared, j, STANDARD)], declared), plant, STANDARD)
    assert [j.candidate.name for j in answer.added] == [name]
    if name == "linear_stiffness":
        assert answer.last.plant["linear_stiffness@axis"].parameters["stiffness"].value == pytest.approx(0.4, rel=0.1)
        assert answer.last.plant["gravity@axis"].parameters["sine"].value == pytest.approx(0.9, rel=0.01)


def test_a_weight_whose_phase_alone_is_free_neither_hangs_nor_is_turned_from_a_data_sheet():
    """Its numbers are then a campaign's own, amplitude and phase, and what is free was declared as unknown."""
    weight = find("gravity").declared({"mgl": 1.75, "phase": -0.17}, {"mgl": True, "phase": False}, "here")
    moved = weight(mgl=1.9, phase=-0.11).free("mgl")
    assert moved.linear == ("mgl",)
    assert not composing._hangs(moved) and not composing._turned(moved, PLANT + weight)


def test_a_cable_behind_a_joint_whose_encoders_have_zeros_of_their_own_stays_one():
    """There the joint's mean torque is what closes the load's balance, and holds the preload as any constant would."""
    cable = find("cable_spring")(at="load", stiffness=2.0)
    motion = SimpleNamespace(record=SimpleNamespace(zero=0.01))
    last = SimpleNamespace(plant=Plant(TWO_MASS) + cable, inverses=[SimpleNamespace(motion=motion)])
    added = SimpleNamespace(candidate=Candidate("cable_spring", "load", ADDITION, last.plant))
    answer = Answer([added], last, last)
    assert of_the_axis(answer, Plant(TWO_MASS), STANDARD) is answer
