"""Limit cycles: describing functions against closed forms, balance against published relay loops, and the region of gains."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from workbench.control import fixed_pd, grid, pi_cascade, profile_pi, scheduled_pd
from workbench.control.notched import notched, response
from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.limit_cycle import axis_of, balance, command, dials, region, turned
from workbench.limit_cycle.describing import comes_back
from workbench.limit_cycle.further import ORDERS
from workbench.limit_cycle.simulation import LONGER, Motion, harmonics, simulated
from workbench.limit_cycle.waves import clipped, found_after, harmonics_of, turning
from workbench.plant import ONE_MASS, TWO_MASS, Limits, Plant
from workbench.report.contents import Figure
from workbench.simulation import Loop
from workbench.task.task import Task

FAST, SLOW = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, 4.848e-6), Loop(1e-3, 4, 1e-3, 1e-3, 4.848e-6)
J = 0.0074
PHASES = 64
WIDTH = 2 * np.pi / PHASES
PHASE = WIDTH * np.arange(PHASES + 1)
ONE = np.ones(1)


def axis(*more, speed=12.57) -> Plant:
    effects = (find("inertia")(inertia=J), find("presliding_hysteresis")(h0=0.15, x0=1 / 636), *more)
    return Plant(ONE_MASS, effects, limits=Limits(3.3, speed))


def gains(loop: Loop, count: int = 10):
    """kp and kd from far below to beyond what the sampled double integrator bears."""
    kp, kd = J / loop.sample_time**2, J / loop.sample_time
    return np.geomspace(1e-3, 0.12, count) * kp, np.geomspace(0.01, 1.3, count) * kd


def schedule():
    knots = grid(1e-5, 2.6, 2)
    kp = np.where(knots < 3e-3, np.minimum(3.3 / knots, 2500.0), 60.0)
    return SimpleNamespace(knots=knots, kp=kp, kd=np.where(knots < 3e-3, 1.6 * np.sqrt(J * kp), 1.3))


def first(u: np.ndarray, limit: float) -> complex:
    """The first harmonic of a waveform over PHASE within a limit."""
    return complex(harmonics_of(clipped(u, limit), np.array(WIDTH / 2), ONE, WIDTH)[0])


def gain(law, loop: Loop, amplitude: float, theta: float, rate: complex = 0.0, limit: float = 1e9) -> complex:
    """C of a law for y = A cos f: minus the command's first harmonic over A. rate: vh over y."""
    q = np.array([amplitude + 0j])
    return -complex(command(law, limit, loop)(q, q * rate, ONE, np.array(theta), 256)[0]) / amplitude


# --- waveforms -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("over", [0.5, 1.2, 3.0, 100.0])
def test_the_limited_sine_has_the_describing_function_of_a_saturation(over):
    m = min(1.0 / over, 1.0)
    expected = 2 / np.pi * (np.arcsin(m) + m * np.sqrt(1 - m * m)) * over
    assert abs(first(over * np.cos(PHASE), 1.0)) == pytest.approx(expected, rel=2e-3)


def test_a_square_wave_moves_its_phase_smoothly_between_phases():
    """A tenth of a phase later is a tenth of a phase later in the first harmonic too, however steep the sine."""
    later = 0.1 * 2 * np.pi / PHASES
    turned_by = np.angle(first(1e4 * np.cos(PHASE - later), 1.0) / first(1e4 * np.cos(PHASE), 1.0))
    assert turned_by == pytest.approx(-later, rel=0.05)


def test_moving_gains_have_the_quadrature_that_the_passivity_check_states():
    """Gains that fall along the stroke feed in kq = (2/pi) Int Kp cos sin: another derivation, in workbench.schedule."""
    from workbench.schedule.check import pumping
    from workbench.schedule.table import Schedule

    s = schedule()
    made = Schedule(s.knots, s.kp, s.kd, 2, "following")
    a = np.array([1e-3, 1e-2])
    for amplitude, kq in zip(a, pumping(made, a), strict=True):
        exact = replace(FAST, resolution=0.0)  # reversals are found at once
        assert -gain(scheduled_pd(s, "following"), exact, amplitude, 1e-6).imag == pytest.approx(kq, rel=0.02)


