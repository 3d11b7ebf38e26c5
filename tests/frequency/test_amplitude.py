"""Frequency responses over amplitude: the closed loop's own amplitude, whole periods, and the best linear approximation."""

import numpy as np
import pytest

from workbench.errors import WorkbenchError
from workbench.frequency.amplitude import best_linear, first_harmonic, in_closed_loop, multisine, with_force
from workbench.hysteresis import Bank

OMEGA = 2 * np.pi * np.geomspace(1.0, 100.0, 30)
PLANT = -1.0 / OMEGA**2
FEEDBACK = 4e4 * (1.0 + 1j * OMEGA / 60.0)


def test_without_a_force_the_loop_is_the_linear_one():
    found = in_closed_loop(PLANT, FEEDBACK, lambda a, w: 0.0, 0.5, OMEGA)
    assert found.plant == pytest.approx(PLANT)
    assert found.sensitivity == pytest.approx(1.0 / (1.0 + PLANT * FEEDBACK))
    assert found.amplitude == pytest.approx(0.5 * np.abs(1.0 - found.sensitivity))


def test_the_amplitude_is_the_one_that_it_brings_about():
    bank = Bank(100.0, (0.05, 0.3), (3000.0, 800.0), (50.0,), (500.0,))
    found = in_closed_loop(PLANT, FEEDBACK, bank.response, 0.4, OMEGA)
    stiff = bank.response(found.amplitude, OMEGA)
    assert found.plant == pytest.approx(with_force(PLANT, stiff), rel=1e-7)
    assert found.amplitude == pytest.approx(0.4 * np.abs(1.0 - found.sensitivity), rel=1e-7)


def test_an_amplitude_that_does_not_settle_is_refused():
    with pytest.raises(WorkbenchError, match="stepped sine"):
        in_closed_loop(PLANT, FEEDBACK, lambda a, w: 1e6 * (1.0 + np.cos(1e3 * a / a.max() * np.sqrt(a))), 1.0, OMEGA)


def test_a_harmonic_is_read_over_whole_periods():
    t = 1e-3 * np.arange(1050)
    signal = 0.7 * np.cos(2 * np.pi * 20.0 * t + 0.3) + 0.2 * np.cos(2 * np.pi * 60.0 * t) + 5.0
    found = first_harmonic(signal[50:], 20.0, 1e-3)
    assert abs(found) == pytest.approx(0.7, rel=1e-9)
    with pytest.raises(WorkbenchError, match="no whole period"):
        first_harmonic(signal[:10], 20.0, 1e-3)


def periods(realisations, cubic=0.0, noise=0.0):
    lines, n = np.arange(3, 60, 2), 512
    r = np.stack([multisine(lines, n, 1.0, seed) for seed in range(realisations)])
    u = np.repeat(r[:, None], 2, axis=1)
    x = 0.5 * u + cubic * u**3 + noise * np.random.default_rng(9).standard_normal(u.shape)
    return r, u, x, lines


def test_a_linear_plant_does_not_scatter_from_phase_to_phase():
    found = best_linear(*periods(6))
    assert found.value == pytest.approx(0.5) and found.total.max() < 1e-12


def test_what_scatters_beyond_noise_is_nonlinear():
    cubic, noisy = best_linear(*periods(8, cubic=0.1)), best_linear(*periods(8, noise=0.1))
    # of a Gaussian input of unit variance the best linear gain of x^3 is 3
    assert np.mean(cubic.value.real) == pytest.approx(0.8, abs=0.03)
    assert cubic.noise.max() < 1e-12 and np.median(cubic.total) > 0.01
    ratio = noisy.total / noisy.noise
    assert 0.5 < np.median(ratio) < 2.0


def test_one_realisation_says_nothing_of_scatter():
    with pytest.raises(WorkbenchError, match="two realisations"):
        best_linear(*periods(1))
