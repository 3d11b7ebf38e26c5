"""Looped functions: their loops, branches and lines, as instructions, do what Python does with the same text, to the bit."""

from functools import lru_cache
from types import FunctionType

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.kernel import cache
from workbench.kernel.straight import Text, abreast, looped, straight
from workbench.simulation import noise

floor, uint64 = np.floor, np.uint64

ODD = st.sampled_from([0.0, -0.0, 1.0, -1.0, np.inf, -np.inf, np.nan, 5e-324, 1.7976931348623157e308])
FLOATS = st.one_of(ODD, st.floats())
LANES = 8


def select(condition, a, b):
    return a if condition else b


def bits(x):
    return int(np.float64(x).view(np.int64))


def plainly(made):
    """What a straight or looped function's text does as Python; one for several lanes does it for each, `lane` being its last argument."""
    text = made.text
    named = {n: globals().get(n) for n in text.function.__code__.co_names}
    known = {n: plainly(f) for n, f in named.items() if isinstance(getattr(f, "text", None), Text)}
    function = FunctionType(text.function.__code__, globals() | known)
    if text.width == 1:
        return function
    return lambda *given: [function(*given[:-1], given[-1] + lane) for lane in range(text.width)]


@lru_cache
def compiled(made):
    """What numba makes of a call of a looped function."""
    given = ", ".join(made.text.parameters)
    return numba.njit(eval(f"lambda {given}: made({given})", {"made": made}))


def assert_alike(made, *arguments):
    """Both leave the same bits in the arrays that they are given; every NaN counts alike."""
    by_python, by_llvm = ([a.copy() if isinstance(a, np.ndarray) else a for a in arguments] for _ in range(2))
    with np.errstate(all="ignore"):
        plainly(made)(*by_python)
    compiled(made)(*by_llvm)
    for a, b in zip(by_python, by_llvm, strict=True):
        np.testing.assert_array_equal(b, a)
        if isinstance(a, np.ndarray) and a.dtype == float:
            assert not np.any((np.signbit(a) != np.signbit(b)) & ~np.isnan(a))


@straight
def paired(a, b, x, k):
    both = a + b * x[k]
    return both, b - a


@looped
def walked(x, out, n, begin, end, every):
    a = x[0]
    b = 1.0
    last = 0
    ends = x[0], x[2]
    for k in range(n):
        a, b = paired(a, b, x, k % 3)
        if a > b:
            a = 0.5 * a
            if k % every == 0:
                last = k
                out[4 + k // every] = a
        for j in range(begin, end, 3):
            if j >= 2:
                b = b + ends[1] / float(j)
            out[20 + j] = b
    out[0] = select(last > 2, a, b)
    out[1], out[2] = ends
    out[3] = float(x.size)
    ends = paired(a, b, x, 1)
    out[4] = ends[0]


@settings(deadline=None)  # the first call compiles
@given(
    st.lists(FLOATS, min_size=3, max_size=3),
    st.integers(-1, 8),
    st.integers(0, 5),
    st.integers(-2, 9),
    st.integers(1, 3),
)
def test_loops_within_loops_and_branches_do_what_their_text_says(values, n, begin, end, every):
    assert_alike(walked, np.array(values), np.zeros(30), n, begin, end, every)


@looped
def counted(a, b, out):
    for k in range(a.size):
        out[0, k] = a[k] + b[k]
        out[1, k] = a[k] - b[k]
        out[2, k] = a[k] // b[k]
        out[3, k] = a[k] % b[k]
        out[4, k] = a[k] & b[k]
        out[5, k] = a[k] | b[k]
        out[6, k] = a[k] ^ b[k]
        out[7, k] = a[k] >> (b[k] % 64)
        out[8, k] = select((a[k] < b[k]) | (a[k] == 7), a[k], 3 * b[k])
        out[9, k] = out.shape[1]


@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(0, 2**62), st.integers(1, 2**32)), min_size=1, max_size=5))
def test_integers_that_are_not_negative_are_those_of_python(pairs):
    a, b = np.array(pairs, dtype=np.int64).T.copy()
    assert_alike(counted, a, b, np.zeros((10, len(pairs)), dtype=np.int64))


