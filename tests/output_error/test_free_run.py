"""The free run of a record: closed forms of an axis without a controller, and parameters from it."""

from dataclasses import replace

import numpy as np
import pytest

from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.inverse.dynamics import inverse_dynamics
from workbench.motion import motion
from workbench.output_error.free_run import START, beginning, carried_over, free_run, halves, refine_free_run
from workbench.plant import ONE_MASS, TWO_MASS, Plant
from workbench.record import VALIDATION, Record, Source
from workbench.simulation import Scenario, open_loop

MASS, VISCOUS, COULOMB, DT, BAND = 95.0, 200.0, 20.0, 1e-3, 40.0
SOURCE = Source(path="made.csv", sha256="0" * 64, reader="csv", columns={})


def axis(coulomb: float = COULOMB, viscous: float = VISCOUS) -> Plant:
    effects = (find("inertia")(inertia=MASS), find("viscous_friction")(viscous=viscous))
    effects += (find("coulomb_friction")(coulomb=coulomb),) if coulomb else ()
    return Plant(ONE_MASS, effects, rotary=False)


def record(position: np.ndarray, force: np.ndarray) -> Record:
    return Record(
        name="made",
        role="identification",
        time=DT * np.arange(force.size),
        channels={"position": position, "force": force},
        units={"position": "m", "force": "N"},
        source=SOURCE,
        resolution={"position": 50e-9},
    )


def moved(plant: Plant, n: int = 4000) -> Record:
    t = DT * np.arange(n)
    force = 60.0 * np.sign(np.sin(2 * np.pi * 0.6 * t)) + 40.0 * np.sin(2 * np.pi * 1.7 * t)
    return record(open_loop(plant, force, DT, 2, resolution=50e-9)["q"][:, 0], force)


def test_an_axis_that_is_let_go_in_motion_coasts_to_the_closed_form():
    t, speed = DT * np.arange(3000), 0.1
    coasted = speed * MASS / VISCOUS * (1.0 - np.exp(-VISCOUS / MASS * t))
    made = record(coasted + 0.02, np.zeros(t.size))
    assert beginning(made) == pytest.approx((0.02, speed), rel=1e-3)
    # semi-implicit steps of half a millisecond: b h/(2 M) of the way too far
    assert free_run(axis(coulomb=0.0), motion(made, BAND)).error < 2e-3 * coasted[-1]


def test_lanes_that_start_in_motion_are_each_their_own():
    scenarios = [Scenario(speed=v) for v in (0.0, 0.1, -0.2)]
    q = open_loop(axis(coulomb=0.0), np.zeros((100, 3)), DT, scenarios=scenarios)["q"]
    assert (q[:, 0] == 0.0).all()
    np.testing.assert_allclose(q[:, 2], -2.0 * q[:, 1], rtol=1e-12)


def test_two_masses_start_in_motion_together():
    effects = (find("inertia")(inertia=1.0, at="motor"), find("inertia")(inertia=2.0, at="load"),
               find("linear_stiffness")(stiffness=1e3, at="joint"))  # fmt: skip
    run = open_loop(Plant(TWO_MASS, effects), np.zeros((200, 1)), DT, scenarios=[Scenario(speed=0.3)])
    np.testing.assert_allclose(run["q"][:, 0], 0.3 * DT * np.arange(200), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(run["load.q"], run["q"], rtol=1e-9, atol=1e-12)


def test_a_record_of_the_plant_itself_runs_free_without_error():
    made = moved(axis())
    found = free_run(axis(), motion(made, BAND))
    assert found.error < 2e-5 < 1e-2 * np.ptp(made.channels["position"])  # the first speed, from START readings
    assert found.simulated.shape == made.time.shape and START == 20


def test_a_lacking_force_drifts_by_its_share_of_the_viscous_coefficient():
    """b dx/dt = dF: a constant 1 N that the model lacks moves it by 5 mm a second, whatever the mass, after b/M."""
    n, force = 6000, 60.0
    made = record(open_loop(axis(), np.full(n, force), DT)["q"][:, 0], np.full(n, force))
    away = free_run(axis(COULOMB - 1.0), motion(made, BAND)).simulated - made.channels["position"]
    assert (away[5999] - away[4999]) / (DT * 1000) == pytest.approx(1.0 / VISCOUS, rel=1e-3)


def test_friction_is_found_from_the_free_run_of_a_record_of_any_role():
    made = moved(axis())
    inverses = inverse_dynamics([replace(made, role=VALIDATION)], BAND)
    found = refine_free_run(axis(coulomb=22.0, viscous=190.0), inverses)
    assert found["coulomb_friction"].parameters["coulomb"].value == pytest.approx(COULOMB, rel=5e-3)
    assert found["viscous_friction"].parameters["viscous"].value == pytest.approx(VISCOUS, rel=5e-3)


def test_what_is_fixed_stays():
    stiff = axis(coulomb=22.0)
    inertia = stiff["inertia"]
    held = stiff.swap(replace(inertia, parameters={n: replace(p, fixed=True) for n, p in inertia.parameters.items()}))
    found = refine_free_run(held, inverse_dynamics([moved(axis())], BAND))
    assert found["inertia"].parameters["inertia"].value == MASS
    assert found["coulomb_friction"].parameters["coulomb"].value == pytest.approx(COULOMB, rel=5e-3)


def test_halves_are_the_record_and_begin_where_they_begin():
    made = moved(axis(), 501)
    first, second = halves(made)
    for channel, x in made.channels.items():
        np.testing.assert_array_equal(np.concatenate([first.channels[channel], second.channels[channel]]), x)
    assert first.time[-1] + DT == pytest.approx(second.time[0]) and first.dt == pytest.approx(second.dt)
    assert first.history == made.history and second.history is None  # the second half is in motion where it begins
    assert first.name != second.name and first.role == second.role == made.role


def test_what_one_half_says_carries_over_where_nothing_wanders():
    plant = axis(coulomb=22.0)
    for e in (plant["inertia"], plant["viscous_friction"]):  # two seconds do not tell them from Coulomb friction
        plant = plant.swap(replace(e, parameters={n: replace(p, fixed=True) for n, p in e.parameters.items()}))
    for half in carried_over(plant, motion(moved(axis()), BAND)):
        assert half.plant["coulomb_friction"].parameters["coulomb"].value == pytest.approx(COULOMB, rel=5e-3)
        assert max(half.own, half.other) < 2e-4


def test_a_level_that_wanders_carries_over_to_neither_half():
    made = moved(axis())
    lacking = np.where(np.arange(made.time.size) < made.time.size // 2, 0.0, -1.0)  # an offset of the second half
    force = made.channels["force"]
    axis_with = axis() + find("constant_offset")
    wandered = record(open_loop(axis(), force + lacking, DT, 2, resolution=50e-9)["q"][:, 0], force)
    first, second = carried_over(axis_with, motion(wandered, BAND))
    offsets = [h.plant["constant_offset"].parameters["offset"].value for h in (first, second)]
    assert offsets == pytest.approx([0.0, 1.0], abs=0.05)
    assert min(first.other, second.other) > 10 * max(first.own, second.own)


def test_two_masses_are_refused():
    effects = (find("inertia")(inertia=1.0, at="motor"), find("inertia")(inertia=1.0, at="load"),
               find("linear_stiffness")(stiffness=1e3, at="joint"))  # fmt: skip
    with pytest.raises(WorkbenchError, match="compared by one position"):
        free_run(Plant(TWO_MASS, effects), motion(moved(axis(), 500), BAND))
