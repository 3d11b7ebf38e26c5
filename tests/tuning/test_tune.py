"""Gains per amplitude: the analytic optimum, the limits on the exact sampled loop, and what is said where they fail."""

from dataclasses import replace
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

from workbench.control.notched import behind
from workbench.definition import find
from workbench.description import Equivalent
from workbench.errors import WorkbenchError
from workbench.plant import ONE_MASS, Plant
from workbench.threads import one_thread
from workbench.tuning import TuningGoal, response, sampled, tune, tuned_axis
from workbench.tuning.axis import Axis
from workbench.tuning.curve import clenshaw, curve
from workbench.tuning.problem import solver
from workbench.tuning.solve import solve
from workbench.tuning.start import stable_box, start


def presliding(amplitude, h0: float = 0.15, a: float = 636.0) -> Equivalent:
    """Closed form for the virgin curve h0 (1 - exp(-a x))."""
    from scipy.special import ive

    amplitude = np.asarray(amplitude, dtype=float)
    z = a * amplitude / 2.0
    loss = 4.0 * h0 * a / np.pi * np.sqrt(np.pi / (2.0 * z)) * ive(1.5, z)
    return Equivalent(amplitude, 2.0 * h0 * a * ive(1, z) / z, loss)


def loop(sample_time: float = 0.25e-3, delay: float = 1.0, velocity_filter: float = 1.0) -> SimpleNamespace:
    """Delay and filter in samples."""
    return SimpleNamespace(
        sample_time=sample_time,
        delay=delay * sample_time,
        velocity_filter=velocity_filter * sample_time,
        resolution=4.848e-6,
    )


AXES = {
    "8C-50": (0.0074, TuningGoal(drive=3.3, speed=12.57)),
    "8C-30": (0.0026, TuningGoal(drive=1.8, speed=20.9)),
}
AMPLITUDE = np.geomspace(1e-5, 2.5, 40)
FREE = Equivalent(np.array([1e-3, 1e-1]), np.zeros(2), np.zeros(2))


@pytest.fixture(scope="module", params=[("8C-50", 0.25e-3), ("8C-50", 1e-3), ("8C-30", 0.25e-3)], ids=str)
def tuned(request):
    name, sample_time = request.param
    inertia, goal = AXES[name]
    return (
        inertia,
        goal,
        loop(sample_time),
        tune(presliding(AMPLITUDE), inertia, 0.0, goal, loop(sample_time), margins=False),
    )


# --- the analytic optimum --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("overshoot", "zeta", "tau"), [(0.01, 0.82609, 4.1916), (0.008, 0.838191, 4.324795)])
def test_kp_on_its_bound_and_kd_free_is_the_analytic_optimum(overshoot, zeta, tau):
    goal = TuningGoal(overshoot=overshoot, drive=3.3, sensitivity=inf)
    g = tune(FREE, 0.0074, 0.0, goal, loop(1e-5, 0.0, 0.0), margins=False)
    omega = np.sqrt(g.kp / 0.0074)
    assert g.kp == pytest.approx(3.3 / FREE.amplitude, rel=1e-6)
    assert g.kd / (2.0 * np.sqrt(0.0074 * g.kp)) == pytest.approx(zeta, rel=1e-5)
    assert omega * g.time == pytest.approx(tau, rel=1e-4)
    assert g.overshoot == pytest.approx(overshoot, rel=1e-6)
    assert g.binding == (("overshoot", "drive"),) * 2


def test_the_optimum_is_the_shortest_time_of_a_fine_search_over_kd():
    goal = TuningGoal(drive=3.3, sensitivity=inf)
    equivalent = presliding([3e-3, 1e-2])
    g = tune(equivalent, 0.0074, 0.02, goal, loop(), margins=False)
    for i in range(2):
        kd = g.kd[i] * np.linspace(0.8, 1.5, 2001)
        k = g.kp[i] + equivalent.stiffness[i]
        zeta = (kd + 0.02 + equivalent.loss[i] / np.sqrt(k / 0.0074)) / (2.0 * np.sqrt(0.0074 * k))
        time = response.enter_time(zeta) / np.sqrt(k / 0.0074)
        best = time[response.overshoot(zeta) <= 0.008].min()
        assert g.time[i] == pytest.approx(best, rel=1e-3) and g.time[i] <= best * (1.0 + 1e-9)


