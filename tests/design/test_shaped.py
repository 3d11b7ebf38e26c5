"""Families with a velocity filter and a notch among their numbers."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from workbench.control.notched import response
from workbench.design.families.family import pd_family
from workbench.design.families.linear import Linear, TwoMasses, peak_of
from workbench.design.families.shaped import judged, shaped, stiffest
from workbench.simulation import Loop, loop_under

LOOP = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, 4.848e-6)
MASSES = TwoMasses(LOOP, 0.0074, np.array([5.8e-4]), np.array([440.0]), 0.02)
PD = 300.0, 6.0


def fixed(judge):
    return pd_family(judge, PD)


def test_with_the_loops_own_filter_and_a_notch_without_depth_a_family_is_what_it_was():
    family = shaped(fixed, MASSES, LOOP.velocity_filter, (150.0, 1.0))
    assert family.numbers == ("kp", "kd", "velocity_filter", "notch", "notch depth")
    assert family.sensitivity(family.start[None, :]) == pytest.approx(
        fixed(MASSES).sensitivity(np.array([PD])), rel=1e-9
    )


def test_the_sensitivity_of_a_notched_law_is_that_of_its_response():
    point = np.array([[*PD, 5e-4, 130.0, 0.3]])
    family = shaped(fixed, MASSES, 5e-4, (130.0, 0.3))
    other = replace(MASSES, loop=replace(LOOP, velocity_filter=5e-4))
    notch = response([SimpleNamespace(centre=130.0, damping=0.7, depth=0.3)], other.theta, LOOP.sample_time)
    whole = notch * (PD[0] * other.position[0] + PD[1] * other.rate * other.speed[0])
    assert family.sensitivity(point)[0] == pytest.approx(peak_of(whole, 2), rel=1e-9)
    named = dict(zip(family.numbers, point[0], strict=True))
    assert fixed(judged(MASSES, named)).sensitivity(np.array([PD]))[0] == pytest.approx(peak_of(whole, 2), rel=1e-9)


def test_a_notch_lets_a_law_on_two_masses_be_stiffer_within_the_same_sensitivity():
    bare = np.geomspace(50.0, 2000.0, 400)
    kept = fixed(MASSES).sensitivity(np.stack([bare, bare / 50.0], axis=1)) <= 2.0
    found = stiffest(MASSES, 50.0, 2.0)
    family = shaped(fixed, MASSES, found["velocity_filter"], (found["notch"], found["notch depth"]))
    point = np.array([[found["kp"], found["kp"] / 50.0, *family.start[2:]]])
    assert family.sensitivity(point)[0] <= 2.001 and found["kp"] > 1.3 * bare[kept].max()


def test_each_lane_of_a_controller_has_its_own_filter_and_notch_and_a_loop_takes_the_filter():
    family = shaped(fixed, MASSES, 5e-4, (130.0, 0.3))
    points = np.array([[*PD, 5e-4, 130.0, 0.3], [*PD, 1e-3, 200.0, 1.0]])
    made = family.controller(points, 2)
    assert made.velocity_filter.tolist() == [5e-4, 5e-4, 1e-3, 1e-3] and made.parameters["notch_b0"].shape == (4,)
    assert made.parameters["notch_b0"][2] == pytest.approx(1.0)
    assert loop_under(family.controller(points[1:], 1), LOOP).velocity_filter == 1e-3
    assert loop_under(fixed(MASSES).controller(np.array([PD]), 1), LOOP) == LOOP


def test_on_one_mass_a_quick_filter_keeps_a_margin_that_a_slow_one_does_not():
    linear = Linear(LOOP, 0.0074, 0.0, np.array([0.0, 95.0]))
    family = shaped(fixed, linear, 1e-4)
    quick, slow = family.sensitivity(np.array([[2000.0, 8.0, 5e-5], [2000.0, 8.0, 1e-3]]))
    assert family.numbers[-1] == "velocity_filter" and quick < slow


@pytest.mark.parametrize("ratio", [50.0, 300.0])
def test_on_one_mass_a_wide_notch_lets_a_pd_be_half_as_stiff_again_within_the_same_sensitivity(ratio):
    linear = Linear(LOOP, 0.0074, 0.0, np.array([0.0, 95.0]))
    bare = np.geomspace(100.0, 5000.0, 600)
    plain = np.stack([bare, bare / ratio, np.full_like(bare, 5e-5)], axis=1)
    kept = shaped(fixed, linear, 5e-5).sensitivity(plain) <= 2.0
    found = stiffest(linear, ratio, 2.0)
    point = np.array(
        [[found["kp"], found["kp"] / ratio, *(found[n] for n in ("velocity_filter", "notch", "notch depth"))]]
    )
    assert shaped(fixed, linear, 5e-5, (260.0, 0.5)).sensitivity(point)[0] <= 2.001
    assert found["kp"] > 1.5 * bare[kept].max()
