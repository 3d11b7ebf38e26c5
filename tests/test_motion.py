"""The motion of a record: a filter without phase, derivatives of sines, and a dead band that swallows a toggling count."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.motion import MOTION_BAND, TRIM, LowPass, fast_length, increments, motion
from workbench.record import Record, Source

RATE, N = 1000.0, 3000
T = np.arange(N) / RATE
INSIDE = slice(500, -500)


def record(position: np.ndarray, counts: float = 0.0, counts_from: float = -np.inf) -> Record:
    return Record(
        "r", "identification", T.copy(), {"torque": np.sin(T), "position": position}, {}, Source(Path("r"), "", "", {}),
        {"position": counts} if counts else {}, counts_from=counts_from,
    )  # fmt: skip


# --- the filter -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("frequency", [1.0, 20.0, 70.0, 100.0, 130.0, 200.0])
def test_a_sine_keeps_its_phase_and_takes_the_stated_magnitude(frequency):
    """1/(1 + (f/f_c)^8), a real number at every frequency."""
    wave = np.sin(2 * np.pi * frequency * T + 0.4)
    found = LowPass(100.0, RATE, N)(wave)[INSIDE]
    expected = wave[INSIDE] / (1 + (frequency / 100.0) ** 8)
    # where the record ends within a wave, the reflection makes a corner, whose ripples die out towards the middle
    np.testing.assert_allclose(found, expected, atol=2e-5)


def test_the_filter_is_the_same_backwards():
    x = np.random.default_rng(0).normal(size=N)
    f = LowPass(100.0, RATE, N)
    np.testing.assert_allclose(f(x[::-1])[::-1][INSIDE], f(x)[INSIDE], atol=1e-6)


def test_the_filter_is_linear_and_takes_rows():
    x = np.random.default_rng(0).normal(size=(3, N))
    f = LowPass(100.0, RATE, N)
    rows = f(x)
    np.testing.assert_array_equal(rows[1], f(x[1]))
    np.testing.assert_allclose(f(2 * x[0] + x[2]), 2 * rows[0] + rows[2], atol=1e-12)


def test_a_ramp_that_ends_in_motion_passes_unchanged():
    ramp = 3.0 + 2.0 * T
    f = LowPass(100.0, RATE, N)
    np.testing.assert_allclose(f(ramp), ramp, atol=1e-9)


@pytest.mark.parametrize("frequency", [0.5, 5.0, 40.0, 100.0])
@pytest.mark.parametrize("order", [1, 2])
def test_derivatives_of_a_sine(frequency, order):
    w = 2 * np.pi * frequency
    found = LowPass(200.0, RATE, N)(np.sin(w * T + 0.7), derivative=order)[INSIDE]
    exact = w**order * (np.cos(w * T + 0.7) if order == 1 else -np.sin(w * T + 0.7))[INSIDE]
    assert np.abs(found - exact / (1 + (frequency / 200.0) ** 8)).max() <= 1e-3 * w**order
    if frequency <= 40.0:
        assert np.abs(found - exact).max() <= 1e-3 * w**order


def test_derivatives_of_rows_have_the_bits_of_one_row_and_one_derivative_at_a_time():
    x = np.cumsum(np.random.default_rng(1).normal(size=(2, N)), axis=-1)
    f = LowPass(100.0, RATE, N)
    found = f.derivatives(x, 3)
    assert found.shape == (3, 2, N)
    for order in range(3):
        for row in range(2):
            np.testing.assert_array_equal(found[order, row], f(x[row], order))


@pytest.mark.parametrize("ratio", [Fraction(1, 4), Fraction(3, 5), Fraction(4, 15)])
@pytest.mark.parametrize("n", [N, N + 1, 40])
def test_what_is_read_at_a_lower_rate_is_the_wave_at_those_times(ratio, n):
    """Of a wave that the lower rate resolves, 1.5e-5 of which the filter takes; one above half that rate leaves nothing."""
    f = LowPass(0.4 * RATE * float(ratio), RATE, n)
    t, read = np.arange(n) / RATE, np.arange(int((n - 1) * ratio) + 1) / (RATE * float(ratio))

    def low(t):
        return 1.0 + t + np.sin(2 * np.pi * 0.1 * RATE * float(ratio) * t)

    found = f.at_lower_rate(np.stack([low(t), low(t) + np.sin(2 * np.pi * 0.45 * RATE * t)]), ratio, read.size)
    assert found.shape == (2, read.size)
    if n >= N:
        inside = slice(int(400 * ratio), -int(400 * ratio))
        np.testing.assert_allclose(found[0, inside], low(read)[inside], atol=1e-4)
        np.testing.assert_allclose(found[1, inside], found[0, inside], atol=1e-3)


def test_a_record_whose_ends_lie_apart_does_not_ring_at_a_low_rate():
    """The transform takes the record for one period; at half its rate the response of a motion's low pass is still a half."""
    rate, n = 400.0, 4000
    t = np.arange(n) / rate
    move = 1.0 / (1.0 + np.exp(-20.0 * (t - 5.0)))  # from 0 to 1 within a second, at rest before and after
    q, v, a = LowPass(0.5 * rate, rate, n).derivatives(move, 3)
    still = np.abs(t - 5.0) > 2.0
    assert np.abs(v[still]).max() <= 1e-6 and np.abs(a[still]).max() <= 1e-3
    exact = 20.0 * move * (1.0 - move)
    assert np.abs(v - exact).max() <= 1e-6 * exact.max()


