"""Friction in proportion to the load that a contact carries: one definition in prediction, simulation and search."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from workbench.conformance.prediction import sees_no_drive
from workbench.definition import FORCE, Effect, catalogue, find
from workbench.errors import WorkbenchError
from workbench.identification.fit import identify
from workbench.inverse.balances import required
from workbench.inverse.dynamics import inverse_dynamics
from workbench.parameter import Parameter
from workbench.plant import ONE_MASS, TWO_MASS, Plant
from workbench.record import Record, Source
from workbench.simulation import open_loop
from workbench.tracing.candidates import WHOLE

DT, BAND = 2.5e-4, 60.0
INERTIA, WEIGHT, MU, SHARE = 0.01, 0.6, 0.08, 0.7


def loaded(**values: float) -> Effect:
    return find("load_dependent_friction")(**({"mu": MU, "share": SHARE} | values))


def pendulum(**values: float) -> Plant:
    plant = Plant(ONE_MASS) + find("inertia")(inertia=INERTIA) + find("viscous_friction")(viscous=0.02)
    return plant + find("gravity")(sine=WEIGHT) + find("coulomb_friction")(coulomb=0.03) + loaded(**values)


def elastic(at: str) -> Plant:
    plant = Plant(TWO_MASS)
    for e in (
        find("inertia")(at="motor", inertia=0.004),
        find("inertia")(at="load", inertia=0.008),
        find("viscous_friction")(at="motor", viscous=0.05),
        find("viscous_friction")(at="load", viscous=0.05),
        find("linear_stiffness")(stiffness=400.0),
        find("linear_damping")(damping=0.05),
        find("gravity")(at="load", sine=0.4),
        loaded(mu=0.1)(at=at),
    ):
        plant += e
    return plant


def recorded(plant: Plant, samples: int = 16000, lanes: int = 2) -> list[Record]:
    """Return the records of a plant under a drive of several waves, without counts."""
    t, lane = DT * np.arange(samples), np.arange(lanes)
    waves = ((1.1, 0.6), (0.5, 2.3), (0.3, 7.9))
    drive = sum(a * np.sin(2 * pi * f * (1 + 0.17 * lane) * t[:, None] + lane) for a, f in waves)
    run = open_loop(plant, drive, DT, substeps=8, resolution=1e-9)
    found = []
    for i in range(lanes):
        channels = {"torque": drive[:, i].copy(), "position": run["q"][:, i].copy()}
        if plant.kind == TWO_MASS:
            channels["load_position"] = run["load.q"][:, i].copy()
        found.append(Record(f"run_{i}", "identification", t, channels, {}, Source(Path("made"), "", "", {})))
    return found


@pytest.mark.parametrize(
    "plant",
    [pendulum(), pendulum(share=1.0), elastic("motor"), elastic("load")],
    ids=("share", "whole", "motor", "load"),
)
def test_a_simulated_motion_asks_for_the_drive_that_made_it(plant):
    for passes in inverse_dynamics(recorded(plant), BAND):
        m = passes.motion
        without = [e for e in plant.effects if e.name != "load_dependent_friction"]
        error, bare = (
            np.sqrt(np.mean(m.filter(m.u - required(passes, p))[m.keep] ** 2))
            for p in (plant, Plant(plant.kind, tuple(without)))
        )
        # what is left is the step of the integrator and the corner of friction at a reversal
        assert error < 0.01 * np.sqrt(np.mean(m.u**2)) and (error < 0.3 * bare or "load" in [e.at for e in without])


def test_of_two_masses_the_load_balance_closes_with_friction_at_the_load():
    from workbench.inverse.balances import balances

    plant = elastic("load")
    for passes in inverse_dynamics(recorded(plant), BAND):
        keep, smooth = passes.motion.keep, passes.motion.filter
        left, bare = (
            np.sqrt(np.mean(smooth(balances(passes, p)[1])[keep] ** 2))
            for p in (plant, plant.without("load_dependent_friction"))
        )
        assert left < 0.3 * bare


def test_the_acceleration_under_friction_that_depends_on_it_is_the_closed_form():
    """J a = u - T0 - mu |T0 + s J a| while it moves forward: one line on either side of the kink."""
    load, drive = -0.4, 0.05
    plant = Plant(ONE_MASS) + find("inertia")(inertia=INERTIA) + find("constant_offset")(offset=load) + loaded()
    n = 400
    run = open_loop(plant, np.full((n, 1), drive), DT, substeps=1, resolution=1e-9)
    acceleration = np.diff(run["v"][n // 2 :, 0]) / DT  # the direction is whole by now
    way = np.sign(load) * np.array([1.0, -1.0])
    both = [(drive - load - MU * w * load) / (INERTIA * (1.0 + MU * w * SHARE)) for w in way]
    (expected,) = [a for a, w in zip(both, way, strict=True) if np.sign(load + SHARE * INERTIA * a) == w]
    np.testing.assert_allclose(acceleration, expected, rtol=1e-9)


def test_friction_and_share_are_found_again_though_the_load_starts_wrong():
    plant = pendulum()
    begun = plant.swap(plant["inertia"](inertia=3 * INERTIA)).swap(plant["gravity"](sine=0.2 * WEIGHT))
    begun = begun.swap(loaded(mu=0.0, share=0.5))
    found = identify(begun, inverse_dynamics(recorded(plant), BAND)).plant
    values = found["load_dependent_friction"].parameters
    assert values["mu"].value == pytest.approx(MU, rel=0.03)
    assert values["share"].value == pytest.approx(SHARE, rel=0.1)
    assert found["inertia"].parameters["inertia"].value == pytest.approx(INERTIA, rel=0.01)


def test_a_drive_along_the_motion_is_no_friction_of_its_own():
    """What the model cannot explain of a drive must not come back as friction in proportion to that drive."""
    plant = pendulum(mu=0.0)
    rng = np.random.default_rng(3)
    found = []
    for r in recorded(plant):
        v = np.gradient(r.channels["position"], DT)
        extra = 0.3 * np.sign(v) * np.repeat(rng.uniform(0.0, 1.0, r.time.size // 400 + 1), 400)[: r.time.size]
        channels = {**r.channels, "torque": r.channels["torque"] + extra}
        found.append(Record(r.name, r.role, r.time, channels, {}, r.source))
    mu = identify(plant, inverse_dynamics(found, BAND)).plant["load_dependent_friction"].parameters["mu"].value
    assert mu < 0.1


def test_of_two_masses_the_share_is_held_and_is_no_candidate():
    assert not loaded().parameters["share"].fixed and loaded()(at="motor").parameters["share"].fixed
    assert loaded()(at="motor").free("share").parameters["share"].fixed
    assert "load_dependent_friction@motor" not in {s.key for s in WHOLE.candidates(elastic("motor"))}
    assert {
        s.at for s in WHOLE.candidates(elastic("motor").without("load_dependent_friction")) if "load_dep" in s.effect
    } == {
        "motor",
        "load",
    }


# --- no prediction sees the drive ---------------------------------------------------------------------------------------


def own(step, **given) -> Effect:
    said = {"name": "own", "cause": "test", "formula": "test", "source": "test", "port": FORCE, "linear": ("k",)}
    return Effect(step=step, parameters={"k": Parameter(1.0, "1", "test")}, **(said | given))


@pytest.mark.parametrize("name", catalogue())
def test_no_prediction_of_the_catalogue_sees_the_measured_drive(name):
    passed, sentence = sees_no_drive(find(name))
    assert passed, sentence


def test_an_own_force_that_reads_the_drive_does_not_pass_and_one_that_reads_the_load_does():
    drive = own(lambda s, z, p: ({}, p.k * s.u * s.dir), reads=("u", "dir"))
    with pytest.raises(WorkbenchError, match="reads 'u', the drive that it is a part of.* 'tau'"):
        sees_no_drive(drive)
    from workbench.conformance import check_effect

    (result,) = [r for r in check_effect(drive) if r.property == "prediction"]
    assert not result.passed and "must not see it" in result.sentence
    assert sees_no_drive(own(lambda s, z, p: ({}, p.k * s.tau * s.dir), reads=("tau", "dir")))[0]
    assert sees_no_drive(own(lambda s, z, p: ({}, p.k * s.tau), reads=("tau",), places=("joint",), at="joint"))[0]