def test_a_reversal_is_found_where_the_sampled_and_quantised_reading_finds_it():
    """Of a sine, over how encoder counts and samples lie: the mean phase from which on its reversal is known."""
    amplitude, theta, count = 2e-3, 0.04, FAST.resolution
    q = np.array([amplitude + 0j])
    turn, _ = turning(q, ONE)
    back = comes_back(scheduled_pd(schedule(), "following"), FAST)
    late = []
    for phase in np.linspace(0.0, 1.0, 40, endpoint=False):
        for start in np.linspace(0.0, 1.0, 11, endpoint=False):
            f = theta * (np.arange(-40, 41) + start)
            y = count * np.floor(amplitude * np.cos(f) / count + phase)
            known = np.maximum.accumulate(y) - y > 2.5 * count
            late.append(f[np.argmax(known)] - theta / 2)  # the first sample beyond it is half a sample late
    assert found_after(q, ONE, turn, back, np.array(theta)) == pytest.approx(np.mean(late), rel=0.03)


def test_a_frozen_schedule_holds_the_gain_of_half_the_error_at_its_reversal():
    """y = A cos: the error at a reversal is A, so the gain is that of A/2 all along."""
    s, amplitude = schedule(), 4e-3
    exact = replace(FAST, resolution=0.0)
    assert gain(scheduled_pd(s, "frozen"), exact, amplitude, 1e-3) == pytest.approx(
        np.interp(amplitude / 2, s.knots, s.kp), rel=1e-3
    )


def test_the_integral_of_a_cascade_is_that_of_its_pulse_transfer_function():
    """Without a limit met: C = (kvp + ki Ts/(z - 1)) (kv + rate)."""
    from workbench.tuning import sampled
    from workbench.tuning.sampled import Clock

    theta = 0.2
    rate = complex(sampled.difference(np.array([theta]), Clock.of(FAST))[0]) / FAST.sample_time
    found = gain(pi_cascade(50.0, 1.3, 400.0, 12.0), FAST, 1e-6, theta, rate, limit=3.3)
    expected = (1.3 + 400.0 * FAST.sample_time / (np.exp(1j * theta) - 1)) * (50.0 + rate)
    assert found == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("law", [fixed_pd(300.0, 3.0), scheduled_pd(schedule(), "following")])
def test_a_notch_multiplies_the_first_harmonic_by_its_response_where_the_drive_is_not_at_its_limit(law):
    notch, theta = SimpleNamespace(centre=260.0, damping=0.7, depth=0.6), 0.3
    rate = 1j * theta / FAST.sample_time
    plain, behind = (gain(one, FAST, 1e-3, theta, rate) for one in (law, notched(law, notch, FAST.sample_time)))
    assert behind == pytest.approx(plain * response([notch], np.array([theta]), FAST.sample_time)[0], rel=1e-3)


def test_a_law_that_is_not_known_and_two_masses_are_refused():
    with pytest.raises(WorkbenchError, match="speed of the motor"):
        dials(pi_cascade(50.0, 1.0, 1.0, 12.0, motor_speed=True))
    two = Plant(TWO_MASS, (find("inertia")(at="motor", inertia=1.0), find("inertia")(at="load", inertia=1.0)))
    with pytest.raises(WorkbenchError, match="two"):
        axis_of(two, FAST, 1.0)
    with pytest.raises(WorkbenchError, match="limit"):
        axis_of(Plant(ONE_MASS, axis().effects), FAST, 1.0)


# --- balance ---------------------------------------------------------------------------------------------------------


