"""Schedules: their look-up, their shape, how close they are to tuned gains, and what they are worth between knots."""

from dataclasses import replace
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from workbench.control import grid, scheduled_pd
from workbench.control.notched import coefficients, numbers_of
from workbench.description import Equivalent
from workbench.errors import WorkbenchError
from workbench.frequency import Notch
from workbench.schedule import Schedule, between_knots, fewest_knots, fit_schedule, passivity, shape
from workbench.schedule.check import pumping
from workbench.tuning import TuningGoal, tune

LOOP = SimpleNamespace(sample_time=0.25e-3, delay=0.25e-3, velocity_filter=0.25e-3, resolution=4.848e-6)
QUICK = settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)


def presliding(amplitude, h0: float = 0.15, a: float = 636.0) -> Equivalent:
    """Closed form for the virgin curve h0 (1 - exp(-a x))."""
    from scipy.special import ive

    amplitude = np.asarray(amplitude, dtype=float)
    z = a * amplitude / 2.0
    loss = 4.0 * h0 * a / np.pi * np.sqrt(np.pi / (2.0 * z)) * ive(1.5, z)
    return Equivalent(amplitude, 2.0 * h0 * a * ive(1, z) / z, loss)


@pytest.fixture(scope="module")
def tuned():
    return tune(
        presliding(np.geomspace(1e-5, 2.5, 40)), 0.0074, 0.0, TuningGoal(drive=3.3, speed=12.57), LOOP, margins=False
    )


@pytest.fixture(scope="module")
def schedule(tuned):
    return fit_schedule(tuned, loop=LOOP, per_octave=4, highest=0.03, plant_digest="d" * 64)


def plain(amplitude, kp, kd=None, binding=None):
    kp = np.asarray(kp, dtype=float)
    kd = np.sqrt(kp) if kd is None else np.asarray(kd, dtype=float)
    return SimpleNamespace(amplitude=np.asarray(amplitude, dtype=float), kp=kp, kd=kd, binding=binding)


# --- look-up ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("per_octave", [1, 2, 4, 8, 32])
def test_the_leading_bits_name_the_segment_that_a_search_finds(per_octave):
    knots = grid(1e-5, 0.03, per_octave)
    s = Schedule(knots, np.full(knots.size, 2.0), np.ones(knots.size), per_octave)
    rng = np.random.default_rng(3)
    amplitude = np.concatenate(
        [
            10.0 ** rng.uniform(-7, 0, 100_000),
            knots,
            np.nextafter(knots, 0.0),
            np.nextafter(knots, inf),
            [0.0, -0.0, -1.0, 5e-324, 1e300, inf],
        ]
    )
    found = np.clip(np.searchsorted(knots, amplitude, side="right") - 1, 0, knots.size - 1)
    assert (s.segment(amplitude) == found).all()


def test_gains_are_linear_between_knots_and_flat_beyond_them(schedule):
    amplitude = np.concatenate([[0.0, 1e-9, 1.0], np.geomspace(1e-6, 1.0, 5000), schedule.knots])
    kp, kd = schedule.gains(amplitude)
    assert kp == pytest.approx(np.interp(amplitude, schedule.knots, schedule.kp), rel=1e-13)
    assert kd == pytest.approx(np.interp(amplitude, schedule.knots, schedule.kd), rel=1e-13)
    assert schedule.gains(3e-4)[0].shape == () and schedule.gains(np.full((2, 3), 3e-4))[0].shape == (2, 3)


def test_the_look_up_is_that_of_the_simulation_to_the_last_bit(schedule):
    from workbench.control import Table, gains_at

    amplitude = np.geomspace(1e-6, 1.0, 10_000)
    same = gains_at(Table(schedule.knots, {"kp": schedule.kp, "kd": schedule.kd}), amplitude)
    assert all((a == b).all() for a, b in zip(schedule.gains(amplitude), same, strict=True))
    rows = schedule.as_arrays()["rows"]
    i, inside = schedule.segment(amplitude), np.clip(amplitude, schedule.knots[0], schedule.knots[-1])
    assert (rows[i, 0] + rows[i, 1] * inside == schedule.gains(amplitude)[0]).all()


# --- shape -----------------------------------------------------------------------------------------------------------


