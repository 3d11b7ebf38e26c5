"""The errata and silences of the harmonic-drive paper, one test each, by closed forms and by what it printed itself."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import ive

from workbench.control import fixed_pd, grid, scheduled_pd
from workbench.definition import find
from workbench.description import equivalent
from workbench.effects.hysteresis import presliding_hysteresis
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.schedule import Schedule
from workbench.schedule.check import pumping
from workbench.simulation import Loop, Scenario, simulate

H0, A = 0.15, 636.0
COUNT = 2 * pi / 1_296_000
TABLE_1 = {"scheduled": (0.388e-4, 0.969e-4), "cascade": (1.131e-4, 8.870e-4)}  # no load, loaded, rad
TABLE_2 = (2.404e-4, 2.230e-4)
EFFECT = presliding_hysteresis()(h0=H0, x0=1 / A)


def y(u):
    return H0 * -np.expm1(-A * u)


def loss_as_derived(amplitude):
    return 8 / (pi * amplitude**2) * quad(lambda u: y(u) - y(amplitude) / 2, 0.0, amplitude)[0]


def loss_as_printed(amplitude):
    near = [1e-3, 1e-2, 0.1]
    return -8 / (pi * amplitude**2) * quad(lambda u: y(u) - y(amplitude) / 2, 0.0, pi, points=near, limit=200)[0]


@pytest.mark.parametrize("amplitude", [1e-4, 1e-3, 1e-2])
def test_the_printed_loss_has_the_wrong_sign_and_the_wrong_limit(amplitude):
    right = float(equivalent(EFFECT, [amplitude]).loss[0])
    assert right == pytest.approx(loss_as_derived(amplitude), rel=1e-8)
    assert loss_as_printed(amplitude) < 0.0 and abs(loss_as_printed(amplitude)) > 100 * right
    only_the_sign = -right
    assert only_the_sign < 0.0, "mending the limit alone leaves a loss that drives"


def test_the_amplitude_is_zero_to_peak():
    """From the loop itself, stepped through two cycles: read as peak to peak, the stiffness is 16 % off at 1 mrad."""
    amplitude = 1e-3
    x = amplitude * np.cos(np.linspace(0.0, 4 * pi, 200_001))
    turn, force = loop_of(x)
    stiffness = 2 * np.mean(force[100_000:] * np.cos(np.linspace(2 * pi, 4 * pi, 100_001))) / amplitude
    meant, misread = (float(equivalent(EFFECT, [a]).stiffness[0]) for a in (amplitude, amplitude / 2))
    assert stiffness == pytest.approx(meant, rel=1e-3) and turn == 4
    assert misread / meant == pytest.approx(1.161, abs=0.002)


def loop_of(x):
    """Force along x by Masing's rule: from the last turning point the virgin curve, stretched by two; number of branches."""
    way = np.sign(np.diff(x, prepend=0.0))
    turns = np.flatnonzero(np.diff(way)) + 0
    force, start, at, branches = np.empty(x.size), 0.0, 0.0, 0
    for first, last in zip([0, *(turns + 1)], [*(turns + 1), x.size], strict=True):
        part = x[first:last]
        if branches == 0:
            force[first:last] = y(np.abs(part))
        else:
            force[first:last] = start + np.sign(part[-1] - at) * 2 * y(np.abs(part - at) / 2)
        start, at, branches = force[last - 1], x[last - 1], branches + 1
    return branches - 1, force


def test_damping_follows_from_loss_by_the_closed_loops_own_frequency_alone():
    """c_e w is what friction gives; c_e depends on Kp through w = sqrt((Kp + k_e)/J), so it is implicit."""
    q = equivalent(EFFECT, [1e-3])
    inertia = 0.0074
    soft, stiff = (float(q.loss[0]) / np.sqrt((kp + float(q.stiffness[0])) / inertia) for kp in (100.0, 2000.0))
    assert soft / stiff == pytest.approx(np.sqrt((2000 + 70.294) / (100 + 70.294)), rel=1e-4)


def test_the_text_gives_both_controllers_an_error_that_table_1_has_for_the_loaded_cascade_alone():
    said = 8.8e-4
    near = [(name, i) for name, pair in TABLE_1.items() for i, e in enumerate(pair) if abs(e / said - 1) < 0.05]
    assert near == [("cascade", 1)]


def test_the_disc_has_another_inertia_than_the_printed_one_and_is_a_weak_test():
    disc = 0.5 * 2700 * pi * 0.06**4 * 0.01
    assert disc == pytest.approx(5.5e-4, rel=2e-3) and 5.3e-4 / disc - 1 == pytest.approx(-0.036, abs=2e-3)
    assert disc / 0.0074 < 0.08


def test_four_of_six_printed_errors_are_whole_counts_of_the_output_encoder():
    counts = np.array([*TABLE_1["scheduled"], *TABLE_1["cascade"], *TABLE_2]) / COUNT
    assert np.sum(np.abs(counts - np.round(counts)) < 0.05) == 4
    motor = np.array([*TABLE_1["scheduled"], *TABLE_1["cascade"], *TABLE_2]) / (2 * pi / 400_000)
    assert np.sum(np.abs(motor - np.round(motor)) < 0.05) < 4, "they are not those of the motor's encoder"


