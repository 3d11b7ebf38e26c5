"""Declared Coulomb friction that turns over a speed: a law that is only nearly right, and no friction that is missing."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from workbench.definition import find
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record, Source
from workbench.tracing import preparing
from workbench.tracing.answer import Answer
from workbench.tracing.candidates import Offer
from workbench.tracing.criteria import Criteria
from workbench.tracing.smooth_turn import SLOW, SmoothTurn, smooth_turn, turns
from workbench.tracing.state import State
from workbench.tracing.tracing import trace

SOURCE = Source(Path("made"), "", "made", {})
COUNT = 1e-8
PLANT = Plant(ONE_MASS) + find("inertia")(inertia=0.01) + find("viscous_friction") + find("coulomb_friction")
FILM = "film_friction@axis"
NOISE = 0.005  # N*m


def seen(force, role: str = IDENTIFICATION, seed: int = 0, weight: float = 0.0):
    """InverseDynamics over moves with rests between them, in which the axis creeps to its place; the drive is inertia, viscous friction,
    force(q, v) and a weight's."""
    t = np.arange(12000) / 1000.0
    v = 2.0 * np.sin(2 * np.pi * 0.5 * t) ** 3 * (np.sin(2 * np.pi * 0.25 * t) > 0.0)
    v += 2e-4 * np.sin(2 * np.pi * 1.7 * t + seed)
    q = np.cumsum(v) / 1000.0
    a = np.gradient(v, 1e-3)
    noise = NOISE * np.random.default_rng(seed).normal(size=t.size)
    drive = 0.01 * a + 0.05 * v + force(q, v) + weight * np.sin(q + 0.4) + noise
    return inverse_dynamics(
        [Record(role, role, t, {"torque": drive, "position": q}, {}, SOURCE, {"position": COUNT})], 60.0
    )


def over(speed: float):
    return lambda q, v: 0.4 * np.tanh(v / speed)


def slips(length: float):
    """The play of a spring that slips: friction that builds up over a distance."""

    def force(q, v):
        x, found = 0.0, np.empty(q.size)
        for i, dq in enumerate(np.diff(q, prepend=q[0])):
            x = min(max(x + dq, -length), length)
            found[i] = 0.4 * x / length
        return found

    return force


def test_friction_that_turns_over_a_thousandth_of_the_speed_is_the_declared_law_nearly_right():
    turn = smooth_turn(PLANT, seen(over(4e-3)), Criteria())
    plant = turn.of(PLANT)
    values = {n: p.value for n, p in plant[FILM].parameters.items()}
    assert set(turn.declared) == {FILM}
    assert "coulomb_friction@axis" not in {e.key for e in plant.effects}
    assert values["limit"] == pytest.approx(0.4, rel=0.02)
    assert values["speed"] == pytest.approx(4e-3, rel=0.1)


@pytest.mark.parametrize(
    ("law", "sharpness"),
    [
        (lambda x: 2 / np.pi * np.arctan(x), 1.4),
        (lambda x: x / (1 + np.abs(x)), 1.0),
        (lambda x: x / np.hypot(1, x), 2.0),
    ],
)
def test_a_turn_that_is_no_films_is_found_in_its_own_shape(law, sharpness):
    """arctan (an n of 1.38, to 1 % of its level), v/(|v| + v0) and v/sqrt(v^2 + v0^2), closed forms of n = 1 and 2."""
    turn = smooth_turn(PLANT, seen(lambda q, v: 0.4 * law(v / 4e-3)), Criteria())
    (shaped,) = turn.films
    values = {n: p.value for n, p in shaped.parameters.items()}
    assert shaped.name == "regularised_coulomb_friction"
    assert values["coulomb"] == pytest.approx(0.4, rel=0.02)
    assert values["sharpness"] == pytest.approx(sharpness, rel=0.15)


def test_what_a_film_leaves_of_an_arctangent_is_no_further_friction():
    """Its way to its level, up to ten times the speed of the turn, was nonlinear viscous friction beside a film."""

    def late(q, v):
        return 0.4 * 2 / np.pi * np.arctan(v / 0.012)

    found = trace(PLANT, [*seen(late, weight=0.1), *seen(late, VALIDATION, 3, weight=0.1)])
    assert [c.effect for c in found.causes] == ["gravity"]
    assert [r.effect for r in found.refinements] == ["coulomb_friction"]


def test_friction_over_a_tenth_of_the_speed_is_a_law_of_its_own():
    """Five times as far as a turn may go."""
    assert smooth_turn(PLANT, seen(over(5.0 * SLOW * 2.0)), Criteria()) is None