@looped
def compared(a, b, out):
    out[0] = select(a < b, 1.0, 0.0)
    out[1] = select(a <= b, 1.0, 0.0)
    out[2] = select(a > b, 1.0, 0.0)
    out[3] = select(a >= b, 1.0, 0.0)
    out[4] = select(a == b, 1.0, 0.0)
    out[5] = select(a != b, 1.0, 0.0)


@pytest.mark.parametrize("number", [int, float])
@pytest.mark.parametrize("a", [-1, 0, 2])
@pytest.mark.parametrize("b", [-2, -1, 0, 2])
def test_comparisons_are_of_numbers_with_sign(number, a, b):
    assert_alike(compared, number(a), number(b), np.zeros(6))


def looked_up(x, table, delays, k, lane):
    past = k - delays[lane]
    at = (select(past >= 0, past, 0) % 2) * 8
    row = (bits(x[lane]) >> 61) + at
    x[8 + lane] = select(past >= 0, table[at + lane], x[8 + lane])
    x[16 + lane] = table[row] + float(lane) * table[row + 1]


by_one, by_two, by_eight = straight(looked_up), abreast(2)(looked_up), abreast(8)(looked_up)


@looped
def one_by_one(x, table, delays, n):
    for k in range(n):
        for lane in range(8):
            by_one(x, table, delays, k, lane)


@looped
def in_twos(x, table, delays, n):
    for k in range(n):
        for lane in range(0, 8, 2):
            by_two(x, table, delays, k, lane)


@looped
def in_eights(x, table, delays, n):
    for k in range(n):
        for lane in range(0, 8, 8):
            by_eight(x, table, delays, k, lane)


@pytest.mark.parametrize("made", [one_by_one, in_twos, in_eights])
@settings(deadline=None, max_examples=50)
@given(
    values=st.lists(FLOATS.map(abs), min_size=LANES, max_size=LANES),
    delays=st.lists(st.integers(0, 4), min_size=LANES, max_size=LANES),
)
def test_each_lane_may_read_an_element_of_its_own(made, values, delays):
    x, table = np.array(values + [0.5] * 2 * LANES), np.random.default_rng(0).normal(size=4 * LANES)
    x = np.where(np.isnan(x), 1.0, x)  # whose sign is anything
    assert_alike(made, x, table, np.array(delays), 4)


NOISE = """
import numba
from workbench.kernel.straight import abreast, looped

@abreast({width})
def draw(x, seeds, strength, k, lane):
    {lines}

@looped
def whole(x, seeds, strength, k):
    for lane in range(0, 8, {width}):
        draw(x, seeds, strength, k, lane)

@numba.njit
def run(x, seeds, strength, k):
    whole(x, seeds, strength, k)
"""


@pytest.mark.parametrize("width", [1, 4])
def test_the_noise_of_kernels_is_that_of_numpy(width, tmp_path, monkeypatch):
    monkeypatch.setenv("WORKBENCH_CACHE", str(tmp_path))
    lines = "\n    ".join(noise.source("x[lane]", "strength[lane]"))
    made = cache.load.__wrapped__(NOISE.format(width=width, lines=lines), "noise")
    rng = np.random.default_rng(0)
    seeds, strength = rng.integers(0, 2**64, LANES, dtype=np.uint64), rng.normal(size=LANES)
    for k in (0, 1, 12345, 10**9):
        x = np.zeros(LANES)
        made.run(x, seeds, strength, k)
        np.testing.assert_array_equal(x, (noise.counts(seeds, k) - noise.MEAN) * strength)


@looped
def endless(x):
    while x[0] > 0.0:
        x[0] = x[0] - 1.0


@looped
def mixed(x, k):
    x[0] = k * x[1]


def test_what_a_looped_function_cannot_hold_is_named():
    refused = TypeError, numba.core.errors.NumbaError
    with pytest.raises(refused, match=r"'while x\[0\] > 0\.0:.*', which it cannot"):
        compiled(endless)(np.ones(1))
    with pytest.raises(refused, match=r"k \* x\[1\], for which there is no instruction"):
        compiled(mixed)(np.ones(2), 3)