def test_closed_form_response_is_the_integrated_one_below_at_and_above_critical_damping():
    from scipy.integrate import solve_ivp

    tau = np.linspace(0.1, 8.0, 40)
    for zeta in (0.5, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 4.0):
        run = solve_ivp(
            lambda t, x, z=zeta: [x[1], 1.0 - x[0] - 2.0 * z * x[1]], (0, 8), [0, 0], t_eval=tau, rtol=1e-11, atol=1e-13
        )
        assert 1.0 - response.remainder(zeta, tau) == pytest.approx(run.y[0], abs=1e-9)
    assert response.speed_ratio(np.array([1.0 - 1e-4, 1.0, 1.0 + 1e-4])) == pytest.approx(np.exp(-1.0), rel=1e-3)


def test_below_the_cliff_the_response_leaves_the_band_again():
    assert response.damping_for(0.01) == pytest.approx(0.82609, abs=1e-5)
    tau = np.linspace(0.0, 12.0, 200001)

    def stays(zeta):
        return tau[np.flatnonzero(np.abs(response.remainder(zeta, tau)) > 0.01)[-1]]

    assert stays(0.8262) == pytest.approx(4.19, abs=0.01)
    assert stays(0.82608) == pytest.approx(5.58, abs=0.03)
    assert TuningGoal(overshoot=0.05).allowed == 0.01


def test_the_polynomial_of_damping_over_time_is_the_closed_form():
    ends, shapes = curve(0.01, response.damping_for(0.008))
    s = np.linspace(*ends, 500)
    zeta = np.exp([clenshaw(shapes[0], x) for x in (2.0 * s - ends.sum()) / np.diff(ends)])
    assert response.enter_time(zeta) == pytest.approx(np.exp(s), rel=3e-6)


# --- the sampled loop ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0, 1.7])
def test_frequency_response_and_matrix_are_those_of_a_simulated_loop(delay):
    """The response to a sine, and the closed loop's free motion, by stepping the axis finely between samples."""
    clock = sampled.Clock.of(loop(1.0, delay, 0.7))
    stiffness, damping, kp, kd = (np.array([v]) for v in (0.02, 0.05, 0.03, 0.2))
    motion = sampled.steps(stiffness, damping, clock)
    past = np.zeros(4)  # commands, newest first
    fine = 10
    phi, gamma = sampled.hold(stiffness, damping, 1.0 / fine)
    y, before, vh = np.array([0.3, -0.1]), 0.1, 0.05
    state = np.array([*y, before, vh, *np.zeros(clock.whole + (clock.part > 0.0))])
    matrix = sampled.closed(kp, kd, motion, clock)[0]
    for _ in range(40):
        vh += clock.alpha * (y[0] - before - vh)
        before = y[0]
        past = np.concatenate([[-kp[0] * y[0] - kd[0] * vh], past[:-1]])
        for n in range(fine):
            age = clock.whole + (n < round(clock.part * fine))
            y = phi[0] @ y + gamma[0] * past[age]
        state = matrix @ state
        assert state[:4] == pytest.approx([*y, before, vh], abs=1e-12)
    theta = np.array([0.3, 1.0, 3.0])
    law = kp + kd * sampled.difference(theta, clock)
    back = 1.0 + law * sampled.response(theta, motion, clock)[0]
    for angle, value in zip(theta, back, strict=True):
        whole = np.linalg.det(np.exp(1j * angle) * np.eye(len(matrix)) - matrix)
        free = np.linalg.det(
            np.exp(1j * angle) * np.eye(len(matrix)) - sampled.closed(0 * kp, 0 * kd, motion, clock)[0]
        )
        assert value == pytest.approx(whole / free, rel=1e-9)


@pytest.mark.parametrize("delay", [0.4, 1.0])
def test_with_a_notch_the_closed_loop_has_its_matrix_where_its_response_has_it(delay):
    """det(z - closed) over that of the open loop, the notch's own poles among them, is 1 + N L."""
    clock = replace(sampled.Clock.of(loop(1.0, delay, 0.7)), notch=(0.7, -0.9, 0.5, 0.3))
    stiffness, damping, kp, kd = (np.array([v]) for v in (0.02, 0.05, 0.03, 0.2))
    motion = sampled.steps(stiffness, damping, clock)
    matrix, free = (sampled.closed(f * kp, f * kd, motion, clock)[0] for f in (1.0, 0.0))
    theta = np.array([0.3, 1.0, 3.0])
    passed = behind(clock.notch, theta) * (kp + kd * sampled.difference(theta, clock))
    z = np.exp(1j * theta)[:, None, None] * np.eye(len(matrix))
    found = np.linalg.det(z - matrix) / np.linalg.det(z - free)
    assert found == pytest.approx(1.0 + passed * sampled.response(theta, motion, clock)[0], rel=1e-9)


