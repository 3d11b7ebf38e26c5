"""Elementary functions: bounds against mpmath, one set of bits from every evaluator, no library call, derivatives."""

import math

import casadi as ca
import mpmath
import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.effects import _arithmetic, elementary

ONE = "exp expm1 log tanh sin cos square absolute sign0".split()
TWO = "power minimum maximum".split()
ULP = {"exp": 2.0, "expm1": 2.0, "tanh": 2.0, "log": 2.0}
ABSOLUTE = {"sin": 2.3e-16, "cos": 2.5e-16}
DOUBLES = st.floats() | st.floats(-40, 40) | st.sampled_from([0.0, -0.0, 709.78, 709.79, -708.0])

WRITTEN = {
    ca.OP_ASSIGN: "{0}",
    ca.OP_ADD: "{0} + {1}",
    ca.OP_SUB: "{0} - {1}",
    ca.OP_MUL: "{0} * {1}",
    ca.OP_DIV: "{0} / {1}",
    ca.OP_NEG: "-{0}",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "2.0 * {0}",
    ca.OP_INV: "1.0 / {0}",
    ca.OP_FABS: "abs({0})",
    ca.OP_SQRT: "math.sqrt({0})",
    ca.OP_FLOOR: "np.floor({0})",
    ca.OP_LT: "1.0 if {0} < {1} else 0.0",
    ca.OP_LE: "1.0 if {0} <= {1} else 0.0",
    ca.OP_NOT: "1.0 if {0} == 0.0 else 0.0",
    ca.OP_IF_ELSE_ZERO: "{1} if {0} != 0.0 else 0.0",
    ca.OP_FMIN: "{0} if ({0} <= {1} or {1} != {1}) else {1}",
    ca.OP_FMAX: "{0} if ({0} >= {1} or {1} != {1}) else {1}",
}


def instructions(f):
    for k in range(f.n_instructions()):
        yield k, f.instruction_id(k), f.instruction_input(k), f.instruction_output(k)


def compiled(f):
    """numba's version of an SX Function of scalars: loop(array of inputs, array of outputs), one column per sample."""
    lines = []
    for k, op, inputs, outputs in instructions(f):
        if op == ca.OP_INPUT:
            lines.append(f"w{outputs[0]} = x[{inputs[0]}, n]")
        elif op == ca.OP_OUTPUT:
            lines.append(f"y[{outputs[0]}, n] = w{inputs[0]}")
        elif op == ca.OP_CONST:
            lines.append(f"w{outputs[0]} = {float(f.instruction_constant(k))!r}")
        else:
            lines.append(f"w{outputs[0]} = " + WRITTEN[op].format(*(f"w{i}" for i in inputs)))
    source = "def loop(x, y):\n for n in range(x.shape[1]):\n  " + "\n  ".join(lines)
    names = {"math": math, "np": np}
    exec(source, names)
    return numba.njit(names["loop"], error_model="numpy")


def outputs(x, y):
    """Every function of x, or of x and y, in the order of ONE and TWO, and the three-operand ones."""
    return [
        *(getattr(elementary, n)(x) for n in ONE),
        *(getattr(elementary, n)(x, y) for n in TWO),
        elementary.clip(x, y, 1.5),
        elementary.where(x, x, y),
    ]


@pytest.fixture(scope="module")
def everything():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    f = ca.Function("f", [x, y], outputs(x, y))
    return f, compiled(f)


