"""Gains over the relative displacement of two masses: equivalents of the joint, a PD for each amplitude, schedule, passivity."""

from dataclasses import replace

import numpy as np
import pytest

from workbench.definition import find
from workbench.description import Equivalent, equivalent
from workbench.design.families.family import scheduled_family
from workbench.design.families.linear import TwoMasses
from workbench.design.joint import joint_equivalent, joint_gains, joint_passivity, joint_schedule, unstable
from workbench.plant import TWO_MASS, Limits, Plant
from workbench.simulation import Loop
from workbench.tuning import TuningGoal
from workbench.tuning.response import damping_for, enter_time

LOOP = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, 1.57e-5, load_resolution=4.8e-6, feedback="load_position")
MOTOR, LOAD, DAMPING = 0.0074, 5e-5, 0.02
AMPLITUDES = np.geomspace(2e-5, 2e-3, 5)
GOAL = TuningGoal(overshoot=0.008, sensitivity=2.0)


def plant() -> Plant:
    inertia, friction = find("inertia"), find("presliding_hysteresis")
    effects = (
        inertia(inertia=MOTOR, at="motor"),
        inertia(inertia=LOAD, at="load"),
        find("piecewise_stiffness")(k1=440.0, k2=0.0, threshold=1e-3),
        friction(h0=0.05, x0=3e-4, at="joint"),
    )
    return Plant(TWO_MASS, effects, limits=Limits(3.3, 12.57))


@pytest.fixture(scope="module")
def spring() -> Equivalent:
    return joint_equivalent(plant(), AMPLITUDES)


@pytest.fixture(scope="module")
def gains(spring):
    return joint_gains(spring, MOTOR, (LOAD, LOAD + 5.3e-4), DAMPING, GOAL, LOOP)


def test_the_joint_is_its_straight_spring_and_the_integrals_of_its_hysteresis(spring):
    hysteresis = equivalent(plant()["presliding_hysteresis@joint"], AMPLITUDES)
    assert spring.stiffness == pytest.approx(
        440.0 + hysteresis.stiffness, rel=3e-3
    )  # its elements against the integrals
    assert spring.loss == pytest.approx(hysteresis.loss, rel=0.03, abs=0.5)


def test_gains_keep_the_sensitivity_with_every_load_and_none_on_a_grid_is_faster(spring, gains):
    loads = np.array([LOAD, LOAD + 5.3e-4])
    i = 2
    resonance = np.sqrt(spring.stiffness[i] * (1 / MOTOR + 1 / loads)).max()
    judge = TwoMasses(LOOP, MOTOR, loads, np.full(2, spring.stiffness[i]), DAMPING + spring.loss[i] / resonance)
    assert judge.peak(gains.kp[i].reshape(1, 1), gains.kd[i].reshape(1, 1))[0] <= 2.001
    inertia = MOTOR + loads[:, None]
    kp = np.geomspace(100.0, 3000.0, 30)[:, None]
    kd = np.geomspace(1.0, 20.0, 30)[None, :]
    kp, kd = (np.broadcast_to(v, (30, 30)).ravel() for v in (kp, kd))
    zeta = kd / (2.0 * np.sqrt(kp * inertia))
    fine = (judge.peak(kp[:, None], kd[:, None]) <= 2.0) & (zeta >= damping_for(0.008)).all(axis=0)
    time = (enter_time(zeta) / np.sqrt(kp / inertia)).max(axis=0)
    assert gains.time[i] <= 1.01 * time[fine].min()


def test_a_rigid_joint_gives_gains_that_the_joint_does_not_shape():
    stiff = Equivalent(AMPLITUDES[:2], np.array([1e5, 2e5]), np.zeros(2))
    found = joint_gains(stiff, MOTOR, (LOAD,), 1.0, GOAL, LOOP)
    assert found.kp[0] == pytest.approx(found.kp[1], rel=0.05)


def test_the_schedule_follows_the_relative_displacement_and_bears_the_plant_that_it_is_for(gains):
    made = joint_schedule(gains, LOOP, 8e-5, plant(), 2, 0.1)
    assert made.reversal == 8e-5 and made.plant_digest == plant().digest and made.rule == "following"
    judge = TwoMasses(LOOP, MOTOR, np.array([LOAD]), np.array([440.0]), DAMPING)
    family = scheduled_family(judge, made, "following", (250.0, 5.0), motor_speed=True, follows="joint")
    controller = family.controller(family.start[None, :], 2)
    assert controller.law.follows == "joint" and family.name == "scheduled PD (relative displacement)"


def test_gains_that_do_not_move_feed_nothing_in_and_gains_that_fall_do(gains):
    made = joint_schedule(gains, LOOP, 8e-5, plant(), 2, 0.1)
    flat = replace(made, kp=np.full(made.knots.size, 500.0), kd=np.full(made.knots.size, 5.0))
    assert np.abs(joint_passivity(flat, plant(), MOTOR, LOAD).pumping).max() < 1e-9
    falling = replace(flat, kp=500.0 * (made.knots / made.knots[0]) ** -0.5)
    fed = joint_passivity(falling, plant(), MOTOR, LOAD)
    assert fed.pumping[-1] > 0.0 and (fed.damping > 0.0).all()


def test_a_loop_is_stable_up_to_some_factor_on_its_gains(spring, gains):
    made = joint_schedule(gains, LOOP, 8e-5, plant(), 2, 0.1)
    found = unstable(made, spring, MOTOR, LOAD, DAMPING, LOOP, np.array([0.5, 1.0, 50.0]))
    assert not found[:2].any() and found[2].all()
