"""What leads with values that no machine has, laws that make each other needless, and what a further cause stands on."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.tracing.test_otherwise import PLANT, recorded
from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.identification.intervals import FEW, block_seconds
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import TWO_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing import pruning, ranking, sound, tracing, weighing
from workbench.tracing.answer import Answer
from workbench.tracing.candidates import ADDITION, Candidate, Offer, candidates_of
from workbench.tracing.judge import STANDARD
from workbench.tracing.state import State
from workbench.tracing.tracing import trace

ROLES = (("a", IDENTIFICATION, 1.0), ("bb", VALIDATION, 0.8))
LAWS = ("gravity", "cable_spring")


@pytest.fixture(scope="module")
def inverses():
    """Of an axis with a weight: on this travel a spring takes nearly all of what that takes."""
    weight = lambda q: 0.4 * np.sin(q + 0.05)  # noqa: E731
    return inverse_dynamics([recorded(n, r, s, lambda v: 0.0 * v, 6.0, weight) for n, r, s in ROLES], 50.0)


@pytest.mark.parametrize("none", [LAWS[:1], LAWS], ids=["one that no machine has", "both"])
def test_a_law_with_values_that_no_machine_has_gives_way_where_a_plausible_one_takes_nearly_as_much(
    inverses, monkeypatch, none
):
    monkeypatch.setattr(weighing, "implausible", lambda e, *_: "it stands on its bound" if e.name in none else "")
    found = trace(PLANT, inverses, only=LAWS)
    assert found.added == (("cable_spring",) if len(none) == 1 else ("gravity",))
    said = [f.sentence for f in found.findings if f.kind == "gave way"]
    assert len(said) == (len(none) == 1) and all(s.endswith("but it stands on its bound.") for s in said)


def test_what_goes_astray_on_validation_gives_way_where_another_effect_takes_nearly_as_much():
    """A preload that pulls a little more on one side of a short stroke is no spring: at another place it is the same."""
    seen = recorded("a", IDENTIFICATION, 1.0, lambda v: 0.0 * v, 6.0, lambda q: 0.5 + 0.5 * q)
    there = recorded("bb", VALIDATION, 0.8, lambda v: 0.0 * v, 6.0, lambda q: 0.5 + 0.0 * q)
    moved = {n: x + 5.0 if n in ("position", "reference") else x for n, x in there.channels.items()}
    found = trace(
        PLANT, inverse_dynamics([seen, replace(there, channels=moved)], 50.0), only=("cable_spring", "constant_offset")
    )
    assert found.steps[0][0].effect == "cable_spring" and found.added == ("constant_offset",)
    (said,) = (f.sentence for f in found.findings if f.kind == "gave way")
    assert said.startswith("Cable spring at the axis takes no less") and "farther than none at all" in said


def test_what_leads_and_comes_to_nothing_on_whole_records_is_left_out_and_the_search_begun_again(inverses, monkeypatch):
    confirm, said = tracing.confirm, []

    def refusing(late, order, *more):
        return confirm(late, [j for j in order if j.candidate.effect != "gravity"], *more)

    monkeypatch.setattr(tracing, "confirm", refusing)
    found = trace(PLANT, inverses, said.append, only=LAWS)
    assert found.added == ("cable_spring",)
    assert "searching once more without gravity@axis, which whole records do not bear out" in said


def test_records_too_short_to_be_judged_on_what_was_not_fitted_are_refused_in_a_sentence():
    short = [recorded(n, r, s, lambda v: 0.0 * v, 0.6) for n, r, s in ROLES]
    with pytest.raises(WorkbenchError, match="too short for a trace: .* 4 stretches of 0.4 s are needed"):
        trace(PLANT, inverse_dynamics(short, 10.0))


def test_records_of_a_second_are_judged_by_blocks_as_short_as_the_band_allows():
    brief = [recorded(n, r, s, lambda v: 0.0 * v, 1.2) for n, r, s in ROLES]
    for band, seconds in ((90.0, 1.0 / FEW), (20.0, 4.0 / 20.0)):
        problem = State(PLANT, inverse_dynamics(brief[:1], band)).problem
        assert block_seconds(problem) == pytest.approx(seconds, rel=0.2)


def added(state: State, *names: str) -> list:
    """Additions one after another, in this order, whatever they take."""
    found = []
    for name in names:
        (j, *_) = ranking.step(state, lambda _: None, Offer(only={name}))
        found.append(j if j.state else replace(j, state=State(j.candidate.plant, state.inverses)))
        state = found[-1].state
    return found


def test_of_two_laws_that_make_each_other_needless_the_simpler_stays():
    drag = lambda v: 0.4 * v * np.abs(v)  # noqa: E731
    declared = State(PLANT, inverse_dynamics([recorded("a", IDENTIFICATION, 1.0, drag, 6.0)], 50.0))
    one, two = added(declared, "nonlinear_viscous_friction", "stribeck_friction")
    reduced = State(added(declared, "stribeck_friction")[0].candidate.plant, declared.inverses)
    answer = Answer([one, two], declared)
    left = pruning._simpler(answer, 0, reduced, PLANT, STANDARD)
    assert [j.candidate.effect for j in left.added] == ["nonlinear_viscous_friction"]
    assert {e.key for e in left.last.plant.effects} == {*(e.key for e in PLANT.effects), one.candidate.key}
    other = Answer(added(declared, "nonlinear_viscous_friction", "cable_spring"), declared)
    assert pruning._simpler(other, 0, reduced, PLANT, STANDARD) is None  # of another class


def joint() -> Plant:
    plant = Plant(TWO_MASS)
    for effect, at in (
        ("inertia", "motor"),
        ("inertia", "load"),
        ("linear_stiffness", "joint"),
        ("linear_damping", "joint"),
    ):
        plant = plant + find(effect)(at=at)
    return plant


def leaving(totals):
    """Return a stand-in for State that leaves `totals` of the names of what a plant has beside `joint`."""
    own = {e.key for e in joint().effects}

    def state(plant, *_):
        more = frozenset(e.key for e in plant.effects if e.key not in own)
        return SimpleNamespace(plant=plant, errors=SimpleNamespace(total=totals[more]), power=1.0)

    return state


def one_of(plant: Plant, name: str, at: str, **values) -> Candidate:
    """Return an effect as a candidate at a place of a plant, begun at these values."""
    found = next(c for c in candidates_of(plant) if (c.effect, c.at, c.kind) == (name, at, ADDITION))
    return replace(found, plant=found.plant.swap(found.plant[found.key](**values)))


GEAR, SIDES = "kinematic_error@joint", ("cogging@motor", "cogging@load")


@pytest.mark.parametrize(
    ("alone", "stays"), [(0.03, False), (0.5, True)], ids=["an error of the gear", "cogging forces"]
)
def test_two_cogging_forces_on_either_side_of_a_joint_are_its_gear_s_error(alone, stays, monkeypatch):
    """What a joint does to one body it does to the other: two forces of which the gear's error takes `near` are no more than that error."""
    totals = {frozenset((GEAR, *SIDES)): 0.01, frozenset((GEAR,)): alone, frozenset(): 1.0}
    monkeypatch.setattr(pruning, "State", leaving(totals))
    found = []
    for name, at in (("kinematic_error", "joint"), ("cogging", "motor"), ("cogging", "load")):
        found.append(SimpleNamespace(candidate=one_of(found[-1].candidate.plant if found else joint(), name, at)))
    last = SimpleNamespace(plant=found[-1].candidate.plant, errors=SimpleNamespace(total=0.01), inverses=())
    answer = Answer(found, None, last)
    left = pruning._of_the_joint(answer, joint(), STANDARD)
    assert (left is answer) is stays
    assert [j.candidate.key for j in left.added] == ([GEAR, *SIDES] if stays else [GEAR])
    forces = Answer(found[1:], None, last)
    assert pruning._of_the_joint(forces, joint(), STANDARD) is forces  # no wave of the joint was found