def test_every_amplitude_keeps_its_limits_on_the_exact_loop(tuned):
    inertia, goal, cycle, g = tuned
    assert not g.findings
    assert (g.sensitivity_peak <= 2.0 * 1.005).all() and (g.spectral_radius < 1.0).all()
    assert (g.overshoot <= goal.overshoot * (1.0 + 1e-6)).all()
    assert (g.kp * g.amplitude <= goal.drive * (1.0 + 1e-6)).all()
    equivalent = presliding(g.amplitude)
    omega = np.sqrt((g.kp + equivalent.stiffness) / inertia)
    zeta = (g.kd + equivalent.loss / omega) / (2.0 * inertia * omega)
    speed = g.amplitude * g.kp / inertia / omega * response.speed_ratio(zeta)
    assert (speed <= goal.speed * (1.0 + 1e-6)).all()
    assert all(len(b) == 2 and b[0] == "overshoot" for b in g.binding)
    bounds = {
        "drive": g.kp * g.amplitude / goal.drive,
        "speed": speed / goal.speed,
        "sensitivity": g.sensitivity_peak / 2.0,
    }
    for i, (_, second) in enumerate(g.binding):
        assert bounds[second][i] == pytest.approx(1.0, rel=1e-3)


def test_margins_are_those_that_the_sensitivity_promises():
    inertia, goal = AXES["8C-50"]
    g = tune(presliding(AMPLITUDE[:20:6]), inertia, 0.0, goal, loop())
    assert (g.gain_margin >= 2.0).all() and (g.phase_margin >= 2.0 * np.arcsin(0.25)).all()
    axis = Axis.of(presliding(g.amplitude), inertia, 0.0, loop())
    kp, kd = g.kp / axis.unit_kp, g.kd / axis.unit_kd
    motion = axis.steps(kp)
    for factor, stable in ((0.999, True), (1.001, False)):
        radius = sampled.spectral_radius(factor * g.gain_margin * kp, factor * g.gain_margin * kd, motion, axis.clock)
        assert ((radius < 1.0) == stable).all()


@one_thread
def test_random_starts_over_three_decades_end_at_the_same_optimum():
    inertia, goal = AXES["8C-50"]
    rng = np.random.default_rng(7)
    n, same = 30, []
    for amplitude, sample_time in ((1e-4, 0.25e-3), (2.5e-3, 0.25e-3), (1e-2, 1e-3), (2.0, 1e-3)):
        one = Axis.of(presliding([amplitude]), inertia, 0.0, loop(sample_time))
        box = stable_box(one)
        kp, kd, _ = start(one, goal, box)
        best = solve(one, goal, box, kp, kd)
        many, wide = one.take(np.zeros(n, dtype=int)), tuple(np.repeat(b, n) for b in box)
        factor = 10.0 ** rng.uniform(-1.5, 1.5, (2, n))
        got = solve(
            many, goal, wide, best.kp * factor[0], best.kd * factor[1], first=(np.repeat(kp, n), np.repeat(kd, n))
        )
        time = got.tau / many.omega(got.kp)
        same += list(np.abs(time / (best.tau / one.omega(best.kp)) - 1.0) < 0.005)
    assert np.mean(same) >= 0.95


def test_the_program_is_built_once():
    assert solver() is solver()


def test_starts_given_by_the_caller_are_used():
    inertia, goal = AXES["8C-30"]
    equivalent = presliding([1e-4, 1e-2])
    plain = tune(equivalent, inertia, 0.0, goal, loop(), margins=False)
    other = tune(equivalent, inertia, 0.0, goal, loop(), margins=False, begin=(plain.kp * 5.0, plain.kd / 3.0))
    assert other.time == pytest.approx(plain.time, rel=1e-3)


def test_an_axis_damped_enough_by_itself_gets_no_kd():
    equivalent = Equivalent(np.array([0.1]), np.array([1.0]), np.array([0.0]))
    g = tune(equivalent, 0.0074, 5.0, TuningGoal(drive=3.3), loop(), margins=False)
    assert g.kd[0] == pytest.approx(0.0, abs=1e-5) and "damping" in g.binding[0] and "drive" in g.binding[0]
    assert g.overshoot[0] == 0.0


# --- what is said ----------------------------------------------------------------------------------------------------


