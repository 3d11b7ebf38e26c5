"""Gains optimised on the simulated step: its figures, the edge of the sensitivity, and that nothing near does better."""

import numpy as np
import pytest
from paper_axis import LOOP, plant

from workbench.description import Equivalent
from workbench.design.polish import Polished, Search, polish
from workbench.task.stepping import FIGURES, figures_of
from workbench.task.task import Task, Weights
from workbench.tuning import TuningGoal, response, sampled, tuned_axis
from workbench.tuning.axis import Axis
from workbench.tuning.reach import stiffest
from workbench.verification.promise import promise

AMPLITUDES = np.array([0.9e-3, 4.3e-3, 0.021])


@pytest.fixture(scope="module")
def goal() -> TuningGoal:
    return TuningGoal(drive=3.3, speed=12.57)


@pytest.fixture(scope="module")
def task() -> Task:
    weights = Weights(error=0.4, overshoot=0.008)
    return Task(plant(), LOOP, 2.5, 0.5, frictions=(0.5, 1.5), inertias=(0.5, 1.5), weights=weights)


@pytest.fixture(scope="module")
def described(goal):
    return tuned_axis(plant(), AMPLITUDES, goal, LOOP)


@pytest.fixture(scope="module")
def found(described, goal, task) -> Polished:
    return polish(described, goal, task)


def test_figures_of_a_second_order_step_are_those_of_its_closed_form():
    zeta, dt = np.array([0.6, 0.83, 1.2]), 1e-3
    tau = dt * np.arange(40000)
    q = 0.1 + 2.0 * (1.0 - np.stack([response.remainder(np.full(tau.size, z), tau) for z in zeta], axis=1))
    got = figures_of(q, np.full(3, 0.1), np.full(3, 2.2), dt)
    assert got.time[1:] == pytest.approx(response.enter_time(zeta[1:]), abs=dt)
    assert got.overshoot == pytest.approx(response.overshoot(zeta), abs=1e-6)
    assert got.error == pytest.approx(np.full(3, 0.1), abs=1e-6)
    assert (np.diff(got.rise) > 0).all()


def test_a_step_that_does_not_come_to_rest_or_goes_the_other_way_has_no_figures():
    t = np.linspace(0.0, 1.0, 1001)[:, None]
    q = np.concatenate([t, -(1 - np.exp(-20 * t)), np.full_like(t, np.nan)], axis=1)
    assert np.isinf(figures_of(q, np.zeros(3), np.ones(3), 1e-3).time).all()


def test_gains_at_the_edge_of_the_sensitivity_have_just_that_sensitivity():
    amplitude = np.array([1e-4, 1e-2])
    axis = Axis.of(Equivalent(amplitude, np.array([20.0, 0.0]), np.zeros(2)), 0.0074, 0.0, LOOP)
    ratio = np.tile(np.geomspace(40.0, 250.0, 7), (2, 1)) * LOOP.sample_time
    for limit in (1.5, 2.0):
        kp = stiffest(axis, ratio, limit)
        rows = np.repeat([0, 1], 7)
        part, flat = axis.take(rows), kp.ravel()
        motion = part.steps(flat)
        peak, _ = sampled.sensitivity_peak(flat, flat / ratio.ravel(), motion, part.clock)
        radius = sampled.spectral_radius(flat, flat / ratio.ravel(), motion, part.clock)
        inside = flat > 0.05 * flat.max()  # the soft end of a spring without loss has limits of its own
        assert inside.sum() >= 12 and peak[inside] == pytest.approx(limit, rel=2e-3) and (radius < 1.0).all()


def test_simulated_steps_settle_in_half_the_time_of_the_closed_forms_gains(found, described, goal):
    time = found.nominal.nominal.time
    assert time[0] <= 4.9e-3 and time[1] <= 11e-3 and time[2] <= 27e-3
    assert (found.nominal.worst.overshoot <= goal.overshoot * 1.01).all()
    assert (found.nominal.sensitivity_peak <= 2.001).all() and (found.robust.sensitivity_peak <= 2.001).all()


def test_robust_gains_keep_the_overshoot_in_every_scenario_and_cost_time_on_the_nominal_plant(found, goal):
    assert (found.robust.worst.overshoot <= goal.overshoot * 1.01).all()
    assert (found.price > 1.2).all() and (found.robust.worst.time >= found.robust.nominal.time).all()


def test_no_gains_drawn_at_random_beat_those_that_were_found(found, described, goal, task):
    search = Search(Axis.of(described.equivalent, 0.0074, 0.0, LOOP), described.gains, goal, task)
    draw = np.random.default_rng(5)
    rows = np.repeat(np.arange(3), 200)
    kp = np.log(found.nominal.kp[rows]) + draw.uniform(-1.0, 0.2, rows.size)
    ratio = np.log(found.nominal.kp / found.nominal.kd)[rows] + draw.uniform(-0.7, 0.7, rows.size)
    cost = search.tried(rows, kp, ratio, ((1.0, 1.0),)).cost.reshape(3, -1).min(axis=1)
    assert (cost >= found.nominal.cost - 0.01).all()


def test_what_is_promised_is_what_the_axis_does_within_a_sample(found, task):
    held = promise(plant(), found, task)
    assert held.deviation <= LOOP.sample_time
    assert held.read.tolist() == [False, True, True]  # 0.2 % of 0.9 mrad is less than half a count
    stiffer = promise(plant().without("presliding_hysteresis"), found, task)
    assert stiffer.deviation > 2 * LOOP.sample_time  # gains of another plant do not keep what was promised for this one


class Patient(Search):
    """Meets every candidate in every scenario, whatever the best so far costs."""

    def tried(self, rows, kp, ratio, scenarios, best=None):
        return super().tried(rows, kp, ratio, scenarios)


def test_what_is_given_up_after_its_dearest_scenario_would_not_have_been_the_best(described, goal, task, found):
    rigid = described.rigid
    axis = Axis.of(described.equivalent, rigid.inertia, rigid.viscous, LOOP)
    every = Patient(axis, described.gains, goal, task).run(found.robust.scenarios)
    for n in ("kp", "kd", "cost"):
        assert getattr(found.robust, n).tolist() == getattr(every, n).tolist()
    for n in FIGURES:
        assert getattr(found.robust.worst, n).tolist() == getattr(every.worst, n).tolist()
        assert getattr(found.robust.nominal, n).tolist() == getattr(every.nominal, n).tolist()


def test_what_costs_no_less_than_the_best_in_its_dearest_scenario_is_met_in_no_other(
    described, goal, task, found, monkeypatch
):
    axis = Axis.of(described.equivalent, described.rigid.inertia, described.rigid.viscous, LOOP)
    search, scenarios = Search(axis, described.gains, goal, task), found.robust.scenarios
    rows, kp, ratio = np.arange(AMPLITUDES.size), np.log(found.robust.kp), np.log(found.robust.kp / found.robust.kd)
    best, met = search.tried(rows, kp, ratio, scenarios), []
    monkeypatch.setattr(Search, "meet", lambda self, _, scenarios, which, at: met.append(at.size))
    search.tried(rows, kp, ratio, scenarios, best)  # nothing comes to any figures, and so costs without end
    assert met == [rows.size, 0] and np.isfinite(best.cost).all()