@QUICK
@given(
    noise=st.lists(st.floats(-0.7, 0.7), min_size=12, max_size=12),
    slope=st.floats(-2.0, 0.5),
    bound=st.tuples(st.floats(-3.0, -0.5), st.floats(-0.3, 1.0)),
    monotone=st.booleans(),
    per_octave=st.sampled_from([1, 2, 4]),
)
def test_whatever_was_tuned_the_shape_is_kept(noise, slope, bound, monotone, per_octave):
    amplitude = np.geomspace(1e-4, 1e-2, 12)
    gains = plain(amplitude, 100.0 * (amplitude / 1e-3) ** slope * np.exp(noise))
    s = fit_schedule(gains, loop=LOOP, per_octave=per_octave, monotone=monotone, slope=bound)
    width = np.diff(np.log(s.knots))
    for values in (s.kp, s.kd):
        steps = np.diff(np.log(values))
        assert (values > 0.0).all()
        assert (steps >= bound[0] * width - 1e-12).all() and (steps <= bound[1] * width + 1e-12).all()
        assert not monotone or (np.diff(values) <= 0.0).all()
    # continuous: at a knot, and one double to either side of it, gains differ by rounding only
    for side in (0.0, inf):
        for here, there in zip(s.gains(s.knots), s.gains(np.nextafter(s.knots, side)), strict=True):
            assert there == pytest.approx(here, rel=1e-12)


def test_the_shape_is_the_one_that_cvxpy_finds_for_the_same_problem_as_it_is_stated():
    import cvxpy as cp

    draw = np.random.default_rng(3)
    m, n = 14, 60
    rows = shape.interpolation(np.geomspace(1.0, 50.0, m), np.geomspace(1.0, 50.0, n))
    target = np.cumsum(draw.standard_normal(n)) / 4.0
    low, high, ceiling = np.full(m - 1, -0.8), np.full(m - 1, 0.05), np.arange(n) % 5 == 0
    x = cp.Variable(m)
    fit = cp.sum_squares(rows @ x - target) / n + shape.CURVATURE * cp.sum_squares(cp.diff(x, k=2))
    limits = [cp.diff(x) >= low, cp.diff(x) <= high, rows[ceiling] @ x <= target[ceiling]]
    cp.Problem(cp.Minimize(fit), limits).solve(solver=cp.CLARABEL, tol_gap_abs=1e-13, tol_gap_rel=1e-13, tol_feas=1e-13)
    for start in (None, np.zeros(m)):
        assert shape.solve(rows, target, low, high, ceiling, start) == pytest.approx(x.value, abs=1e-5)


def test_gains_of_an_allowed_shape_are_fitted_as_they_are():
    amplitude = grid(1e-4, 1e-2, 4)
    gains = plain(amplitude, 3.3 / amplitude)
    s = fit_schedule(gains, loop=LOOP, per_octave=4, lowest=amplitude[0], highest=amplitude[-1])
    assert s.kp * s.knots == pytest.approx(3.3, rel=0.01)
    # chord of 1/A over a step of ratio 5/4 is at most 1.25 % above it; least squares halves that
    assert 0.005 < s.interpolation_error < 0.0125


def test_the_quadratic_program_is_solved_far_below_the_solvers_defaults():
    from scipy.optimize import lsq_linear

    rng = np.random.default_rng(5)
    target = rng.normal(size=30)
    low, high = np.full(29, -0.2), np.full(29, 0.1)
    x = shape.solve(np.eye(30), target, low, high, np.zeros(30, dtype=bool))
    # the same without a quadratic-program solver: steps as variables, bounded least squares
    sums = np.concatenate([np.ones((30, 1)), np.tril(np.ones((30, 30)), -1)[:, :29]], axis=1)
    bends = np.sqrt(30 * shape.CURVATURE) * np.diff(sums, n=2, axis=0)
    other = lsq_linear(
        np.concatenate([sums, bends]),
        np.concatenate([target, np.zeros(28)]),
        bounds=(np.concatenate([[-inf], low]), np.concatenate([[inf], high])),
        tol=1e-14,
        method="bvls",
    )
    assert x == pytest.approx(sums @ other.x, abs=1e-7)
    assert (np.diff(x) >= low - 1e-12).all() and (np.diff(x) <= high + 1e-12).all()


def test_a_schedule_is_the_same_bytes_twice(tuned):
    one, two = (fit_schedule(tuned, loop=LOOP, highest=0.03) for _ in range(2))
    assert one.kp.tobytes() == two.kp.tobytes() and one.kd.tobytes() == two.kd.tobytes()


