"""What gains are worth: the equivalents of all friction together, the search, the comparison."""

import numpy as np
import pytest

from workbench.control import fixed_pd
from workbench.definition import find
from workbench.description import equivalent
from workbench.description.friction import equivalent_of, friction_of
from workbench.design.design import linear_of
from workbench.design.families.family import blended, cascade_family, pd_family
from workbench.design.families.linear import Linear
from workbench.design.optimise import Budget, optimise, optimise_seeds
from workbench.design.tries import Trail
from workbench.errors import WorkbenchError
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.simulation import Loop
from workbench.task.bound import time_optimal
from workbench.task.task import Task, Weights, cost, least
from workbench.verification.compare import Comparison, Row, compare
from workbench.verification.wording import verdicts

STEP = 0.4 * 2 * np.pi
LOOP = Loop(2.5e-4, 2, 2.5e-4, 2.5e-4, 4.848e-6)


def axis(inertia=0.0074, drive=3.3, rpm=120.0, *more) -> Plant:
    effects = (find("inertia")(inertia=inertia), find("presliding_hysteresis")(h0=0.15, x0=1 / 636), *more)
    return Plant(ONE_MASS, effects, limits=Limits(drive, rpm * 2 * np.pi / 60))


def test_the_equivalent_of_a_lone_hysteresis_is_that_of_its_integrals():
    friction, inertia, viscous = friction_of(axis())
    a = np.array([1e-3, 1e-2, 0.1])
    stepped, exact = (
        equivalent_of(friction, a, np.full(3, 50.0), 1e-6),
        equivalent(friction["presliding_hysteresis"], a),
    )
    assert (inertia, viscous) == (0.0074, 0.0)
    assert stepped.stiffness == pytest.approx(exact.stiffness, rel=0.01)
    assert stepped.loss == pytest.approx(exact.loss, rel=0.02)


def test_stribeck_friction_stiffens_slow_motion_and_is_gone_in_fast_motion():
    plain, _, _ = friction_of(axis())
    with_drop = plain + find("stribeck_friction")(drop=0.075, speed=0.5)
    a = np.array([1e-3])
    slow, fast = (
        equivalent_of(with_drop, a, [w], 1e-6).loss / equivalent_of(plain, a, [w], 1e-6).loss for w in (1.0, 1e6)
    )
    assert slow == pytest.approx(1.5, rel=0.01) and fast == pytest.approx(1.0, rel=0.01)


def test_a_part_that_swings_is_mass_of_the_rigid_axis_and_no_friction_over_amplitude():
    swinging = axis() + find("flexible_mode")(mass=1e-3, frequency=30.0, damping=0.05)
    rigid = axis()
    friction, inertia, viscous = friction_of(swinging)
    known, alone, same = friction_of(rigid)
    assert (inertia, viscous) == (pytest.approx(alone + 1e-3), same)
    assert [e.key for e in friction.effects] == [e.key for e in known.effects]
    assert time_optimal(swinging, 1.0) == pytest.approx(time_optimal(rigid, 1.0, load_inertia=1e-3))


def test_gains_of_a_plant_hold_their_limits_at_every_amplitude():
    from workbench.tuning import TuningGoal, tuned_axis

    a = np.geomspace(1e-4, 1.0, 8)
    found = tuned_axis(axis(), a, TuningGoal(drive=3.3, speed=12.57), LOOP)
    equivalents, gains = found.equivalent, found.gains
    assert np.all(gains.kp * a <= 3.3 * 1.001) and np.all(gains.sensitivity_peak <= 2.0 * 1.005)
    assert np.all(gains.spectral_radius < 1.0) and np.all(np.diff(equivalents.stiffness) < 0)


def test_the_sensitivity_of_a_law_is_that_of_python_control():
    import control

    linear = Linear(Loop(1e-3, 1), 1.0, 0.5, np.array([0.0]))
    kp, kd = 2000.0, 60.0
    plant = control.c2d(control.tf([1], [1, 0.5, 0]), 1e-3, "zoh")
    z = control.tf([1, 0], [1], 1e-3)
    law = kp + kd * (1 - 1 / z) / 1e-3
    w = np.geomspace(1.0, np.pi / 1e-3, 4000)
    expected = np.max(1 / np.abs(1 + np.squeeze((plant * law)(np.exp(1j * w * 1e-3)))))
    family = pd_family(linear, (kp, kd))
    assert family.sensitivity(np.array([[kp, kd]]))[0] == pytest.approx(expected, rel=0.01)


