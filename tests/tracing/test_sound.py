"""What leads with values that no machine has, laws that make each other needless, and what a further cause stands on."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.tracing.test_otherwise import PLANT, recorded
from workbench.errors import WorkbenchError
from workbench.identification.intervals import FEW, block_seconds
from workbench.inverse.dynamics import inverse_dynamics
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing import pruning, ranking, sound, tracing, weighing
from workbench.tracing.candidates import Offer
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
