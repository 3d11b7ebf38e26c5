"""Whose an error of the angle is: the motor's encoder stands in front of the gear; where there is no gear, none is the gear's."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from test_near_law import SOURCE

from workbench.definition import find
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, TWO_MASS, Geometry, Plant
from workbench.record import IDENTIFICATION, Record
from workbench.tracing import ranking
from workbench.tracing.candidates import WHOLE
from workbench.tracing.judge import STANDARD
from workbench.tracing.result import physical_cause
from workbench.tracing.tracing import trace

GEARED = Geometry(gear_ratio=80.0)
PLANT = Plant(TWO_MASS, geometry=GEARED)
PLANT = PLANT + find("inertia")(at="motor") + find("inertia")(at="load") + find("linear_stiffness")(at="joint")


def test_a_motors_encoder_in_front_of_a_gear_turns_as_often_as_the_motor():
    def turns(plant):
        found = [c for c in WHOLE.candidates(plant) if c.effect == "encoder_eccentricity"]
        return {(c.at, c.plant[c.key].parameters["turns"].value) for c in found}

    assert turns(PLANT) == {("sensor.position", 1.0), ("sensor.position", 80.0), ("sensor.load_position", 1.0)}  # fmt: skip
    assert turns(Plant(ONE_MASS, geometry=GEARED)) == {("sensor.position", 1.0)}


def test_an_eccentricity_of_the_motors_encoder_leads_only_where_the_gear_does_not_say_as_much(monkeypatch):
    """Once a motor turn both are the same deflection; they part by what the motor's inertia feels of a reading that is wrong."""
    (motors,) = (c for c in WHOLE.candidates(PLANT) if c.yields)
    gears = next(c for c in WHOLE.candidates(PLANT) if c.effect == "kinematic_error")

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


def test_where_one_mass_turns_without_a_gear_every_wave_of_the_angle_is_its_encoders():
    """A resolver of four pole pairs errs four times a turn; with a gear in front the wave may be the gear's, and a slide has a scale."""

    def named(plant):
        return [c.name for c in WHOLE.candidates(plant) if c.effect == "kinematic_error"]

    direct = Plant(ONE_MASS) + find("inertia")
    assert named(direct) == ["encoder_eccentricity"]
    others = (Plant(ONE_MASS, geometry=GEARED), Plant(ONE_MASS, rotary=False), replace(PLANT, geometry=Geometry()))
    assert {n for plant in others for n in named(plant)} == {"kinematic_error"}


def test_a_law_under_another_name_has_the_cause_of_what_says_more_of_it():
    gear, disc, lugre = (find(n) for n in ("kinematic_error", "encoder_eccentricity", "lugre_friction"))
    assert physical_cause(gear, "encoder_eccentricity 2") == disc.cause  # without a gear it is the encoder's
    assert physical_cause(gear, "kinematic_error") == gear.cause
    assert physical_cause(lugre, "stribeck_friction") == lugre.cause  # the composite with what is declared
    film = find("power_law_friction")
    assert physical_cause(film, "nonlinear_viscous_friction") == film.cause


def test_a_reading_that_errs_once_a_turn_of_the_motor_is_the_discs_with_the_gear_for_a_rival():
    """Of one encoder nothing but the place where it sits tells the two apart: the experiment says to look."""
    t = np.arange(6000) / 500.0
    q = 0.9 * np.sin(0.7 * t) + 0.3 * np.sin(2.3 * t)
    v = 0.63 * np.cos(0.7 * t) + 0.69 * np.cos(2.3 * t)
    a = -0.441 * np.sin(0.7 * t) - 1.587 * np.sin(2.3 * t)
    noise = 0.002 * np.random.default_rng(2).standard_normal(t.size)
    drive = 0.2 * a + 0.3 * v + 0.5 * np.sign(v) + noise
    reading = q + 6e-4 * np.sin(16.0 * q + 0.4) + 1e-4 * np.sin(32.0 * q)
    record = Record("made", IDENTIFICATION, t, {"torque": drive, "position": reading}, {}, SOURCE, {"position": 1e-6})
    plant = Plant(ONE_MASS, geometry=Geometry(gear_ratio=16.0)) + find("inertia")(inertia=0.2)
    plant = plant + find("viscous_friction") + find("coulomb_friction")
    found = trace(plant, inverse_dynamics([record], 20.0))
    assert [(c.effect, c.rivals) for c in found.causes] == [("encoder_eccentricity", ("kinematic_error",))]
    assert "Where the encoder sits" in found.causes[0].experiment
    assert found.ranked[0].effect == "encoder_eccentricity" and found.ranked[0].gain > 0.5
