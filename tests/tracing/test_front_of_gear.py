"""Encoders in front of a gear, wrong values beside laws of more values, and levels that no noise has."""

from types import SimpleNamespace

import numpy as np
import pytest

from workbench.definition import find
from workbench.plant import ONE_MASS, TWO_MASS, Geometry, Plant
from workbench.tracing import ranking
from workbench.tracing.candidates import candidates_of
from workbench.tracing.judge import STANDARD
from workbench.tracing.lines import Part
from workbench.tracing.neighbours import STRETCH, over_time


def joint(stiffness: float, fixed: bool = False, ratio: float = 1.0) -> Plant:
    plant = Plant(TWO_MASS, geometry=Geometry(gear_ratio=ratio))
    for effect in (find("inertia")(at="motor"), find("inertia")(at="load"), find("linear_stiffness")(at="joint", stiffness=stiffness, fixed=fixed)):  # fmt: skip
        plant = plant + effect
    return plant


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
