"""What every controller is asked to do: the time-optimal bound, what a worst case costs, and the figures of a step."""

from types import SimpleNamespace

import numpy as np
import pytest

from workbench.control import fixed_pd
from workbench.definition import find
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.simulation import Loop
from workbench.task.bound import time_optimal
from workbench.task.stepping import figures_of
from workbench.task.task import Task, Weights, cost

STEP = 0.4 * 2 * np.pi
LOOP = Loop(2.5e-4, 2, 2.5e-4, 2.5e-4, 4.848e-6)


def axis(inertia=0.0074, drive=3.3, rpm=120.0) -> Plant:
    effects = (find("inertia")(inertia=inertia), find("presliding_hysteresis")(h0=0.15, x0=1 / 636))
    return Plant(ONE_MASS, effects, limits=Limits(drive, rpm * 2 * np.pi / 60))


@pytest.mark.parametrize(
    ("inertia", "drive", "rpm", "free", "loaded"),
    [(0.0026, 1.8, 200, 0.1423, 0.1477), (0.0074, 3.3, 120, 0.2179, 0.2195), (0.029, 4.8, 60, 0.4208, 0.4214)],
)
def test_the_time_optimal_bound_is_that_of_the_catalogue_actuators(inertia, drive, rpm, free, loaded):
    plant = axis(inertia, drive, rpm)
    assert time_optimal(plant, STEP) == pytest.approx(free, abs=1e-4)
    assert time_optimal(plant, STEP, load_inertia=5.3e-4) == pytest.approx(loaded, abs=1e-4)


def test_without_friction_or_speed_limit_the_bound_is_the_closed_form_of_bang_bang():
    plant = Plant(ONE_MASS, (find("inertia")(inertia=1.0),), limits=Limits(1.0))
    whole, last = (
        2 * np.sqrt(1.0),
        np.sqrt(2 * 0.01),
    )  # to rest at 1 with unit acceleration, less the way inside the band
    assert time_optimal(plant, 1.0, band=0.01) == pytest.approx(whole - last, rel=1e-4)


def test_a_scenario_that_overshoots_does_not_pay_with_a_small_error_there():
    """Two scenarios, one with the larger error and one that overshoots by twice what is allowed: the excess counts in full."""
    task = Task(axis(), LOOP, 1.0, 0.2, weights=Weights(overshoot=0.002, steepness=200.0))
    metrics = SimpleNamespace(
        time_1pct=np.array([0.2, 0.1]), final_error=np.array([1e-3, 1e-6]), overshoot=np.array([0.0, 0.004]),
        ripple=np.zeros(2),
    )  # fmt: skip
    fine = SimpleNamespace(**vars(metrics) | {"overshoot": np.zeros(2)})
    assert cost(task, metrics, 0.1, 2)[0] - cost(task, fine, 0.1, 2)[0] == pytest.approx(200.0 * 0.002)


def test_a_step_that_never_settles_costs_more_than_any_that_does():
    task = Task(axis(), LOOP, STEP, 0.4)
    scenarios = task.scenarios(phases=1)
    good, idle = (task.run(fixed_pd(kp, kd), scenarios) for kp, kd in ((50.0, 1.0), (0.01, 0.0)))
    assert cost(task, idle, task.bound(), 1)[0] > 10 > cost(task, good, task.bound(), 1)[0]


def test_scenarios_are_every_combination_and_no_two_land_on_one_fraction_of_a_count():
    task = Task(axis(), LOOP, STEP, 0.4, load_inertias=(0.0, 1e-3), frictions=(1.0, 2.0), phases=3)
    made = task.scenarios()
    assert made.lanes == 12 and {*zip(made.load_inertia, made.friction, strict=True)} == {
        (0.0, 1.0), (0.0, 2.0), (1e-3, 1.0), (1e-3, 2.0)
    }  # fmt: skip
    share = (made.target - STEP) / LOOP.count
    assert ((share >= 0.0) & (share < 1.0)).all() and np.unique(np.round(share, 6)).size == 12


def test_the_figures_of_a_step_are_those_of_the_closed_form_of_a_first_and_a_second_order_response():
    t = 1e-4 * np.arange(20_000)
    z, w = 0.5, 50.0
    damped = w * np.sqrt(1 - z * z)
    second = 1 - np.exp(-z * w * t) * (np.cos(damped * t) + z / np.sqrt(1 - z * z) * np.sin(damped * t))
    figures = figures_of(np.column_stack([1 - np.exp(-t / 0.05), second]), np.zeros(2), np.array([1.0, 1.0]), 1e-4)
    assert figures.time[0] == pytest.approx(0.05 * np.log(100.0), rel=1e-3)
    assert figures.rise[0] == pytest.approx(0.05 * np.log(9.0), abs=2e-4)
    assert figures.overshoot == pytest.approx([0.0, np.exp(-np.pi * z / np.sqrt(1 - z * z))], abs=1e-5)


def test_a_step_that_goes_the_wrong_way_or_is_not_at_rest_has_no_figures():
    t = np.linspace(0.0, 1.0, 1000)
    figures = figures_of(np.column_stack([-t.clip(0, 0.1), t]), np.zeros(2), np.ones(2), 1e-3)
    assert np.isinf(figures.time).all() and np.isinf(figures.error).all()