def test_the_search_improves_on_its_start_and_keeps_to_the_sensitivity_limit():
    small = Budget(generations=6, local=20)
    plant = axis()
    task = Task(plant, LOOP, STEP, 0.4, phases=1, weights=Weights(overshoot=0.008))
    from workbench.tuning import TuningGoal, tuned_axis

    found = tuned_axis(plant, np.geomspace(1e-3, 1.0, 4), TuningGoal(drive=3.3, speed=12.57), LOOP)
    linear = linear_of(found.rigid, found.equivalent, LOOP)
    for family in (pd_family(linear, (60.0, 1.0)), cascade_family(linear, (60.0, 1.0, 5.0), 12.57)):
        found = optimise(task, family, 3, small)
        first = task.run(family.controller(family.start[None, :], 1), task.scenarios())
        assert found.value <= cost(task, first, task.bound(), 1)[0]
        assert family.sensitivity(found.point[None, :])[0] <= 2.0 * 1.01
        both = optimise_seeds(task, family, (3, 4, 5), small)
        assert found.value == both.runs[0].value and found.trail.time.size == found.evaluations
        assert sorted(r.value for r in both.runs)[1] == both.median.value


SEVERAL = {"frictions": (0.5, 1.5), "inertias": (0.5, 1.0, 1.5), "load_inertias": (0.0, 5.3e-4)}


@pytest.mark.parametrize(
    "more",
    [{}, SEVERAL, SEVERAL | {"frictions": (1.0, 1.5), "nominal": True}],
    ids=["one scenario", "twelve", "nominal"],
)
def test_points_that_can_take_no_place_are_not_simulated_to_their_end_and_nothing_depends_on_it(monkeypatch, more):
    from workbench.design import optimise as module

    linear = Linear(LOOP, 0.0075, 0.001, np.array([0.0, 100.0]))
    task = Task(axis(), LOOP, STEP, 0.4, phases=1, **more)
    family = pd_family(linear, (60.0, 1.0))
    found = optimise(task, family, 3, Budget(generations=12, local=20))
    monkeypatch.setattr(module.Tries, "replaced_below", lambda self, intermediate_result: None)
    every = optimise(task, family, 3, Budget(generations=12, local=20))
    assert np.array_equal(found.point, every.point) and found.value == every.value
    assert all(np.array_equal(a, b) for a, b in zip(found.trail.front(), every.trail.front(), strict=True))
    spared = ~np.isfinite(found.trail.time) & (found.trail.cost <= every.trail.cost) & ~found.trail.kept
    assert spared.sum() > 0.1 * spared.size
    times, errors = every.trail.front()
    for time, error in zip(
        every.trail.time[spared & every.trail.kept], every.trail.error[spared & every.trail.kept], strict=True
    ):
        assert ((times <= time) & (errors <= error)).any()
    assert np.array_equal(found.trail.cost[~spared], every.trail.cost[~spared])
    assert (every.trail.cost >= least(task)).all()


def test_two_modes_are_the_scaled_schedule_below_the_switch_and_one_pair_of_gains_beyond():
    schedule = type(
        "S", (), {"knots": np.array([1e-4, 1e-3, 1e-2]), "kp": np.ones(3), "kd": np.ones(3), "reversal": 1e-5}
    )
    two = blended(schedule, np.array([0.25, 0.5, 1e-3, 7.0, 3.0]), "following")
    assert two.kp.tolist() == [0.25, 0.25, 7.0] and two.kd.tolist() == [0.5, 0.5, 3.0]