def test_where_the_sensitivity_stops_gains_the_schedule_does_not_exceed_them(tuned):
    slow = replace_loop(sample_time=1e-3, delay=1e-3, velocity_filter=1e-3)
    gains = tune(
        presliding(np.geomspace(1e-5, 0.05, 24)), 0.0074, 0.0, TuningGoal(drive=3.3, speed=12.57), slow, margins=False
    )
    assert np.diff(gains.kp).max() > 0.0  # here Kp rises with amplitude, as the axis's own spring goes
    s = fit_schedule(gains, loop=slow, highest=0.03)
    stopped = np.array(["sensitivity" in b for b in gains.binding])
    kp, _ = s.gains(gains.amplitude[stopped])
    assert (kp <= gains.kp[stopped] * (1.0 + 1e-4)).all()
    assert not between_knots(s, presliding, 0.0074, slow).findings
    assert [f.kind for f in s.findings] == ["schedule"] and "allow gains that rise" in s.findings[0].remedy
    assert fit_schedule(gains, loop=slow, highest=0.03, monotone=False).interpolation_error < 0.05


def replace_loop(**changes):
    return SimpleNamespace(**(vars(LOOP) | changes))


# --- how close -------------------------------------------------------------------------------------------------------


def test_four_knots_an_octave_hold_the_tuned_gains_to_two_per_cent(tuned, schedule):
    assert schedule.interpolation_error <= 0.02 and not schedule.findings
    inside = (tuned.amplitude >= schedule.knots[0]) & (tuned.amplitude <= 0.03)
    kp, kd = schedule.gains(tuned.amplitude[inside])
    assert np.abs(kp / tuned.kp[inside] - 1.0).max() <= schedule.interpolation_error * (1.0 + 1e-9)
    assert np.abs(kd / tuned.kd[inside] - 1.0).max() <= schedule.interpolation_error * (1.0 + 1e-9)
    assert schedule.reversal == pytest.approx(2.5 * 4.848e-6) and schedule.sample_time == 0.25e-3


def test_too_few_knots_are_a_finding_with_its_numbers(tuned):
    s = fit_schedule(tuned, loop=LOOP, per_octave=1, highest=0.03)
    (finding,) = s.findings
    assert (
        finding.evidence["error"] == s.interpolation_error > 0.02
        and f"{100 * s.interpolation_error:.3g} %" in finding.sentence
    )