@pytest.mark.parametrize(("law", "of_top", "declared", "turn"), [
    ("regularised_coulomb_friction", 0.5, PLANT, True), ("film_friction", 0.5, PLANT, True),
    ("regularised_coulomb_friction", 2.0, PLANT, False),  # over so much speed it is a law of its own
    ("power_law_friction", 0.5, PLANT, False), ("film_friction", 0.5, PLANT.without("coulomb_friction@axis"), False),
], ids=["any shape", "film", "wide", "power", "not declared"])  # fmt: skip
def test_a_turn_that_the_search_finds_is_the_declared_frictions(law, of_top, declared, turn):
    """Behind a joint it takes too little of the drive to be asked before the search, and most of the load's balance."""
    inverses = seen(over(1.0))
    top = float(np.abs(inverses[0].motion.v).max())
    assert turns(find(law)(speed=of_top * SLOW * top), declared, inverses) is turn


def test_friction_that_turns_at_once_stays():
    assert smooth_turn(PLANT, seen(lambda q, v: 0.4 * np.sign(v)), Criteria()) is None


def test_presliding_is_no_turn_over_a_speed():
    """It builds up over a distance, which the free virgin curve says."""
    assert smooth_turn(PLANT, seen(slips(2e-3)), Criteria()) is None


def test_a_held_friction_stays():
    held = PLANT.swap(find("coulomb_friction")(coulomb=0.4, fixed=True))
    assert smooth_turn(held, seen(over(4e-3)), Criteria()) is None


def test_beside_a_declared_law_over_speed_or_another_contact_nothing_turns_twice():
    thin = seen(over(4e-3))
    assert smooth_turn(PLANT + find("film_friction")(limit=0.1, speed=1.0), thin, Criteria()) is None
    seal = find("coulomb_friction")(coulomb=0.01, label="seal")
    two = smooth_turn(PLANT + seal, thin, Criteria())
    assert set(two.declared) == {FILM} and seal.key in {e.key for e in two.of(PLANT + seal).effects}


@pytest.fixture(scope="module")
def both():
    return {w: [*seen(over(4e-3), weight=w), *seen(over(4e-3), VALIDATION, 1, w)] for w in (0.0, 0.1)}


def test_a_complete_model_of_it_lacks_nothing_and_says_the_refinement(both):
    found = trace(PLANT, both[0.0])
    (law,) = found.refinements
    assert (found.verdict, found.added) == ("nothing_missing", ())
    assert (law.effect, law.at, law.kind) == ("coulomb_friction", "axis", "law")
    assert law.size > 10 * Criteria().practical
    assert "turns over a speed" in found.sentence
    assert found.before.identification < 0.2 * law.size and FILM in {e.key for e in found.before.plant.effects}


def test_what_is_missing_beside_it_is_named_alone(both):
    found = trace(PLANT, both[0.1])
    assert (found.verdict, found.added) == ("cause", ("gravity",))
    assert found.after.validation < 0.05 < found.before.validation


# --- asked again beside what was found -------------------------------------------------------------------------------------


def turned_on(inverses) -> SmoothTurn:
    """What a turn is taken for on these records, whether it is one or not."""
    dry = PLANT["coulomb_friction@axis"]
    film = find("film_friction")(limit=0.4, speed=4e-3)
    return SmoothTurn({FILM: dry}, (film,), identify(PLANT, inverses))


@pytest.mark.parametrize(("force", "stands"), [(over(4e-3), True), (slips(2e-5), False)])
@pytest.mark.parametrize("what", ["constant_offset", "fading_memory"])
def test_beside_what_was_found_a_turn_stands_where_friction_turns_so(force, stands, what):
    """A memory that was found at its place is no part of the question: it may be what the turn hides."""
    inverses = seen(force)
    turn = turned_on(inverses)
    declared = State(turn.of(PLANT), inverses)
    offered = Offer(stands_for=turn.declared).candidates(declared.plant)
    candidate = next(c for c in offered if c.key == f"{what}@axis")
    found = Answer([SimpleNamespace(candidate=candidate)], declared, State(candidate.plant, inverses))
    assert turn.stands(found, inverses, Criteria()) is stands


def test_a_turn_that_does_not_stand_is_taken_back_and_all_is_asked_of_friction_as_it_is_declared(monkeypatch):
    monkeypatch.setattr(SmoothTurn, "stands", lambda *_: False)
    dry = lambda q, v: 0.4 * np.sign(v)  # noqa: E731
    records = [*seen(dry, weight=0.1), *seen(dry, VALIDATION, 1, 0.1)]
    monkeypatch.setattr(preparing, "smooth_turn", lambda *_: turned_on(records))
    said = []
    found = trace(PLANT, records, said.append)
    assert "searching once more, with friction as it is declared" in said
    assert (found.verdict, found.added, found.refinements) == ("cause", ("gravity",), ())
    assert "turns over a speed" not in found.sentence
    assert "coulomb_friction@axis" in {e.key for e in found.before.plant.effects}
