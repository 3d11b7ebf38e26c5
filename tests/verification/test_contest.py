"""A contest of controllers: linearisations of two masses, standings, verdicts, reproduction, and what is exported."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from workbench.control import FeedForward, fixed_pd, grid
from workbench.definition import find
from workbench.design.families.family import Blend, cascade_family, pd_family, scheduled_family, soft_gains
from workbench.design.families.linear import Linear, TwoMasses
from workbench.design.families.shaped import shaped
from workbench.design.optimise import Budget, first_members
from workbench.errors import WorkbenchError
from workbench.exporting.feed_forward import export_feed_forward
from workbench.plant import ONE_MASS, TWO_MASS, Limits, Plant
from workbench.report.contest import asked_table
from workbench.report.reproduction import Printed, counted, reproduction_table
from workbench.simulation import Loop
from workbench.task.bound import time_optimal
from workbench.task.task import Task, Weights, cost
from workbench.verification.contest import Contest, Result, contest
from workbench.verification.controllers import feed_forward_of
from workbench.verification.margin import Asked, against_margin
from workbench.verification.wording import verdict

LOOP = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, 4.848e-6)
SMALL = Budget(population=3, generations=2, local=4)
LIMITS = Limits(3.3, 12.57)
STEP = 2.513


def rigid() -> Plant:
    return Plant(
        ONE_MASS, (find("inertia")(inertia=0.0074), find("presliding_hysteresis")(h0=0.15, x0=1 / 636)), limits=LIMITS
    )


def parted() -> Plant:
    effects = (
        find("inertia")(inertia=0.0064, at="motor"),
        find("inertia")(inertia=0.001, at="load"),
        find("linear_stiffness")(stiffness=440.0),
        find("presliding_hysteresis")(h0=0.1, x0=1 / 636, at="motor"),
        find("presliding_hysteresis")(h0=0.05, x0=1 / 636, at="load"),
    )
    return Plant(TWO_MASS, effects, limits=LIMITS)


def masses(stiffness: float, *, motor_speed=True, motor_position=False) -> TwoMasses:
    return TwoMasses(LOOP, 0.0064, np.array([0.001]), np.array([stiffness]), 0.02, motor_position, motor_speed)


def test_two_masses_on_a_very_stiff_joint_have_the_sensitivity_of_one():
    one = Linear(LOOP, 0.0074, 0.0, np.array([0.0]))
    points = np.array([[400.0, 8.0], [1500.0, 6.0], [100.0, 1.0]])
    expected = pd_family(one, (400.0, 8.0)).sensitivity(points)
    for motor_speed in (True, False):
        joined = pd_family(masses(1e8, motor_speed=motor_speed), (400.0, 8.0), motor_speed=motor_speed)
        assert joined.sensitivity(points) == pytest.approx(expected, rel=0.02)


def test_two_masses_in_the_sampled_loop_are_those_of_python_control():
    import control

    m, j, k, c = 0.0064, 0.001, 440.0, 0.02
    a = [[0, 1, 0, 0], [-k / m, -c / m, k / m, c / m], [0, 0, 0, 1], [k / j, c / j, -k / j, -c / j]]
    plant = control.c2d(
        control.ss(a, [[0], [1 / m], [0], [0]], [[1, 0, 0, 0], [0, 0, 1, 0]], 0), LOOP.sample_time, "zoh"
    )
    two = masses(k)
    found = control.frequency_response(plant, two.theta / LOOP.sample_time)
    late = np.exp(-1j * two.theta)
    for mine, theirs in zip(two.responses, np.squeeze(found.complex), strict=True):
        np.testing.assert_allclose(mine[0], theirs * late, rtol=1e-6)


def test_speed_from_the_motor_keeps_a_margin_that_speed_from_beyond_the_joint_does_not():
    point = np.array([[250.0, 4.0]])
    motor = pd_family(masses(440.0), (250.0, 4.0), motor_speed=True).sensitivity(point)[0]
    load = pd_family(masses(440.0, motor_speed=False), (250.0, 4.0)).sensitivity(point)[0]
    assert motor < 2.0 and load == np.inf


def test_the_bound_of_two_masses_is_that_of_the_rigid_axis():
    assert time_optimal(parted(), STEP) == pytest.approx(time_optimal(rigid(), STEP), rel=1e-3)


def standing(name, time, error, costs=(1.0, 3.0, 2.0)) -> Result:
    values = {f"{n}{w}": np.array(v) for n, v in (("time", time), ("error", error)) for w in ("", "_loaded", "_grid")}
    return Result(name, values, (1, 2, 3), None)


def test_a_verdict_says_who_is_beaten_on_what_nominally_and_over_the_grid():
    ours = standing("ours", [0.2, 0.24, 0.22], [1e-5, 3e-5, 2e-5])
    other = standing("other", [0.25] * 3, [1e-6] * 3)
    held = Contest(None, {"ours": ours, "other": other}, 0.2, 0.2)
    said = verdict(held, "ours", "other", "rad").sentence
    assert said.count("faster but less accurate") == 2 and "220.0 ms against 250.0 ms" in said
    assert ours.span("time") == (0.2, 0.24) and held.over_bound("ours") == pytest.approx(1.1)


def test_a_contest_tunes_without_load_and_judges_with_it_and_over_the_grid():
    task = Task(rigid(), LOOP, STEP, 0.4, (0.0, 5.3e-4), (0.5, 1.5), (1.0,), 0.0, 1, Weights())
    linear = Linear(LOOP, 0.0074, 0.0, np.array([0.0]))
    found = contest(
        task, [cascade_family(linear, (45.0, 2.0, 20.0), 12.0)], {"stated": lambda lanes: fixed_pd(60.0, 1.3)},
        tuning_time=0.3, seeds=(1, 2, 3), budget=SMALL,
    )  # fmt: skip
    tuned = found["PI cascade"]
    assert tuned.values["time"].shape == (3,) and found["stated"].values["time"].shape == (1,)
    assert found.bound < found.bound_loaded
    order = np.argsort(tuned.values["cost"])
    assert tuned.tuned.median is tuned.tuned.runs[order[1]]
    assert tuned.median("error_grid") >= tuned.median("error_spread")


def test_the_searchs_own_run_stands_for_the_tasks_own_limit_on_the_sensitivity():
    task = Task(rigid(), LOOP, STEP, 0.3, (0.0, 5.3e-4), (0.5, 1.5), (1.0,), 0.0, 1, Weights())
    family = pd_family(Linear(LOOP, 0.0074, 0.0, np.array([0.0])), (400.0, 5.0))
    found = contest(task, [family], tuning_time=0.3, seeds=(4, 5), budget=SMALL)
    again = against_margin(task, (2.0, 3.0), lambda _: {"fixed PD": family}, tuning_time=0.3, seed=5, budget=SMALL)
    known = against_margin(
        task, (2.0, 3.0), lambda _: {"fixed PD": family}, tuning_time=0.3, seed=5, budget=SMALL, found=found
    )
    assert found["fixed PD"].of_seed(6) is None
    for figure, values in again.values["fixed PD"].items():
        assert (values == known.values["fixed PD"][figure]).all()


def test_a_figure_that_the_margin_forbids_is_said_with_the_margin_at_which_it_is_had():
    limits = np.array([1.6, 2.0, 3.0])
    row = Asked("error", "the error", 2e-4, 3e-4, np.array([5e-4, 3e-4, 1e-4]), "rad", "reason")
    never = replace(row, asked=1e-5)
    assert row.had_at(limits) == 3.0 and never.had_at(limits) is None
    shown = asked_table((row, never), limits, 2.0)
    assert shown.columns[2] == "had with Ms ≤ 2"
    assert [r[3] for r in shown.rows] == ["at Ms = 3", "at none: 100\u00a0µrad at Ms = 3"]


def test_a_reproduction_can_fail():
    met = Printed("a", 2.0, 2.02, 0.02)
    told = Printed("b", 2.0, 3.0, reason="half of it is friction", within=1.6)
    worse = replace(told, what="c", obtained=3.4)
    fitted = Printed("b, fitted", 2.0, 2.8, factor=1.5, kind="fit", of="b")
    derived = Printed("b over a", 1.0, 5.0, kind="derived")
    assert met.met and not told.met and told.explained and not worse.explained and not derived.explained
    assert fitted.met and not replace(fitted, obtained=1.3).met and Printed("e", 2.0, -1.0, factor=1.5).ratio == np.inf
    given = Printed("d", 0.5, 0.5, kind="input")
    every = [met, told, worse, fitted, derived, given]
    assert counted(every) == {
        "reproduction_rows": 3.0, "reproduction_met": 2.0, "reproduction_fitted": 1.0, "reproduction_unexplained": 2.0
    }  # fmt: skip
    said = [getattr(r[-1], "text", r[-1]) for r in reproduction_table(every, "caption").rows]
    assert said == [
        "within 2.0\u00a0%", "missed: half of it is friction", "missed, and more than a factor of 1.6 off",
        "fitted, within a factor of 1.5", "missed", "put in as printed",
    ]  # fmt: skip


def test_feed_forward_is_the_models_mass_and_friction_and_is_exported_as_it_is(tmp_path):
    plant = rigid() + find("viscous_friction")(viscous=0.01)
    known = feed_forward_of(plant, 4.848e-6)
    assert known.mass == 0.0074
    np.testing.assert_allclose(known.friction, 0.15 + 0.01 * known.speeds, rtol=1e-3)
    paths = export_feed_forward(known, plant, tmp_path)
    assert [p.name for p in paths] == ["feed_forward.h", "feed_forward.json"]
    held = json.loads(paths[1].read_text())
    assert held["friction"] == known.friction.tolist() and held["plant"]["digest"] == plant.digest
    header = paths[0].read_text()
    assert f"#define WB_FEED_FORWARD_COUNT {known.speeds.size}" in header and plant.digest in header
    with pytest.raises(WorkbenchError, match="too large for float32"):
        export_feed_forward(FeedForward(1e40, known.speeds, known.friction), plant, tmp_path / "other")
    assert not (tmp_path / "other").exists()
    assert SimpleNamespace(**held).format == "servo-workbench feed-forward"


def test_a_record_that_a_study_makes_says_so():
    from workbench.simulation.recorded import record_of

    t = 1e-3 * np.arange(100)
    made = [
        record_of(
            "slow", "identification", rigid(), t, {"torque": np.sin(t), "position": s * t}, {"position": 1e-6}, "a ramp"
        )
        for s in (1.0, 1.0, 2.0)
    ]
    assert "simulated" in made[0].motion and made[0].source.reader == "simulated by this study"
    assert made[0].source.sha256 == made[1].source.sha256 != made[2].source.sha256
    assert made[0].units == {"torque": "N*m", "position": "rad"} and not made[0].locked


def test_a_filter_of_its_own_gives_a_cascade_beyond_the_joint_a_margin_that_the_loops_filter_does_not():
    on_load = masses(440.0, motor_speed=False)
    family = shaped(lambda j: cascade_family(j, (50.0, 5.0, 25.0), 12.0), on_load, 2e-3)
    quick, slow = family.sensitivity(np.array([[50.0, 1.0, 19.0, 2.5e-4], [50.0, 1.0, 19.0, 4e-3]]))
    plain = cascade_family(on_load, (50.0, 5.0, 25.0), 12.0).sensitivity(np.array([[50.0, 1.0, 19.0]]))[0]
    assert quick == pytest.approx(plain, rel=1e-9) and slow < 0.5 * quick
    assert family.numbers[-1] == "velocity_filter" and family.controller(
        family.start[None, :], 2
    ).velocity_filter.shape == (2,)


def test_where_the_nominal_axis_counts_a_search_begins_softly_too_and_time_and_error_of_others_are_free():
    judge = masses(440.0)
    knots = grid(1e-5, 2.0, 2)
    tuned = Blend(knots, np.full(knots.size, 400.0), np.full(knots.size, 4.0), "following", 1e-5)
    soft = soft_gains(0.0074, 3.3, 12.57)
    assert soft[0] == pytest.approx(37.3, rel=0.01) and soft[1] ** 2 == pytest.approx(4 * 0.0074 * soft[0])
    family = scheduled_family(judge, tuned, "following", (250.0, 5.0), motor_speed=True, soft=soft)
    bounds = np.log([family.lower, family.upper])
    task = Task(rigid(), Loop(2.5e-4), STEP, 0.2, frictions=(0.5, 1.0), phases=1)
    plain = first_members(task, family, 1, bounds)["init"]
    assert (np.abs(plain - np.log(family.start)).max(axis=1) < 0.5).sum() >= 10 and not (
        plain == np.log(family.soft)
    ).all(axis=1).any()
    made = first_members(replace(task, nominal=True), family, 1, bounds)["init"]
    near = np.abs(made - np.log(family.soft)).max(axis=1) < 0.5
    assert near.sum() >= 10 and (made >= bounds[0]).all() and (made <= bounds[1]).all()
    figures = {n: np.zeros(2) for n in ("overshoot", "ripple")}
    metrics = SimpleNamespace(time_1pct=np.array([0.9, 0.2]), final_error=np.full(2, 1e-5), **figures)
    assert cost(task, metrics, 0.2, 2)[0] == pytest.approx(4.5)
    assert cost(replace(task, nominal=True), metrics, 0.2, 2)[0] == pytest.approx(1.0)