def test_an_error_that_gains_can_reach_is_kept_and_one_that_they_cannot_is_dropped_with_a_finding():
    inertia, goal = AXES["8C-50"]
    equivalent = presliding(np.geomspace(1e-5, 1e-2, 12))
    plain = tune(equivalent, inertia, 0.0, goal, loop(), margins=False)
    kept = tune(equivalent, inertia, 0.0, replace(goal, error=0.05), loop(), margins=False)
    assert kept.time == pytest.approx(plain.time) and not kept.findings
    lost = tune(equivalent, inertia, 0.0, replace(goal, error=0.01), loop(), margins=False)
    assert lost.kp == pytest.approx(plain.kp)
    (finding,) = lost.findings
    assert finding.kind == "constraint dropped" and finding.evidence["best"] == pytest.approx(
        plain.error_ratio[0], rel=0.02
    )


def test_gains_without_a_sensitivity_limit_may_be_unstable_and_are_then_named():
    inertia, goal = AXES["8C-50"]
    g = tune(presliding([1e-5]), inertia, 0.0, replace(goal, sensitivity=inf), loop(1e-3), margins=False)
    assert [f.kind for f in g.findings] == ["unstable"] and g.spectral_radius[0] > 1.0


def test_an_infeasible_goal_names_the_limits_and_the_amplitude():
    with pytest.raises(
        WorkbenchError, match=r"amplitude 1e-05: an overshoot of 0.80% already needs Kd .* unstable; sample"
    ):
        tune(presliding([1e-5, 1e-4]), 0.0074, 0.0, TuningGoal(drive=3.3), loop(10e-3))
    inertia, goal = AXES["8C-30"]
    with pytest.raises(
        WorkbenchError, match=r"sensitivity peak is 2.37, above 2; .* or tune from 0.00063 on only"
    ) as refused:
        tune(presliding(AMPLITUDE), inertia, 0.0, goal, loop(1e-3))
    assert refused.value.lowest in AMPLITUDE
    gains = tune(
        presliding(AMPLITUDE[refused.value.lowest <= AMPLITUDE]), inertia, 0.0, goal, loop(1e-3), margins=False
    )
    assert gains.sensitivity_peak.max() <= goal.sensitivity * 1.001
    with pytest.raises(WorkbenchError, match=r"sensitivity peak is .*, above 1.05"):
        tune(presliding([1e-5, 1e-4]), 0.0074, 0.0, TuningGoal(drive=3.3, sensitivity=1.05), loop(1e-3))


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"amplitude": [1e-3, 1e-3]}, "amplitudes must increase: number 2, 0.001, is not above 0.001"),
        ({"amplitude": [-1e-3, 1e-3]}, "finite and positive"),
        ({"stiffness": [1.0, -1.0]}, "equivalent stiffness at amplitude 0.01 is -1"),
        ({"loss": [np.nan, 1.0]}, "equivalent loss at amplitude 0.001 is nan"),
        ({"loss": [1.0]}, "arrays of one length"),
    ],
)
def test_a_description_that_is_none_is_refused_with_what_is_wrong(change, sentence):
    given = {"amplitude": [1e-3, 1e-2], "stiffness": [1.0, 1.0], "loss": [0.0, 0.0]} | change
    with pytest.raises(WorkbenchError, match=sentence):
        tune(SimpleNamespace(**given), 0.0074, 0.0, TuningGoal(drive=3.3), loop())


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((0.0, 0.0, loop()), "inertia is 0"),
        ((0.0074, -1.0, loop()), "viscous damping is -1"),
        ((0.0074, 0.0, SimpleNamespace(sample_time=0.0, delay=0.0, velocity_filter=0.0)), "sample_time is 0 s"),
    ],
)
def test_an_axis_or_loop_that_is_none_is_refused(arguments, sentence):
    inertia, viscous, cycle = arguments
    with pytest.raises(WorkbenchError, match=sentence):
        tune(FREE, inertia, viscous, TuningGoal(drive=3.3), cycle)


@pytest.mark.parametrize(
    "wrong", [{"overshoot": 0.0}, {"sensitivity": 1.0}, {"drive": -1.0}, {"error": 1.5}, {"band": 0.5}]
)
def test_a_goal_out_of_range_is_refused_by_name(wrong):
    with pytest.raises(WorkbenchError, match=next(iter(wrong))):
        TuningGoal(**wrong)


def test_an_axis_that_a_magnet_draws_away_from_the_middle_is_refused_with_what_would_mend_it():
    magnet = find("linear_stiffness")(at="axis", stiffness=-860.0)
    plant = Plant(ONE_MASS, rotary=False) + find("inertia")(inertia=3.0) + magnet
    stiff = find("cubic_stiffness")(at="axis", k3=4e12)  # from 17 um on the flexure holds it
    with pytest.raises(WorkbenchError, match=r"At amplitude 1e-05 m .* with 560 N/m.*docs/compensation.md"):
        tuned_axis(plant + stiff, np.array([1e-5, 1e-4]), TuningGoal(), loop())
