"""Parameters that two effects have alike, encoders in front of a gear, and levels that no noise has."""

from types import SimpleNamespace

import numpy as np
import pytest

from workbench.definition import find
from workbench.plant import ONE_MASS, TWO_MASS, Geometry, Plant
from workbench.tracing import ranking
from workbench.tracing.candidates import ADDITION, Candidate, candidates_of
from workbench.tracing.judge import STANDARD
from workbench.tracing.lines import Part
from workbench.tracing.neighbours import STRETCH, over_time
from workbench.tracing.same_columns import in_all, once


def joint(stiffness: float, fixed: bool = False, ratio: float = 1.0) -> Plant:
    plant = Plant(TWO_MASS, geometry=Geometry(gear_ratio=ratio))
    for effect in (find("inertia")(at="motor"), find("inertia")(at="load"), find("linear_stiffness")(at="joint", stiffness=stiffness, fixed=fixed)):  # fmt: skip
        plant = plant + effect
    return plant


def test_a_second_stiffness_about_zero_is_held_beside_a_free_one_and_free_beside_a_data_sheets():
    knee = find("piecewise_stiffness")(at="joint")
    assert once(knee, joint(5.0)).parameters["k1"].fixed
    assert not once(knee, joint(5.0, fixed=True)).parameters["k1"].fixed
    assert not once(knee, Plant(TWO_MASS)).parameters["k1"].fixed


def test_what_a_joint_has_about_zero_is_the_sum_of_both():
    plant = joint(5.0) + find("piecewise_stiffness")(at="joint", k1=2.0, k2=1.0)
    knee = plant["piecewise_stiffness@joint"]
    assert in_all(knee, "k1", plant) == 7.0 and in_all(knee, "k2", plant) == 1.0


def step_of(taken: dict[str, float], **values: float) -> list[str]:
    """The order in which a round puts a knee, fitted with these values, and what it reduces to. taken: effect -> share of the residual."""
    plant = joint(0.0) + find("piecewise_stiffness")(at="joint", **values)
    judged = []
    for name, share in taken.items():
        whole = plant if name == "piecewise_stiffness" else joint(0.0) + find(name)(at="joint")
        judged.append(ranking.ScoredCandidate(
            Candidate(name, "joint", ADDITION, whole),
            SimpleNamespace(earns=True, gain=share, scatter=0.01, effect=name, at="joint"),
            SimpleNamespace(total=1.0 - share), theta=np.zeros(1), refitted=SimpleNamespace(plant=whole, state=None), freedom=2,
        ))  # fmt: skip
    motion = SimpleNamespace(counts=1e-9, t=np.array([0.0, 1.0]), record=SimpleNamespace(dt=1e-3))
    state = SimpleNamespace(plant=joint(0.0), inverses=[SimpleNamespace(motion=motion)], errors=SimpleNamespace(total=1.0), power=1.0)  # fmt: skip
    return [j.candidate.effect for j in ranking._plainest_first(judged, STANDARD, state, 3) if j.score.earns]


@pytest.mark.parametrize(("gap", "leads"), [(0.93, "backlash"), (0.3, "piecewise_stiffness")])
def test_a_knee_without_stiffness_about_zero_is_a_gap_only_where_a_gap_says_so(monkeypatch, gap, leads):
    """The rest of a joint (a virgin curve of its hysteresis) may hold what its own spring does not."""
    monkeypatch.setattr(ranking, "_as_simple", lambda first, *_: first)
    assert step_of({"piecewise_stiffness": 0.95, "backlash": gap}, k1=0.0, k2=1e4, threshold=1e-3)[0] == leads


def test_a_motors_encoder_in_front_of_a_gear_turns_as_often_as_the_motor():
    def turns(plant):
        found = [c for c in candidates_of(plant) if c.effect == "encoder_eccentricity"]
        return {(c.at, c.plant[c.key].parameters["turns"].value) for c in found}

    assert turns(joint(1.0, ratio=80.0)) == {("sensor.position", 1.0), ("sensor.position", 80.0), ("sensor.load_position", 1.0)}  # fmt: skip
    assert turns(Plant(ONE_MASS, geometry=Geometry(gear_ratio=80.0))) == {("sensor.position", 1.0)}