def test_the_fewest_knots_meet_the_tolerance_and_one_less_does_not(tuned, schedule):
    few = fewest_knots(tuned, loop=LOOP, highest=0.03, tolerance=0.02)
    assert few.interpolation_error <= 0.02 and few.knots.size < schedule.knots.size / 2
    assert not between_knots(few, presliding, 0.0074, LOOP).findings
    dense = np.geomspace(1e-5, 0.03, 2000)
    wanted = np.exp(np.interp(np.log(dense), np.log(tuned.amplitude), np.log(tuned.kp)))
    assert np.abs(few.gains(dense)[0] / wanted - 1.0).max() <= 0.02 * 1.02
    coarser = fit_schedule(tuned, loop=LOOP, highest=0.03, per_octave=few.per_octave // 2)
    assert coarser.interpolation_error > 0.02


def test_between_knots_the_loop_keeps_its_sensitivity(schedule):
    between = between_knots(schedule, presliding, 0.0074, LOOP, points=16)
    assert not between.findings and between.amplitude.size == 16 * (schedule.knots.size - 1) + 1
    assert 1.9 < between.worst_sensitivity[0] <= 2.0 * 1.005 and between.worst_radius[0] < 1.0


def test_the_notch_of_a_schedule_is_in_its_loop_and_behind_its_law(schedule):
    wide = Notch(260.0, 1.4 * 260.0, 0.6)
    free = replace(schedule, kp=0.0 * schedule.kp + 900.0, kd=0.0 * schedule.kd + 9.0)  # Kp/Kd = 100/s
    bare, behind = (between_knots(replace(free, notch=n), presliding, 0.0074, LOOP) for n in (None, wide))
    assert behind.worst_sensitivity[0] < bare.worst_sensitivity[0] and behind.worst_radius[0] < 1.0
    made = scheduled_pd(replace(schedule, notch=wide, velocity_filter=1e-4))
    assert numbers_of(made) == coefficients(wide, LOOP.sample_time) and made.velocity_filter == 1e-4
    assert numbers_of(scheduled_pd(schedule)) is None and scheduled_pd(schedule).velocity_filter is None


def test_below_its_centre_a_notch_takes_from_the_damping(schedule):
    """Im N (Kp + i w Kd) for w Kd: a notch lags below its centre."""
    held = replace(schedule, rule="frozen")
    bare, behind = (
        passivity(replace(held, notch=n), presliding, 0.0074).damping for n in (None, Notch(260.0, 1.4 * 260.0, 0.6))
    )
    assert (behind < bare).all() and (behind > 0.0).all()
    none = passivity(replace(held, notch=Notch(260.0, 1.4 * 260.0, 1.0)), presliding, 0.0074).damping
    assert none == pytest.approx(bare, rel=1e-12)


def test_gains_too_large_between_knots_are_found(schedule):
    loud = replace(schedule, kp=schedule.kp * 1.2, kd=schedule.kd * 1.2)
    (finding,) = between_knots(loud, presliding, 0.0074, LOOP).findings
    assert finding.kind == "sensitivity exceeded" and finding.evidence["peak"] > 2.1
    wild = replace(schedule, kp=schedule.kp * 4.0, kd=schedule.kd * 4.0)
    assert "unstable" in {f.kind for f in between_knots(wild, presliding, 0.0074, LOOP).findings}


# --- passivity -------------------------------------------------------------------------------------------------------


def test_pumping_is_the_integral_over_a_half_cycle(schedule):
    from scipy.integrate import quad

    for a in (3e-5, 1e-3, 2.2e-2):
        crossings = np.arccos(np.clip(1.0 - 2.0 * schedule.knots[schedule.knots < a] / a, -1.0, 1.0))
        ends = np.concatenate([[0.0], crossings, [np.pi]])

        def term(f, a=a):
            return float(schedule.gains(a * (1.0 - np.cos(f)) / 2.0)[0]) * np.cos(f) * np.sin(f)

        whole = sum(quad(term, *pair)[0] for pair in zip(ends[:-1], ends[1:], strict=True))
        assert pumping(schedule, np.array([a]))[0] == pytest.approx(2.0 / np.pi * whole, rel=1e-7, abs=1e-6)


def test_frozen_gains_feed_nothing_in_and_steep_moving_ones_are_not_passive(schedule):
    assert passivity(schedule, presliding, 0.0074).pumping.max() == 0.0
    moving = passivity(replace(schedule, rule="following"), presliding, 0.0074)
    assert moving.findings[0].kind == "passive" and 0.1 < (moving.pumping / moving.damping).max() < 0.6
    weak = replace(schedule, rule="following", kd=schedule.kd * 0.1)
    (finding,) = passivity(weak, presliding, 0.0074).findings
    assert finding.kind == "not passive" and finding.evidence["pumping"] > finding.evidence["damping"]


# --- what is said ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("gains", "options", "sentence"),
    [
        (plain([1e-3, 1e-4], [1.0, 1.0]), {}, "amplitudes must increase: number 2, 0.0001"),
        (plain([1e-4, 1e-3], [1.0, -1.0], [1.0, 1.0]), {}, "kp at amplitude 0.001 is -1"),
        (plain([1e-4, 1e-3], [1.0, 0.0], [1.0, 1.0]), {}, "positive gains at two or more amplitudes"),
        (plain([1e-4, 1e-3], [2.0, 1.0]), {"per_octave": 3}, "a power of two"),
        (plain([1e-4, 1e-3], [2.0, 1.0]), {"highest": 1.0}, "within the amplitudes of the gains, 0.0001 to 0.001"),
        (plain([1e-4, 1e-3], [2.0, 1.0]), {"slope": (0.5, 1.0)}, "the lower must be negative"),
        (plain([1e-4, 1e-3], [2.0, 1.0]), {"tolerance": 0.0}, "tolerance of the schedule is 0"),
        (plain([1e-4, 1e-3], [2.0, 1.0]), {"rule": "folowing"}, "did you mean 'following'"),
    ],
)
def test_what_makes_no_schedule_is_refused_with_what_is_wrong(gains, options, sentence):
    with pytest.raises(WorkbenchError, match=sentence):
        fit_schedule(gains, loop=LOOP, **options)


def test_knots_off_their_grid_and_amplitudes_that_are_no_number_are_refused(schedule):
    with pytest.raises(WorkbenchError, match="must lie at"):
        replace(schedule, knots=schedule.knots * 1.01)
    with pytest.raises(WorkbenchError, match=r"do not lie at 2\^e \(1 \+ j/8\)"):
        replace(schedule, per_octave=8)
    with pytest.raises(WorkbenchError, match="not a number"):
        schedule.gains(np.nan)
    with pytest.raises(ValueError, match="read-only"):
        schedule.kp[0] = 1.0


def test_a_shape_that_no_knots_can_give_is_said(tuned):
    with pytest.raises(WorkbenchError, match="does not allow them"):
        fewest_knots(tuned, loop=LOOP, highest=0.03, tolerance=0.02, slope=(-0.3, 0.0))


def test_a_fitted_schedule_is_exported_as_it_is(tuned, tmp_path):
    from workbench.schedule.tables import tables

    few = fewest_knots(tuned, loop=LOOP, highest=0.03)
    held = tables(few.per_octave, few.knots, few.kp, few.kd)
    assert held.count == few.knots.size and held.rows["knots"] == pytest.approx(few.knots, abs=0.0)
