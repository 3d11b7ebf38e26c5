"""A load's balance is held against a joint that carries as much: a gear's wave is no wrong mass of the motor, and a wrong mass is one."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_joints import BAND, BL, BM, JL, JM, RATE, SOURCE, K, jointed, waved

from workbench.definition import find
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, Record
from workbench.tracing import orders
from workbench.tracing.candidates import ADDITION, Candidate, Offer
from workbench.tracing.judge import STANDARD
from workbench.tracing.orders import any_curve, stranger
from workbench.tracing.ranking import step
from workbench.tracing.scale_of_joint import beside
from workbench.tracing.state import State

ORDER, COUNT, TEETH = 60.0, 1e-6, 20
ASKED = {"inertia", "kinematic_error"}


def geared(wave: float, order: float = ORDER, cogs: float = 0.0, teeth: float = 0.0) -> Record:
    """A record whose gear errs by a wave of the load's place, rad; cogs: of the load, N*m, of the same order; teeth: of the gear, rad, TEETH times as often."""
    t = np.arange(round(16.0 * RATE)) / RATE
    place = waved(t, 5, 0)
    through = JL * waved(t, 5, 2) + BL * waved(t, 5, 1) + cogs * np.sin(order * place)
    motor = place + through / K + wave * np.sin(order * place + 0.4) + teeth * np.sin(TEETH * order * place + 1.9)
    speed = np.gradient(motor, t)
    drive = through + JM * np.gradient(speed, t) + BM * speed + np.random.default_rng(2).normal(0.0, 5.0, t.size)
    read = {n: COUNT * np.round(x / COUNT) for n, x in (("position", motor), ("load_position", place))}
    return Record("r", IDENTIFICATION, t, {"torque": drive, **read}, {}, SOURCE, dict.fromkeys(read, COUNT))


def held(mass: float) -> Plant:
    """The declared plant, of which the motor's inertia alone is a data sheet's."""
    plant = jointed()
    motor = plant["inertia@motor"]
    return plant.swap(
        replace(motor, parameters={"inertia": replace(motor.parameters["inertia"], value=mass, fixed=True)})
    )


def first(record: Record, mass: float):
    """What leads a round of the search, and the state that it is judged beside."""
    state = State(held(mass), inverse_dynamics([record], BAND))
    return step(state, lambda _: None, Offer(only=ASKED))[0], state


@pytest.mark.parametrize("wave", [2e-5, 1e-4])
def test_a_gears_wave_leads_though_a_motor_that_carries_the_loads_mass_leaves_little_too(wave):
    best, _ = first(geared(wave), JM)
    assert best.score.effect == "kinematic_error" and best.score.gain > 0.99
    assert best.refitted.plant["kinematic_error@joint"].parameters["order"].value == pytest.approx(ORDER, rel=2e-3)


@pytest.mark.parametrize("share", [0.7, 1.3])
def test_a_motors_mass_that_is_wrong_leads_still(share):
    best, _ = first(geared(0.0), share * JM)
    assert best.score.effect == "inertia" and best.score.gain > 0.8
    assert best.refitted.plant["inertia@motor"].parameters["inertia"].value == pytest.approx(JM, rel=0.02)


def test_what_a_joint_that_carries_half_leaves_of_its_load_counts_twice_in_rms():
    _, state = first(geared(1e-4), JM)
    solution = state.solution
    half = replace(solution, c=solution.c.copy())
    joint = [i for i, n in enumerate(state.problem.free_linear) if n.key.endswith("@joint")]
    half.c[joint] *= 0.5
    half = replace(half, cost=float(half.residual @ half.residual))
    errors, cost = beside((state.problem, solution), state.problem, half, state.errors)
    loads = float(half.residual[1::2] @ half.residual[1::2])
    assert cost == pytest.approx(half.cost + 3.0 * loads)
    assert errors.total == pytest.approx(state.errors.total + 3.0 * loads)
    more = replace(solution, c=2.0 * half.c)
    assert beside((state.problem, solution), state.problem, more, state.errors) == (state.errors, more.cost)


@pytest.mark.parametrize(("at", "gain", "any"), [("joint", 0.85, False), ("joint", 0.75, True), ("load", 0.85, True)])
def test_a_wave_of_the_angle_between_two_encoders_may_be_as_long_as_half_the_travel(monkeypatch, at, gain, any):
    monkeypatch.setattr(orders, "_share_beside_teeth", lambda *_: 0.0)
    inverses = inverse_dynamics([geared(0.0)], BAND)
    long = 1.4 * 2.0 * np.pi / np.ptp(inverses[0].motion.q)
    wave = find("kinematic_error" if at == "joint" else "cyclic_friction")(at=at, order=long)
    plant = jointed() + wave
    candidate = Candidate(wave.name, at, ADDITION, plant)
    asked = SimpleNamespace(
        candidate=candidate, refitted=SimpleNamespace(plant=plant), score=SimpleNamespace(gain=gain)
    )
    assert any_curve(asked, SimpleNamespace(inverses=inverses, plant=plant), STANDARD) is any


def test_a_pinions_turn_of_which_the_travel_holds_less_than_two_leads_beside_its_teeth():
    """Of both it takes less than `near`, and of what the teeth leave all; the teeth stand to it as many to one, which takes all that is left."""
    place = inverse_dynamics([geared(0.0)], BAND)[0].motion.q
    long = 1.6 * 2.0 * np.pi / np.ptp(place)
    state = State(held(JM), inverse_dynamics([geared(2e-4, long, teeth=9e-5)], BAND))
    offer = Offer(only={"kinematic_error", "flexible_mode"})
    turn = step(state, lambda _: None, offer)[0]
    assert turn.score.effect == "kinematic_error" and 0.5 < turn.score.gain < STANDARD.near
    teeth = step(turn.state, lambda _: None, offer)[0]
    assert teeth.candidate.key == "kinematic_error 2@joint" and teeth.score.gain > STANDARD.near
    found = teeth.state.plant["kinematic_error 2@joint"].parameters["order"].value
    assert found == pytest.approx(TEETH * long, rel=2e-3) and stranger(teeth.state.plant["kinematic_error 2@joint"], teeth.state.plant, state.inverses)  # fmt: skip


@pytest.mark.parametrize("wave", [2e-5, 5e-5])
def test_a_gears_wave_is_found_in_the_loads_balance_though_a_fit_of_free_masses_hides_it_in_the_drives(wave):
    state = State(jointed(), inverse_dynamics([geared(wave)], BAND))
    assert state.plant["linear_stiffness@joint"].parameters["stiffness"].value < 0.5 * K
    best = step(state, lambda _: None, Offer(only={"kinematic_error", "creep"}))[0]
    assert best.score.effect == "kinematic_error" and best.score.gain > 0.95
    assert best.refitted.plant["linear_stiffness@joint"].parameters["stiffness"].value == pytest.approx(K, rel=0.02)


def test_what_cogs_behind_the_joint_is_searched_where_it_shows():
    state = State(held(JM), inverse_dynamics([geared(0.0, 37.0, 60.0)], BAND))
    best = step(state, lambda _: None, Offer(only={"cogging"}))[0]
    values = best.refitted.plant[best.candidate.key].parameters
    assert (best.score.effect, best.score.at) == ("cogging", "load") and best.score.gain > 0.9
    assert values["order"].value == pytest.approx(37.0, rel=2e-3)