def test_an_eccentricity_of_the_motors_encoder_leads_only_where_the_gear_does_not_say_as_much(monkeypatch):
    """Once a motor turn both are the same deflection; they part by what the motor's inertia feels of a reading that is wrong."""
    plant = joint(1.0, ratio=80.0)
    (motors,) = (c for c in candidates_of(plant) if c.yields)
    gears = next(c for c in candidates_of(plant) if c.effect == "kinematic_error")

    def first(gear: float) -> str:
        judged = [
            SimpleNamespace(candidate=c, refitted=None, freedom=n, errors=SimpleNamespace(total=1.0 - g),
                            score=SimpleNamespace(effect=c.effect, at=c.at, gain=g, scatter=0.01, earns=True))
            for c, n, g in ((motors, 2, 0.8), (gears, 4, gear))
        ]  # fmt: skip
        for j in judged:
            j.refitted = SimpleNamespace(plant=j.candidate.plant)
        monkeypatch.setattr(ranking, "absurd", lambda j, state: False)
        monkeypatch.setattr(ranking, "alike", lambda a, b, *_: abs(a.score.gain - b.score.gain) < 0.01)
        state = SimpleNamespace(power=1.0, errors=SimpleNamespace(total=1.0))
        return ranking.simplest_first(judged, STANDARD, state)[0].candidate.effect

    assert (first(0.799), first(0.6)) == ("kinematic_error", "encoder_eccentricity")


@pytest.mark.parametrize(("corrected", "leads"), [(0.73, "correction"), (0.5, "addition")])
def test_a_wrong_value_that_takes_nearly_what_a_law_of_more_values_takes_leads(monkeypatch, corrected, leads):
    """A damper of a joint that is declared too weak looks like a part that swings (0.77 of the residual, with three values of its own)."""

    def of(kind):
        return SimpleNamespace(
            kind=kind, yields=False, family=kind, key=kind, plant={kind: SimpleNamespace(rare=False)}
        )

    judged = [
        SimpleNamespace(candidate=of(kind), refitted=object(), freedom=n, errors=SimpleNamespace(total=1.0 - g),
                        score=SimpleNamespace(effect=kind, at="joint", gain=g, scatter=0.01, earns=True))
        for kind, n, g in (("addition", 11, 0.77), ("correction", 8, corrected))
    ]  # fmt: skip
    monkeypatch.setattr(ranking, "absurd", lambda j, state: False)
    monkeypatch.setattr(ranking, "alike", lambda a, b, *_: a is b)
    state = SimpleNamespace(power=1.0, errors=SimpleNamespace(total=1.0))
    assert ranking.simplest_first(judged, STANDARD, state)[0].score.effect == leads


def level_of(level) -> float:
    """What a residual that is a level over bench time, beside white noise of a tenth of it, could be predicted to in rms."""
    dt = 5e-3
    t = np.arange(round(40.0 / dt)) * dt
    r = level(t) + 0.1 * np.random.default_rng(3).standard_normal(t.size)
    outside = np.random.default_rng(4).standard_normal((t.size, 10))
    way = np.sign(np.sin(1.3 * t))
    part = Part(r, outside, np.ones(t.size, bool), way, t, dt, r, outside[:, 0], 50.0)
    return float(np.sqrt(over_time([part], STANDARD.burst)[0] / t.size))


def wandering(t: np.ndarray) -> np.ndarray:
    """First-order noise of 0.3 Hz."""
    rng, x, a = np.random.default_rng(5), np.zeros(t.size), np.exp(-2 * np.pi * 0.3 * (t[1] - t[0]))
    for i, e in enumerate(rng.standard_normal(t.size - 1)):
        x[i + 1] = a * x[i] + np.sqrt(1 - a * a) * e
    return x


def test_a_level_that_leaks_away_and_is_recharged_is_no_noise_and_one_that_wanders_is():
    ends = np.cumsum(np.random.default_rng(6).uniform(1.3, 2.9, 40))

    def recharged(t):
        k = np.searchsorted(ends, t)
        start = np.concatenate([[0.0], ends])[k]
        return 1.7 * ((t - start) / (ends[k] - start) - 0.5)

    assert level_of(recharged) > 0.2 and level_of(wandering) < 0.05
    assert STRETCH < 1.3 / 2