def test_on_the_edge_of_linear_stability_the_loop_hunts_with_the_frequency_of_its_eigenvalue():
    """Bare mass, gains 2 % beyond the edge, so that the limit is hardly met: the eigenvalue on the unit circle says w."""
    from workbench.tuning import sampled

    bare = Plant(ONE_MASS, (find("inertia")(inertia=J),), limits=Limits(3.3))
    there = axis_of(bare, FAST, 1.0)
    unit = J / FAST.sample_time
    motion = sampled.steps(np.zeros(1), np.zeros(1), there.clock)
    kds = np.linspace(0.2, 1.0, 401)
    edge = next(
        k for k in kds if sampled.spectral_radius(np.array([0.02]), np.array([k]), motion, there.clock)[0] > 1.0
    )
    matrix = sampled.closed(np.array([0.02]), np.array([edge]), motion, there.clock)[0]
    values = np.linalg.eigvals(matrix)
    omega = abs(np.angle(values[np.abs(values).argmax()])) / FAST.sample_time
    c = fixed_pd(0.02 * J / FAST.sample_time**2, 1.02 * edge * unit)
    (cycle,) = [x for x in balance(there, 1.0).cycles(command(c, 3.3, FAST)) if x.stable]
    assert cycle.omega == pytest.approx(omega, rel=0.02)


def test_a_saturated_loop_has_the_power_balance_of_a_triangular_velocity():
    """In the limit of a square-wave torque the power that a net delay T feeds in is closed: u (8 A/t_p) T a zero crossing.

    With friction at its Coulomb height, 4 h0 A = 4 u (8 A f) T, so f = h0/(8 u T): no amplitude in it. The slope of a triangle
    is pi^2/8 = sum 1/k^2 over odd k times that of its first harmonic; ten harmonics have 0.980 of it.
    """
    h0, limit, lag, dt = 0.15, 3.3, 1.5, 1e-5  # samples: one of computation, half of the hold
    loop = Loop(dt, 1, dt, 0.0, 0.0)
    there = axis_of(Plant(ONE_MASS, (find("inertia")(inertia=J), find("presliding_hysteresis")(h0=h0, x0=1e-7)),
                          limits=Limits(limit)), loop, 10.0)  # fmt: skip
    kp = 1.0e6
    cycles = [c for c in balance(there, 1.0).cycles(command(fixed_pd(kp, 1e-9), limit, loop)) if c.stable]
    closed = h0 / (8 * limit * lag * dt) * 2 * np.pi
    assert cycles[-1].omega == pytest.approx(closed / (8 / np.pi**2 * np.sum(ORDERS**-2.0)), rel=0.01)


def test_two_roots_in_one_cell_are_looked_for_beside_the_point_that_is_nearest():
    """D = (x - 0.05)(x - 0.15) + i y on whole numbers: no part of it changes its sign between corners of a cell."""
    from workbench.limit_cycle.harmonic_balance import _candidates, _hollows

    x, y = np.arange(-3.0, 4.0)[:, None], np.arange(-3.0, 4.0)[None, :] + 1e-6
    d = (x - 0.05) * (x - 0.15) + 1j * y
    assert np.array_equal(np.argwhere(np.stack(_hollows(d), axis=-1) == 3)[:, 0], [0, 0])
    assert not len(_candidates(d)[0])
    assert not len(_hollows((x + 0.5) * (x + 0.7) + 2.0 + 1j * y)[0])


def test_harmonics_of_a_made_up_oscillation_are_found():
    t = 2.5e-4 * np.arange(4000)
    amplitude, omega, third = harmonics(0.3 + 2e-3 * np.cos(317.0 * t) + 6e-5 * np.cos(951.0 * t + 0.4), 2.5e-4)
    assert (amplitude, omega) == pytest.approx((2e-3, 317.0), rel=0.01) and third == pytest.approx(0.03, rel=0.1)
    assert harmonics(np.full(100, 0.2), 2.5e-4) == (0.0, 0.0, 0.0)


# --- regions ---------------------------------------------------------------------------------------------------------


def agreed(r) -> None:
    """Existence right in every case with a third harmonic of at most 5 %, frequency within 10 %; and both kinds are there."""
    assert (r.right | ~r.judged).all(), np.argwhere(~r.right & r.judged)
    assert np.nanmax(np.abs(r.frequency_error)) < 0.1
    assert 3 <= (r.exists & r.judged).sum() and 20 <= (~r.exists).sum()


