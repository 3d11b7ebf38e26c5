"""Banks of hysteresis operators: identities, closed forms, and fits that stay passive."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.errors import WorkbenchError
from workbench.hysteresis import Bank, nonnegative, pruned, shaped
from workbench.hysteresis.bank import columns
from workbench.hysteresis.fit import Periodic, gain, grid, left_out
from workbench.kernel.step import build

BANK = Bank(0.3, (0.05, 0.2, 0.6), (3.0, 1.5, 0.5), (40.0, 900.0), (0.4, 1.0))


def sine(amplitude, frequency=10.0, n=480):
    dt = 1.0 / (n * frequency)
    return amplitude * np.sin(2 * np.pi * frequency * dt * np.arange(n)), dt


def record(amplitude, frequency=10.0):
    x, dt = sine(amplitude, frequency)
    weights = np.concatenate([[BANK.stiffness], BANK.springs, BANK.creeps])
    return Periodic(x, columns(x, dt, BANK.radii, BANK.rates) @ weights, dt)


def test_weights_of_plays_are_the_passive_ones_with_the_other_sign():
    a, wb, wc = BANK.plays
    assert a == pytest.approx(0.3 + 5.0 + 1.4) and (wb == -BANK.springs).all() and (wc == -BANK.creeps).all()
    again = Bank.of_plays(a, BANK.radii, wb, BANK.rates, wc)
    assert again.stiffness == pytest.approx(BANK.stiffness) and BANK.passive
    assert not Bank.of_plays(9.0, (0.5,), (0.1667,)).passive


def test_a_bank_is_the_sum_of_its_effects():
    x = 0.02 * np.cumsum(np.random.default_rng(1).standard_normal(2000))
    dt, total = 1e-4, np.zeros(2000)
    signals = {"q": x, "dq": np.diff(x, prepend=x[0]), "dt": dt}
    for e in BANK.effects():
        values = {n: p.value for n, p in e.parameters.items()}
        step = build(e)
        total += np.array([values[n] for n in step.columns]) @ step.run(signals, values)[: len(step.columns)]
    assert np.abs(total - BANK.run(x, dt)).max() < 1e-12


def test_states_that_are_given_count_and_a_play_is_clipped_to_its_gap():
    bank = Bank(0.0, (0.25,), (1.0,), (5.0,), (2.0,))
    x = np.full(3, 1.0)
    held = bank.run(x, 0.1, plays=(0.9,), feet=(0.5,))
    assert held == pytest.approx(0.1 + 2.0 * 0.5 * np.exp(-0.5 * np.arange(1, 4)))
    far = Bank(0.0, (0.25,), (1.0,), (), ()).run(x, 0.1, plays=(-4.0,))
    assert far == pytest.approx(0.25)


@settings(max_examples=20, deadline=None)
@given(st.floats(0.03, 3.0), st.floats(1.0, 200.0))
def test_the_describing_function_is_the_first_harmonic_of_the_settled_columns(amplitude, frequency):
    x, dt = sine(amplitude, frequency, 3600)
    weights = np.concatenate([[BANK.stiffness], BANK.springs, BANK.creeps])
    f = columns(x, dt, BANK.radii, BANK.rates) @ weights
    turn = np.exp(-2j * np.pi * np.arange(3600) / 3600)
    closed = BANK.response(amplitude, 2 * np.pi * frequency)[0]
    assert (f @ turn) / (x @ turn) == pytest.approx(closed, rel=2e-5)


def test_columns_of_a_settled_motion_are_what_a_long_run_ends_in():
    x, dt = sine(0.5)
    x = x + 0.1 * np.roll(x, 100) ** 3
    run = BANK.run(np.tile(x, 60), dt, plays=np.zeros(3))[-x.size :]
    weights = np.concatenate([[BANK.stiffness], BANK.springs, BANK.creeps])
    assert np.abs(columns(x, dt, BANK.radii, BANK.rates) @ weights - run).max() < 2e-5


def test_slopes_say_whether_there_is_an_inverse():
    printed = Bank.of_plays(9.0024, (0.25, 0.5, 1.5), (-1.5783, 0.1667, -0.0655))
    assert printed.slopes == pytest.approx([9.0024, 7.4241, 7.5908, 7.5253])
    assert (printed.slopes > 0.0).all() and not printed.passive


@pytest.fixture(scope="module")
def records():
    return [record(a, f) for f in (5.0, 50.0) for a in (0.2, 0.9)]


def test_a_bank_of_the_right_elements_is_found_again(records):
    found = nonnegative(records, BANK.radii, BANK.rates)
    assert found.gain < 1e-10 and found.optimality < 1e-8
    assert found.bank.springs == pytest.approx(BANK.springs) and found.bank.creeps == pytest.approx(BANK.creeps)


def test_a_dense_bank_is_passive_and_no_neighbour_is_better(records):
    radii, rates = grid(records, 12, 8)
    found = nonnegative(records, radii, rates)
    assert found.bank.passive and found.optimality < 1e-8 and found.gain < 0.02
    weights = np.concatenate([[found.bank.stiffness], found.bank.springs, found.bank.creeps])
    random = np.random.default_rng(2)
    for _ in range(20):
        other = np.maximum(weights + 0.01 * random.standard_normal(weights.size), 0.0)
        assert gain(records, [r.columns(radii, rates) @ other for r in records]) > found.gain


def test_radii_and_rates_that_are_searched_leave_less_than_even_ones(records):
    searched = pruned(records, 3, 2, starts=2)
    even = nonnegative(records, *grid(records, 3, 2))
    assert searched.bank.passive and searched.gain < 0.3 * even.gain and len(searched.starts) == 2


def test_a_shaped_bank_has_springs_that_never_rise(records):
    found = shaped(records, *grid(records, 8, 4))
    assert found.bank.passive and np.all(np.diff(found.bank.springs) <= 1e-6 * found.bank.springs.max())


def test_what_is_left_out_is_never_fitted_better_than_what_is_in(records):
    radii, rates = grid(records, 6, 4)
    inside = nonnegative(records, radii, rates)
    assert left_out(records, radii, rates, 0.0) >= min(inside.gains)


def test_a_record_is_compared_in_its_band_alone():
    x, dt = sine(0.5)
    whole, low = Periodic(x, x, dt), Periodic(x, x, dt, band=25.0)
    spectrum = np.fft.rfft(low.columns((0.1,), ()), axis=0)
    assert np.abs(spectrum[3:]).max() < 1e-9 and np.abs(np.fft.rfft(whole.columns((0.1,), ()), axis=0)[3:]).max() > 1.0


def test_errors_are_sentences():
    with pytest.raises(WorkbenchError, match="as many of each"):
        Bank(0.0, (0.1,), (), (), ())
    with pytest.raises(WorkbenchError, match="above 0"):
        Bank(0.0, (0.0,), (1.0,), (), ())
    with pytest.raises(WorkbenchError, match="at least one record"):
        nonnegative([], (0.1,), ())