def test_a_loop_beyond_the_border_of_stability_has_no_sensitivity_however_small_its_peak():
    """A double integrator a sample late under gains far too stiff: |S| is small again, the eigenvalues are not."""
    from workbench.tuning import sampled

    linear = Linear(LOOP, 0.0074, 0.0, np.array([0.0, 95.0]))
    family = pd_family(linear, (428.0, 8.8))
    points = np.array([[428.0, 8.8], [5588.0, 115.0], [1e4, 6.0], [2000.0, 0.5], [50.0, 1.0]])
    seen = family.sensitivity(points)
    unit = np.array([LOOP.sample_time**2, LOOP.sample_time]) / 0.0074
    motion = tuple(np.repeat(m, 5, axis=0) for m in sampled.steps(np.zeros(1), np.zeros(1), linear.clock))
    stable = sampled.spectral_radius(*(points * unit).T, motion, linear.clock) < 1.0
    assert (np.isfinite(seen) == stable).all() and 0 < stable.sum() < 5
    exact, _ = sampled.sensitivity_peak(*(points * unit).T, motion, linear.clock)
    assert exact[1] < 2.0 and seen[stable] == pytest.approx(exact[stable], rel=0.02)


def test_a_cascade_with_too_much_integral_is_seen_to_be_unstable():
    linear = Linear(LOOP, 0.0074, 0.0, np.array([0.0]))
    family = cascade_family(linear, (48.0, 5.0, 100.0), 12.0)
    calm, wild = family.sensitivity(np.array([[48.0, 5.0, 100.0], [48.0, 5.0, 1e5]]))
    assert calm < 2.0 and wild == np.inf


def test_a_schedule_is_judged_at_every_amplitude_and_not_in_gross_sliding_alone():
    a = np.geomspace(1e-5, 1.0, 20)
    linear = Linear(LOOP, 0.0074, 0.0, np.array([0.0]), equivalent(axis()["presliding_hysteresis"], a))
    kp, kd = np.full((2, 20), 400.0), np.full((2, 20), 6.0)
    kp[1, :4] = 4400.0
    soft, stiff = linear.scheduled_peak(a, kp, kd)
    assert soft < 2.0 < stiff


def test_the_front_holds_what_no_other_point_beats_and_no_point_that_breaks_a_limit():
    time, error = np.array([1.0, 2.0, 3.0, 1.5, 0.5]), np.array([5.0, 3.0, 4.0, 5.0, 1.0])
    trail = Trail(time, error, np.array([True, True, True, True, False]), error)
    assert [v.tolist() for v in trail.front()] == [[1.0, 2.0], [5.0, 3.0]]
    assert Trail.joined([trail, trail]).front()[0].tolist() == [1.0, 2.0]


def row(name, time, error):
    return Row(name, 0.0, time, 0.1, 0.0, error, error / 5e-6, 0.2, 1.0, 0.0)


@pytest.mark.parametrize(
    ("time", "error", "words"),
    [
        (0.2, 1e-4, "faster and more accurate"),
        (0.05, 1e-4, "slower but more accurate"),
        (0.1, 1e-6, "as fast but less accurate"),
    ],
)
def test_a_comparison_says_plainly_who_is_beaten_on_what(time, error, words):
    rows = (row("ours", 0.1, 1e-5), row("baseline", time, error))
    assert f"ours is {words}" in verdicts(Comparison(rows, ()), "ours", ["baseline"], "rad").findings[0].sentence


def test_every_controller_meets_the_same_scenarios():
    task = Task(axis(), LOOP, STEP, 0.4, load_inertias=(0.0, 5.3e-4))
    seen = compare(task, {n: lambda lanes: fixed_pd(50.0, 1.0) for n in ("one", "other")})
    a, b = ([vars(r) | {"controller": ""} for r in seen.rows if r.controller == n] for n in ("one", "other"))
    assert a == b and len(a) == 2 and a[1]["bound"] > a[0]["bound"]


def test_a_gain_table_for_a_plant_that_has_changed_since_tuning_is_refused(tmp_path):
    from workbench.exporting import export
    from workbench.schedule import fit_schedule
    from workbench.tuning import TuningGoal, tuned_axis

    plant = axis()
    gains = tuned_axis(plant, np.geomspace(1e-4, 1.0, 20), TuningGoal(drive=3.3, speed=12.57), LOOP).gains
    schedule = fit_schedule(
        gains, per_octave=2, lowest=1e-4, highest=1.0, tolerance=0.2, plant_digest=plant.digest, loop=LOOP
    )
    export(schedule, plant, tmp_path)
    changed = plant.swap(plant["presliding_hysteresis"](h0=0.16))
    with pytest.raises(WorkbenchError, match=r"h0 was 0.15, is 0.16"):
        export(schedule, changed, tmp_path, tuned_lines=plant.digest_lines())