@pytest.mark.parametrize("loop", [FAST, SLOW], ids=["4 kHz", "1 kHz"])
def test_of_ten_by_ten_pd_gains_existence_is_right_and_frequency_within_ten_percent(loop):
    kp, kd = gains(loop)
    r = region(axis(), loop, fixed_pd(1.0, 1.0), kp, kd, 1.0, 2.0 if loop is FAST else 4.0)
    assert r.judged.sum() == 100
    agreed(r)


def test_friction_with_memory_moves_the_edge_of_what_hunts():
    """At 1 kHz the presliding spring and loss are of the size of the gains: without friction more gains hunt."""
    kp, kd = gains(SLOW, 6)
    bare = Plant(ONE_MASS, (find("inertia")(inertia=J),), limits=Limits(3.3, 12.57))
    with_friction, without = (
        np.array(
            [[bool([c for c in b.cycles(command(fixed_pd(p, d), 3.3, SLOW)) if c.stable]) for d in kd] for p in kp]
        )
        for b in (balance(axis_of(plant, SLOW, 1.0), 1.0) for plant in (axis(), bare))
    )
    assert (with_friction != without).any()


def test_an_integrating_cascade_hunts_where_it_is_predicted_to():
    r = region(
        axis(), FAST, pi_cascade(1.0, 1.3, 1.0, 12.0), np.geomspace(5, 600, 6), np.geomspace(0.5, 500, 6), 1.0, 2.0
    )
    assert (r.right | ~r.judged).all() and 1 <= r.exists.sum() <= 6
    assert np.nanmax(np.abs(r.frequency_error)) < 0.1


def test_a_profile_with_pi_hunts_where_it_is_predicted_to():
    c = profile_pi(60.0, 1.3, 20.0, 300.0, 0.02, 12.0)
    r = region(axis(), FAST, c, np.geomspace(0.5, 20, 3), np.geomspace(0.3, 40, 3), 0.5, 1.0)
    assert (r.judged & ~r.right).sum() == 0 and 1 <= r.exists.sum() <= 6


@pytest.mark.parametrize("rule", ["following", "error", "frozen", "closing"])
def test_a_schedule_hunts_where_it_is_predicted_to(rule):
    factors = np.geomspace(0.2, 8.0, 5)
    r = region(axis(), FAST, scheduled_pd(schedule(), rule), factors, factors, 1.0, 2.0)
    assert (r.right | ~r.judged).all(), np.argwhere(~r.right & r.judged)
    assert np.nanmax(np.abs(r.frequency_error)) < 0.1
    assert 3 <= (r.exists & r.judged).sum() <= 20


def test_a_cycle_ends_at_the_gain_at_which_it_is_predicted_to():
    """Gains in steps of one percent across the border where a stable and an unstable cycle meet."""
    factors = np.linspace(0.8, 0.96, 17)
    r = region(axis(), FAST, scheduled_pd(schedule(), "following"), 4.0 * ONE, factors, 0.1, 1.5)
    assert 2 <= r.exists.sum() <= 15 and (r.exists != r.predicted).sum() <= 1


def test_between_two_modes_of_a_schedule_there_may_be_gains_that_do_not_hunt():
    """A schedule with a step between its modes: of damping that rises in steps of 2 % two do not hunt, in between."""
    knots = grid(1e-5, 2.6, 2)
    kp = np.where(knots < 0.06, np.minimum(1.3 / knots, 1300.0), 575.0)
    kd = np.where(knots < 0.06, 0.6 * np.sqrt(J * kp), 8.9)
    law = scheduled_pd(SimpleNamespace(knots=knots, kp=kp, kd=kd), "following")
    r = region(axis(), FAST, law, ONE, np.linspace(0.45, 0.6, 16), 0.1, 1.5)
    assert (~r.exists).sum() == 2 and r.exists[0, 0] and r.exists[0, -1]
    assert (r.exists == r.predicted).all()


