"""A compensated controller as a contestant: its margin, its family, its place on the ladder and in the recommendation."""

from dataclasses import replace

import numpy as np
import pytest

from workbench.cancellation.contestant import amplitudes, entered, judge, returned
from workbench.compensation import Compensator, compensated
from workbench.control import fixed_pd
from workbench.definition import find
from workbench.design.families.family import pd_family
from workbench.design.families.linear import Linear, peak_of
from workbench.design.optimise import SEEDS, Tuned
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.robustness.document import of_controller
from workbench.robustness.workload import single
from workbench.simulation import Loop, ScenarioArrays, simulate
from workbench.verification.candidates import known_to

LOOP = Loop(2.5e-4, 2, 2.5e-4, 2.5e-4, 1e-6)
SPRING = find("linear_stiffness")(stiffness=200.0, at="axis")
STOP = find("stop")(stiffness=500.0, radius=1e-4)
PLANT = Plant(
    ONE_MASS, (find("inertia")(inertia=0.01), find("viscous_friction")(viscous=0.05), STOP), limits=Limits(3.0, 20.0)
)
LINEAR = Linear(LOOP, 0.01, 0.05, np.array([0.0, 500.0]))
PD = np.array([[100.0, 2.0]])


def ms(judged) -> float:
    return float(pd_family(judged, (100.0, 2.0)).sensitivity(PD)[0])


def of(source="measured", plant=PLANT, names=("stop",), **options) -> Compensator:
    return Compensator.of(plant, names, source=source, **options)


def test_from_the_reference_the_margin_is_the_controllers_own():
    assert judge(LINEAR, PLANT, of("reference")) is LINEAR


def test_a_spring_that_is_cancelled_at_once_leaves_the_loop_of_the_bare_mass():
    """With no delay of its own and no dead band, 1 - F P turns the plant with the spring into the one without, exactly."""
    theta, k = LINEAR.theta, 30.0
    late = LINEAR.responses(np.array([k]))[0]
    bare = late / (1.0 - k * late)
    c = (PD[0, 0] + PD[0, 1] * LINEAR.rate)[None, :]
    fed = np.full(theta.size, k)
    expected = 1.0 / np.abs(1.0 + c * bare).min()
    assert returned(c, late, fed, 0)[0] == pytest.approx(expected, rel=1e-9)


def test_the_margin_of_the_measured_source_falls_with_gain_and_delay():
    exact, late, much = (ms(judge(LINEAR, PLANT, of(**o))) for o in ({}, {"delay": 20}, {"gain": 3.0}))
    assert 1.0 < exact < late < much == np.inf


def test_where_the_linear_loop_falls_the_simulated_one_does():
    """A spring to ground that is cancelled many times over: the Nyquist criterion and the loop agree on both sides."""
    plant = Plant(
        ONE_MASS,
        (find("inertia")(inertia=0.01), find("viscous_friction")(viscous=0.05), SPRING),
        limits=Limits(3.0, 20.0),
    )
    linear = Linear(LOOP, 0.01, 0.05, np.array([200.0]))
    for gain, stands in ((1.0, True), (1.4, True), (1.7, False)):
        named = of("measured", plant, ("linear_stiffness",), gain=gain)
        assert np.isfinite(ms(judge(linear, plant, named))) == stands
        m = simulate(
            plant, LOOP, compensated(fixed_pd(*PD[0]), named), ScenarioArrays(1, target=1e-3), 1.0, ("q",), lanes=1
        )
        assert (abs(m.trajectories["q"][-1, 0]) < 0.01) == stands


def test_amplitudes_reach_from_two_counts_to_sliding():
    a = amplitudes(PLANT, LOOP)
    assert a[0] == 2e-6 and a[-1] > 50 * 1e-4


def tuned(family, point) -> Tuned:
    return Tuned(family, point, 1.0, 1, SEEDS[0], None)


def test_a_compensated_family_is_tuned_about_the_numbers_of_its_law_and_knows_more():
    base = pd_family(LINEAR, (100.0, 2.0))
    family = entered(base, of("reference"), PD[0])
    assert family.name == "fixed PD, compensated" and np.array_equal(family.start, PD[0])
    assert known_to(tuned(family, PD[0])) == known_to(tuned(base, PD[0])) + len(STOP.parameters)


def test_a_controller_of_many_lanes_is_written_as_the_one_that_it_is():
    one = single(compensated(fixed_pd(np.full(3, 100.0), np.full(3, 2.0)), of("reference")))
    assert of_controller(one)["base"]["parameters"] == {"kp": 100.0, "kd": 2.0}


def test_a_compensated_cascade_keeps_its_own_velocity_filter():
    made = compensated(replace(fixed_pd(100.0, 2.0), velocity_filter=1e-3), of("reference"))
    assert made.velocity_filter == 1e-3


def test_instability_is_infinite():
    assert np.isinf(returned(np.full((1, 160), 1e6 + 0j), LINEAR.position[1], np.zeros(160), 0)[0])
    assert np.isinf(peak_of(1e6 * LINEAR.position[1][None, :], 0)[0])