@pytest.mark.parametrize("n", [7, 30, 200, 1001])
def test_short_records_are_filtered_too(n):
    found = LowPass(100.0, RATE, n)(np.ones(n))
    np.testing.assert_allclose(found, 1.0, atol=1e-12)


@settings(deadline=None)
@given(st.integers(1, 100_000))
def test_the_fast_length_is_the_next_with_small_factors(n):
    def small(k):
        for p in (2, 3, 5):
            while k % p == 0:
                k //= p
        return k == 1

    found = fast_length(n)
    assert found >= n and small(found)
    assert not any(small(k) for k in range(n, min(found, n + 200)))


# --- the dead band ----------------------------------------------------------------------------------------------------


def test_a_toggling_count_is_swallowed():
    toggling = 1e-6 * (np.arange(N) % 2)
    found = increments(1.0 + toggling, 1e-6)
    assert np.abs(found).max() <= 0.5e-6 * (1 + 1e-6)  # it settles half a count aside, once
    assert np.all(found[2:] == 0.0)


@settings(max_examples=50, deadline=None)
@given(st.lists(st.integers(-5, 5), min_size=2, max_size=60))
def test_increments_follow_the_position_within_half_a_count(counts):
    position = 1e-6 * np.cumsum(counts)
    followed = position[0] + np.cumsum(increments(position, 1e-6))
    assert np.abs(followed - position).max() <= 0.5e-6 * (1 + 1e-9)


@settings(max_examples=50, deadline=None)
@given(st.lists(st.floats(-1, 1), min_size=2, max_size=60))
def test_without_a_resolution_increments_are_those_of_the_position(position):
    position = np.array(position)
    found = increments(position, 0.0)
    assert found[0] == 0.0
    np.testing.assert_array_equal(found[1:], np.diff(position))


def test_a_reversal_reaches_the_operators_one_count_late():
    position = 1e-6 * np.array([0, 1, 2, 3, 2, 1, 0, -1.0])
    np.testing.assert_allclose(increments(position, 1e-6) * 1e6, [0, 0.5, 1, 1, 0, -1, -1, -1], atol=1e-9)


# --- records ----------------------------------------------------------------------------------------------------------


def test_a_record_becomes_its_motion():
    w = 2 * np.pi * 3.0
    m = motion(record(np.sin(w * T), 1e-6), 100.0)
    assert m.filter.bandwidth == 100.0 and m.counts == 1e-6 and m.dt == pytest.approx(1e-3)
    np.testing.assert_allclose(m.v[INSIDE], w * np.cos(w * T)[INSIDE], rtol=0, atol=1e-4 * w)
    np.testing.assert_allclose(m.a[INSIDE], -(w**2) * np.sin(w * T)[INSIDE], rtol=0, atol=1e-4 * w**2)
    np.testing.assert_array_equal(m.u, np.sin(T))
    assert 1 / (1 + MOTION_BAND**-8) > 0.996  # of the motion's own low pass at the evaluation bandwidth


def test_what_counts_begins_after_the_trim_or_where_the_record_says():
    assert motion(record(T), 100.0).keep == slice(int(TRIM * RATE), N - int(TRIM * RATE))
    assert motion(record(T, counts_from=0.8), 100.0).keep.start == 800
    assert motion(record(T), 8.0).keep == slice(RATE // 8, N - RATE // 8)  # an end shows for as long as its filter does


def test_a_record_is_not_changed():
    r = record(np.sin(T))
    motion(r, 100.0)
    with pytest.raises(ValueError, match="read-only"):
        r.channels["position"][0] = 1.0
    np.testing.assert_array_equal(r.channels["position"], np.sin(T))