def test_turning_the_dials_multiplies_what_a_controller_has():
    c = turned(scheduled_pd(schedule(), "error"), 2.0, 3.0)
    assert (c.tables[0].columns["kp"] == 2 * schedule().kp).all() and (
        c.tables[0].columns["kd"] == 3 * schedule().kd
    ).all()
    assert turned(pi_cascade(10.0, 1.0, 5.0, 12.0), 2.0, 3.0).parameters["ki"] == 15.0


def test_a_release_without_gains_that_hunt_dies_out():
    m = simulated(axis(), FAST, [fixed_pd(200.0, 2.0)] * 2, np.array([1e-3, 1e-2]), 1.0)
    assert not m.lasts.any()


# --- a study ---------------------------------------------------------------------------------------------------------

TOML = """
title = "t"
[limit_cycle]
controllers = ["fixed PD"]
first = [1.0, 40.0]
second = [0.3, 20.0]
count = 4
duration = { value = 1.0, unit = "s" }
largest = { value = 0.5, unit = "rad" }
"""


def study(tmp_path, text=TOML):
    from workbench.study import configuration

    (tmp_path / "study.toml").write_text(text)
    return configuration.load(tmp_path)


def run(tmp_path, text=TOML):
    from workbench.study.limit_cycle import limit_cycles

    task = Task(axis(), FAST, 0.5, 0.1)
    return limit_cycles(study(tmp_path, text), task, {"fixed PD": lambda n: fixed_pd(400.0, 1.5)}, lambda _: None)


def test_a_study_gets_a_region_with_figures_by_which_it_may_be_judged(tmp_path):
    part = run(tmp_path)
    assert (
        part.figures["limit_cycle_wrong_fixed_pd"] == 0.0 and 12.0 <= part.figures["limit_cycle_cases_fixed_pd"] <= 16.0
    )
    drawn = [b for b in part.chapters[0].blocks if isinstance(b, Figure)]
    assert len(drawn) == 1 and b"factor on kp" in drawn[0].svg()
    assert "does not hunt" in part.findings[0].sentence


@pytest.mark.parametrize(
    ("was", "becomes", "words"),
    [
        ("[1.0, 40.0]", "[40.0, 1.0]", ("first", "two factors")),
        ('"fixed PD"', '"fixed P"', ("fixed P", "'fixed PD'")),
        ("count", "cuont", ("cuont", "count")),
        ('["fixed PD"]', '"fixed PD"', ("controllers", "list")),
    ],
)
def test_a_faulty_declaration_is_answered_with_file_and_key(was, becomes, words, tmp_path):
    with pytest.raises(WorkbenchError) as caught:
        run(tmp_path, TOML.replace(was, becomes))
    assert all(w in str(caught.value) for w in ("study.toml", *words))


def test_a_motion_of_which_too_few_periods_were_seen_is_looked_at_for_longer(monkeypatch):
    """At 37 rad/s three periods pass in the last quarter of two seconds; whether they go on is seen in eight."""
    asked = []

    def released(plant, loop, controllers, starts, duration, inertia, friction):
        asked.append((len(controllers), duration))
        lasts = np.array([duration > 2.0, False])[: len(controllers)]  # the second lane has come to rest
        amplitude = np.array([0.28, 0.0])[: len(controllers)]
        return Motion(lasts, np.zeros(lasts.size), amplitude, np.full(lasts.size, 37.0), np.zeros(lasts.size))

    monkeypatch.setitem(simulated.__globals__, "_released", released)
    found = simulated(None, SLOW, [None, None], np.ones(2), 2.0)
    assert asked == [(2, 2.0), (1, LONGER * 2.0)]
    assert found.lasts.tolist() == [True, False]


def test_a_fast_cycle_is_seen_beneath_a_mean_that_wanders_by_as_much():
    t = 2.5e-4 * np.arange(2000)
    q = 5e-5 * np.sin(3150.0 * t) + 6e-5 * np.sin(20.0 * t) + 3e-5 * np.sin(7.3 * t + 1.0)
    amplitude, omega, _ = harmonics(q, 2.5e-4)
    assert amplitude == pytest.approx(5e-5, rel=0.05) and omega == pytest.approx(3150.0, rel=0.01)