@pytest.mark.parametrize(("soft", "same"), [(0.05, True), (0.4, False)], ids=["a gap", "two springs"])
def test_a_spring_that_is_next_to_nothing_at_first_is_the_gap_that_it_made_needless(soft, same, monkeypatch):
    """The flanks of a gap are rounded: two springs leave a little less, and are the gap where the first of them is next to nothing."""
    gap = one_of(joint(), "backlash", "joint")
    bent = one_of(gap.plant, "piecewise_stiffness", "joint", k1=soft * 800.0, k2=800.0, threshold=1e-3)
    totals = {frozenset((gap.key,)): 0.001, frozenset((bent.key,)): 0.0004, frozenset(): 1.0}
    monkeypatch.setattr(pruning, "State", leaving(totals))
    motion = SimpleNamespace(counts=0.0, t=np.linspace(0.0, 1.0, 11), record=SimpleNamespace(dt=0.1))
    reduced = leaving(totals)(bent.plant.without(gap.key))
    reduced.inverses = [SimpleNamespace(motion=motion)]
    last = SimpleNamespace(plant=bent.plant, inverses=())
    answer = Answer([SimpleNamespace(candidate=c) for c in (gap, bent)], None, last)
    found = pruning._simpler(answer, 0, reduced, joint(), replace(STANDARD, practical=1e-3))
    assert (found is not None) is same
    assert found is None or [j.candidate.effect for j in found.added] == ["backlash"]