def same(a, b):
    """Equal to the last bit, the sign of zero included; any NaN equals any other."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    return np.array_equal(
        np.where(np.isnan(a), np.nan, a).view(np.int64), np.where(np.isnan(b), np.nan, b).view(np.int64)
    )


def of_one(expression, x, arguments):
    """Values of an SX expression in x."""
    return np.array(ca.Function("f", [x], [expression])(np.reshape(arguments, (1, -1)))).ravel()


def samples(name):
    random = np.random.default_rng(1)
    n = 6000
    tiny = random.choice([-1.0, 1.0], n) * 10.0 ** random.uniform(-307, -1, n)
    small = random.uniform(-2, 2, n)
    quarter = np.arange(-40, 41) * (np.pi / 2)
    edges = np.concatenate([quarter, np.nextafter(quarter, 100), np.arange(-20, 21) * (np.log(2) / 2), [0.0]])
    if name == "log":
        near_one = 1 + small / 2 * 10.0 ** random.uniform(-15, 0, n)
        powers = 2.0 ** np.arange(-996, 1024)
        around = [powers, np.nextafter(powers, 0), np.nextafter(powers, np.inf)]
        return np.concatenate(
            [np.abs(tiny[np.abs(tiny) > 1e-300]), 10.0 ** random.uniform(-300, 308, n), near_one, *around]
        )
    if name in ("sin", "cos"):
        many = np.rint(random.uniform(-6e4, 6e4, n)) * (np.pi / 2)
        return np.concatenate([tiny, small, edges, many, random.uniform(-1e5, 1e5, n), [1e5, -1e5]])
    wide = {"exp": (-708.0, 709.78), "expm1": (-46.0, 709.78), "tanh": (-20.0, 20.0)}[name]
    return np.concatenate([tiny, small, edges, random.uniform(*wide, 2 * n), wide])


@pytest.mark.parametrize("name", [*ULP, *ABSOLUTE])
def test_the_error_is_within_the_stated_bound(name):
    x = samples(name)
    values = getattr(elementary, name)(x)
    worst = 0.0
    with mpmath.workdps(40):
        true = [getattr(mpmath, name)(mpmath.mpf(float(a))) for a in x]
        for value, t in zip(values, true, strict=True):
            unit = 1.0 if name in ABSOLUTE else math.ulp(float(t))
            worst = max(worst, float(abs(mpmath.mpf(float(value)) - t)) / unit)
    assert worst <= {**ULP, **ABSOLUTE}[name]


def test_sine_is_relatively_accurate_at_its_zeros():
    x = np.arange(1, 1000) * np.pi
    with mpmath.workdps(60):
        true = np.array([float(mpmath.sin(mpmath.mpf(float(a)))) for a in x])
    assert np.max(np.abs(elementary.sin(x) / true - 1)) < 1e-6


def test_power_is_exp_of_log():
    random = np.random.default_rng(2)
    x = 10.0 ** random.uniform(-6, 6, 4000)
    y = np.clip(random.uniform(-40, 40, x.size) / np.abs(np.log(x)), -200, 200)
    with mpmath.workdps(40):
        true = [mpmath.power(mpmath.mpf(float(a)), mpmath.mpf(float(b))) for a, b in zip(x, y, strict=True)]
        worst = max(abs(mpmath.mpf(float(v)) / t - 1) for v, t in zip(elementary.power(x, y), true, strict=True))
    assert worst < 1e-14
    assert [elementary.power(0.0, 0.5), elementary.power(-1.0, 2.0), elementary.power(3.0, 0.0)] == [0.0, 0.0, 1.0]


def test_the_edges():
    e = elementary
    assert [e.exp(v) for v in (0.0, -0.0, -709.0, -np.inf, 709.79, 1e5, 1e300)] == [1, 1, 0, 0] + 3 * [np.inf]
    assert [e.expm1(v) for v in (0.0, -46.0, -np.inf, 709.79, 1e300)] == [0, -1, -1, np.inf, np.inf]
    assert [e.tanh(v) for v in (0.0, 19.1, -19.1, np.inf, -np.inf)] == [0, 1, -1, 1, -1]
    assert [e.sin(0.0), e.cos(0.0), e.log(1.0), e.log(2.0)] == [0, 1, 0, math.log(2)]
    assert e.exp(-708.0) > 0 and e.exp(709.78) < np.inf
    assert all(np.isnan(e.log(v)) for v in (0.0, -0.0, -3.0, np.inf, -np.inf))
    assert all(np.isnan(getattr(e, n)(np.nan)) for n in ONE if n != "sign0") and np.isnan(e.power(np.nan, 2.0))
    assert [e.sign0(v) for v in (-2.0, -0.0, 0.0, 3.0, np.nan)] == [-1, 0, 0, 1, 0]


def test_least_and_greatest_ignore_nan_and_return_the_first_of_equals():
    e = elementary
    assert (e.minimum(np.nan, 1.0), e.maximum(1.0, np.nan), e.clip(np.nan, 2.0, 3.0)) == (1.0, 1.0, 2.0)
    assert math.copysign(1, e.minimum(0.0, -0.0)) == math.copysign(1, e.maximum(0.0, -0.0)) == 1
    assert math.copysign(1, e.minimum(-0.0, 0.0)) == math.copysign(1, e.maximum(-0.0, 0.0)) == -1
    assert [e.where(1, 2.0, np.nan), e.where(0, np.inf, 3.0)] == [2.0, 3.0]


def test_floats_give_floats_and_arrays_their_shape():
    assert type(elementary.exp(1)) is float and type(elementary.minimum(1, 2.0)) is float
    x = np.linspace(-2, 2, 6).reshape(2, 3)
    assert elementary.tanh(x).shape == elementary.maximum(x, 0.0).shape == (2, 3)
    assert same(elementary.sin(x).ravel(), [elementary.sin(v) for v in x.ravel()])


@pytest.mark.parametrize(
    "rough, k, exponent",
    [
        (_arithmetic.FROM_MINUS_1021, np.arange(-1021, 1025), lambda k: k - 53),
        (_arithmetic.FROM_MINUS_72, np.arange(-72, 1025), lambda k: k - 53),
        (_arithmetic.FOURS, np.arange(28), lambda k: 2 * k - 1),
    ],
)
def test_powers_of_two_are_exact(rough, k, exponent):
    assert np.array_equal(_arithmetic.power_of_two(k.astype(float), rough), np.ldexp(1.0, exponent(k)))


def test_a_hundred_thousand_values_have_the_same_bits(everything):
    f, loop = everything
    random = np.random.default_rng(3)
    x = np.concatenate(
        [random.uniform(-30, 30, 70_000), random.normal(size=30_000) * 10.0 ** random.uniform(-300, 300, 30_000)]
    )
    arguments = np.stack([x, random.uniform(-30, 30, x.size)])
    kernel = np.empty((f.n_out(), x.size))
    loop(arguments, kernel)
    interpreted = np.concatenate([np.array(v) for v in f(arguments[:1], arguments[1:])])
    assert same(kernel, interpreted)
    assert same(kernel, np.stack(outputs(*arguments)))


@settings(deadline=None, max_examples=150)
@given(st.lists(st.tuples(DOUBLES, DOUBLES), min_size=1, max_size=8))
def test_any_doubles_have_the_same_bits(everything, pairs):
    f, loop = everything
    arguments = np.array(pairs).T.copy()
    kernel = np.empty((f.n_out(), len(pairs)))
    loop(arguments, kernel)
    assert same(kernel, np.array([[float(v) for v in f(*pair)] for pair in pairs]).T)
    assert same(kernel, np.stack(outputs(*arguments)))
    assert same(kernel[:, 0], outputs(*pairs[0]))


@pytest.mark.parametrize("name", ONE)
def test_what_casadi_does_to_the_argument_changes_no_bit(name):
    function = getattr(elementary, name)
    forms = [
        lambda v: 0.3 * v,
        lambda v: -v,
        lambda v: -0.3 * v,
        lambda v: v + v,
        lambda v: 0.5 * v,
        lambda v: v / 3.0,
        lambda v: 1.0 / v,
        lambda v: 0.7 * (v * v),
        lambda v: -(v * v),
        lambda v: v - np.pi / 2,
        lambda v: v - 0.5,
        lambda v: 0.3 * elementary.absolute(v),
        lambda v: 0.3 * _arithmetic.only(_arithmetic.less(v, 1.0), v),
    ]
    v, w = ca.SX.sym("v"), ca.SX.sym("w")
    values = np.concatenate([np.random.default_rng(4).uniform(-4, 4, 1500), np.arange(1, 41) * (np.pi / 4)])
    once = ca.Function("once", [v], [0.3 * function(form(v)) for form in forms])
    twice = ca.Function("twice", [w], once.call([w]))  # a call with symbols writes the graph anew
    with np.errstate(all="ignore"):
        expected = np.stack([0.3 * function(form(values)) for form in forms])
    for f in (once, twice):
        assert np.array_equal(np.concatenate([np.array(a) for a in f(values[None, :])]), expected, equal_nan=True)


def test_mx_and_dm_give_the_bits_of_sx(everything):
    f, _ = everything
    x, y = ca.MX.sym("x"), ca.MX.sym("y")
    g = ca.Function("g", [x, y], outputs(x, y))
    for pair in [(0.3, 2.0), (-1.7, 0.4), (0.0, -0.0), (400.0, 1.5), (np.nan, 1.0)]:
        assert same([float(v) for v in f(*pair)], [float(v) for v in g(*pair)])
        # == and not the bits: a DM drops the sign of a zero operand.
        numbers = [float(v) for v in outputs(*map(ca.DM, pair))]
        assert np.array_equal([float(v) for v in f(*pair)], numbers, equal_nan=True)


def test_the_graph_holds_arithmetic_only(everything):
    f, _ = everything
    allowed = {*WRITTEN, ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST}
    assert {op for _, op, _, _ in instructions(f)} <= allowed


@pytest.mark.parametrize(
    "name, most", {"exp": 48, "expm1": 49, "tanh": 53, "sin": 32, "cos": 32, "log": 63, "square": 1}.items()
)
def test_the_number_of_operations_does_not_grow(name, most):
    x = ca.SX.sym("x")
    f = ca.Function("f", [x], [getattr(elementary, name)(x)])
    uncounted = (ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST)
    assert sum(op not in uncounted for _, op, _, _ in instructions(f)) <= most


def test_sine_and_cosine_share_their_reduction():
    x = ca.SX.sym("x")
    pair = ca.vertcat(elementary.sin(x), elementary.cos(x))
    apart, shared = (ca.Function("f", [x], [e]).n_instructions() for e in (pair, ca.cse(pair)))
    assert apart - shared >= 14


@pytest.mark.parametrize(
    "name, slope, arguments",
    [
        ("exp", mpmath.exp, [-700, -30, -1, -0.3466, 0, 0.3465, 0.3466, 1, 30, 700]),
        ("expm1", mpmath.exp, [-30, -1, -0.2877, -1e-9, 0, 1e-9, 0.4055, 1, 30, 700]),
        ("tanh", lambda x: mpmath.sech(x) ** 2, [-12, -1, -0.6, -1e-9, 0, 1e-9, 0.5999, 0.6001, 3, 12]),
        ("sin", mpmath.cos, [-1e5, -7, -1.57, 0, 1e-9, 1.5, 1.6, 3.2, 4.8, 1e5]),
        ("cos", lambda x: -mpmath.sin(x), [-1e5, -7, -1.57, 1e-9, 1.5, 1.6, 3.2, 4.8, 1e5]),
        ("log", lambda x: 1 / x, [1e-300, 1e-9, 0.3, 0.5, 0.7071, 0.9999, 1, 1.0001, 1.4143, 2, 3, 1e9, 1e300]),
        ("square", lambda x: 2 * x, [-3, 0, 2]),
        ("absolute", lambda x: mpmath.sign(x), [-3, 2]),
    ],
)
def test_derivatives_are_true(name, slope, arguments):
    x = ca.SX.sym("x")
    found = of_one(ca.jacobian(getattr(elementary, name)(x), x), x, np.array(arguments, dtype=float))
    assert found == pytest.approx([float(slope(mpmath.mpf(a))) for a in arguments], rel=1e-6, abs=1e-300)


def test_derivatives_of_power_are_true():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    f = ca.Function("f", [x, y], [ca.gradient(elementary.power(x, y), ca.vertcat(x, y))])
    for a, b in [(0.3, 1.7), (2.0, -0.5), (1.0, 3.0), (40.0, 2.0)]:
        assert np.array(f(a, b)).ravel() == pytest.approx([b * a ** (b - 1), a**b * math.log(a)], rel=1e-6)
    assert np.array(f(0.0, 1.5)).ravel().tolist() == [0.0, 0.0]
