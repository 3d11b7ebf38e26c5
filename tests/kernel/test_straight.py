"""Straight functions: their lines, as instructions, do what Python does with the same text."""

from functools import lru_cache

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.kernel.straight import abreast, straight

fabs, floor = np.abs, np.floor

ODD = st.sampled_from([0.0, -0.0, 1.0, -1.0, np.inf, -np.inf, np.nan, 5e-324, 1.7976931348623157e308])
FLOATS = st.one_of(ODD, st.floats())


def select(condition, a, b):
    return a if condition else b


def lines(x, k, p):
    a = x[1 + k]
    b = x[2 + k] * p[0]
    c = select((a < b) | (a != a), a + b, (-1.5) * b)
    d = select((c >= 0.0) & (c == c), c, -c)
    x[0 + k] = d / p[1]
    return c, d, d - a


given_lines = straight(lines)


@numba.njit
def compiled(x, k, p):
    return given_lines(x, k, (p[0], p[1]))


@settings(deadline=None)  # the first call compiles
@given(st.lists(FLOATS, min_size=4, max_size=4), st.lists(FLOATS, min_size=2, max_size=2), st.integers(0, 1))
def test_a_straight_function_does_what_its_text_says_to_the_bit(values, constants, k):
    x, y = np.array(values), np.array(values)
    p = np.array(constants)
    with np.errstate(all="ignore"):
        expected = lines(x, k, p)
    np.testing.assert_array_equal(np.array(compiled(y, k, p)), np.array(expected))
    np.testing.assert_array_equal(y, x)
    assert not np.any((np.signbit(x) != np.signbit(y)) & ~np.isnan(x))


def power(x):
    return (x**2.0,)


def test_an_operation_for_which_there_is_no_instruction_is_named():
    made = straight(power)
    with pytest.raises(
        (TypeError, numba.core.errors.NumbaError), match=r"x \*\* 2\.0, for which there is no instruction"
    ):
        numba.njit(lambda x: made(x))(1.0)


def over_lanes(x, lane, p, k):
    a = x[0 + lane]
    b = p[0] * k
    c = select((a < b) | (k < p[1]), floor(a), p[1])
    d = select(k < p[1], p[0], p[1])
    x[8 + lane] = c + d
    x[16 + lane] = b
    x[24 + lane] = fabs(a) / c


def in_order(x, p, k):
    for lane in range(8):
        over_lanes(x, lane, p, k)


abreast_lines = {width: abreast(width)(over_lanes) for width in (2, 4, 8)}


@pytest.mark.parametrize("width", abreast_lines)
@settings(deadline=None, max_examples=50)
@given(values=st.lists(FLOATS, min_size=8, max_size=8), constants=st.lists(FLOATS, min_size=2, max_size=2), k=FLOATS)
def test_lanes_side_by_side_have_the_bits_of_one_after_the_other(width, values, constants, k):
    x = np.array(values + [0.0] * 24)
    y, p = x.copy(), np.array(constants)
    with np.errstate(all="ignore"):
        in_order(x, p, np.float64(k))
    beside(width)(y, p, k)
    np.testing.assert_array_equal(y, x)
    assert not np.any((np.signbit(x) != np.signbit(y)) & ~np.isnan(x))


@lru_cache
def beside(width):
    made = abreast_lines[width]

    @numba.njit(error_model="numpy")
    def run(x, p, k):
        for lane in range(0, 8, width):
            made(x, lane, p, k)

    return run