def test_a_free_form_bears_the_name_of_the_formula_that_it_makes_needless(inverses):
    state = State(PLANT, inverses)
    (spring,), (friction,) = added(state, "cable_spring"), added(state, "stribeck_friction")
    free = replace(spring, candidate=replace(spring.candidate, stands="cogging"))
    assert pruning._named_after(free, spring, STANDARD).candidate.name == "cable_spring"
    assert pruning._named_after(free, friction, STANDARD) is free
    assert pruning._named_after(spring, free, STANDARD) is spring


def test_in_an_effects_stead_is_asked_what_took_a_quarter_of_what_it_takes():
    def judged(effect, gain, left):
        return SimpleNamespace(score=SimpleNamespace(effect=effect, gain=gain), errors=SimpleNamespace(total=left))

    first = [judged("backlash", 0.9, 1.0), judged("creep", 0.3, 7.0), judged("cogging", 0.04, 9.6)]
    second = [judged("creep", 0.1, 0.9), judged("gravity", 0.5, 0.5)]
    assert pruning._promising([first, second], 9.0) == {"backlash", "creep"}
    assert pruning._promising([first, second], 13.0) == {"backlash"}
    assert pruning._promising([first, second], 1.0) == {
        "backlash",
        "creep",
        "gravity",
    }  # cogging explains too little of anything


def test_where_what_gives_way_is_not_asked_again_others_are_held_against_the_best_of_them():
    """Seven laws were fitted to whole records, for 45 s, though the first took twice what the next one does."""

    def other(effect: str, gain: float, earns: bool = True):
        candidate = SimpleNamespace(effect=effect, key=f"{effect}@axis")
        return SimpleNamespace(candidate=candidate, state=object(), score=SimpleNamespace(gain=gain, earns=earns))

    asked = [other("a", 0.72), other("b", 0.6), other("c", 0.45), other("d", 0.9, earns=False)]
    choice = SimpleNamespace(less=lambda j: object(), judged=lambda *_: asked, criteria=STANDARD, offer=None)
    assert [k.candidate.effect for k in sound._others(choice, other("gone", 1.0))] == ["a", "b"]
    assert [k.candidate.effect for k in sound._others(choice, other("b", 1.0))] == ["a"]