def test_the_second_error_is_not_higher_than_in_every_experiment_before():
    assert TABLE_2[1] < TABLE_1["cascade"][1] and TABLE_2[0] > max(TABLE_1["scheduled"])


def test_the_two_perspectives_rank_the_papers_own_controllers_oppositely():
    every = {**TABLE_1, "second": TABLE_2}
    largest = sorted(every, key=lambda n: max(every[n]))
    spread = sorted(every, key=lambda n: max(every[n]) - min(every[n]))
    assert largest == ["scheduled", "second", "cascade"] and spread == ["second", "scheduled", "cascade"]


def axis() -> Plant:
    return Plant(ONE_MASS, (find("inertia")(inertia=0.0074), EFFECT), limits=Limits(3.3, 12.57))


LOOP = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, COUNT)
KNOTS = grid(1e-5, 3.0, 2)
TWO_MODES = Schedule(
    KNOTS, np.where(KNOTS < 3e-3, 1900.0, 250.0), np.where(KNOTS < 3e-3, 6.4, 6.5), 2, reversal=2.5 * COUNT
)


def test_the_schedules_amplitude_is_the_stroke_from_rest_and_half_of_it_after_a_reversal():
    run = simulate(axis(), LOOP, scheduled_pd(TWO_MODES, "following"), [Scenario(target=0.3)], 0.5,
                   ("y", "amplitude", "share")).trajectories  # fmt: skip
    first = run["share"][:, 0] == 1.0
    moved = run["y"][:, 0] - run["y"][0, 0]
    on = first & (moved > KNOTS[0])
    np.testing.assert_allclose(run["amplitude"][on, 0], moved[on], rtol=1e-12)


def test_a_large_step_without_overshoot_arrives_in_gross_sliding_and_the_error_in_the_rule_mends_it():
    """With the paper's rule the error is that of the gross gains alone: as large as theirs, held by friction at h0/Kp."""
    step = [Scenario(target=2.513)]
    paper, alone, aware = (
        simulate(axis(), LOOP, c, step, 0.6).final_error[0]
        for c in (scheduled_pd(TWO_MODES, "following"), fixed_pd(250.0, 6.5), scheduled_pd(TWO_MODES, "error"))
    )
    assert paper == pytest.approx(alone, rel=1e-6) and paper == pytest.approx(H0 / 250.0, rel=0.05)
    assert aware < 0.2 * paper


def test_gains_that_fall_along_the_stroke_feed_energy_in():
    flat = Schedule(KNOTS, np.full(KNOTS.size, 300.0), np.full(KNOTS.size, 6.2), 2)
    amplitude = np.array([6e-3])
    fed = pumping(TWO_MODES, amplitude)[0]
    by_hand = (
        2 / pi
        * quad(
            lambda f: TWO_MODES.gains(np.array([amplitude[0] * (1 - np.cos(f)) / 2]))[0][0] * np.cos(f) * np.sin(f),
            0.0, pi, limit=400,
        )[0]
    )  # fmt: skip
    assert fed == pytest.approx(by_hand, rel=1e-3) and fed > 50.0
    assert pumping(flat, amplitude)[0] == pytest.approx(0.0, abs=1e-9)


def test_a_spring_to_ground_keeps_part_of_a_small_step():
    """So the 1 % band is about the response's own final value."""
    step, kp = 1e-4, 500.0
    m = simulate(axis(), Loop(2.5e-4, 8), fixed_pd(kp, 4.0), [Scenario(target=step)], 0.3, own=True)
    at_rest = brentq(lambda x: kp * (step - x) - y(x), 0.0, step)
    assert m.final_error[0] == pytest.approx(step - at_rest, rel=0.03)
    assert m.time_1pct[0] == np.inf and m.time_own[0] < 0.1


def test_the_closed_forms_of_both_parameters_are_bessel_functions():
    a = np.geomspace(1e-5, 1.0, 21)
    z = A * a / 2
    q = equivalent(EFFECT, a)
    np.testing.assert_allclose(q.stiffness, 2 * H0 * A * ive(1, z) / z, rtol=1e-10)
    np.testing.assert_allclose(q.loss, 4 * H0 * A / pi * np.sqrt(pi / (2 * z)) * ive(1.5, z), rtol=1e-10)
    assert float(equivalent(EFFECT, [4.2264e-3]).loss[0]) == pytest.approx(16.9266, abs=1e-3)


def test_the_printed_test_reaches_three_quarters_of_the_friction_and_correlates_its_parameters():
    amplitude = 0.003 / (2 * pi * 0.2)
    assert -np.expm1(-A * amplitude) == pytest.approx(0.78, abs=0.005)

    def correlation(size):
        u = np.linspace(0.0, size, 400)
        columns = np.stack([-np.expm1(-A * u), H0 * u * np.exp(-A * u)], axis=1)
        cov = np.linalg.inv(columns.T @ columns)
        return cov[0, 1] / np.sqrt(cov[0, 0] * cov[1, 1])

    assert correlation(amplitude) < -0.95 < -0.8 < correlation(10 * amplitude)
