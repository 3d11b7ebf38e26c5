"""Elementary functions written from arithmetic alone, so that every evaluator agrees to the last bit.

Each function takes CasADi SX or MX and builds a graph of + - * /, fabs, sqrt, square, floor, fmin, fmax, comparisons
and if-else-zero only; floats and NumPy arrays go through the same operations in the same order. All of these are
correctly rounded (or exact) by IEEE 754, so CasADi, NumPy, numba and every machine return the same bits, as long as
nothing contracts a*b + c into a fused multiply-add. There is no branch and no library call, so loops vectorise.

Three devices take the place of the exponent field of a double:

- *Power of two*: `2**k` is found from a rough value y in (2**k, 2**(k+1)): y - (1 - 2**-53)*y is exactly the unit in
  the last place, 2**(k - 52) (after Rump, Zimmermann, Boldo, Melquiond, "Computing predecessor and successor in
  rounding to nearest", BIT 49, 2009). The rough value is a quadratic in k, fitted to 2**(k/2**n), squared n times.
- *Argument reduction* with a constant in two parts, the first short enough for k * part to be exact (Cody & Waite,
  "Software Manual for the Elementary Functions", 1980).
- *Polynomials* are minimax fits (Remez) of the remainder behind the exact first terms.

CasADi rewrites c1*(c2*x) to (c1*c2)*x and (x - c) + c to x. Arguments are therefore first met by an addition of a
constant that nobody else writes, or by a factor that is a power of two; then such rewriting changes no bit.

NaN: exp, expm1, tanh, sin, cos, log, power, square and absolute return NaN. minimum, maximum and clip ignore a NaN
operand; sign0 returns 0. The sign of a zero is not kept by expm1, tanh, sin and where.
"""

from collections.abc import Callable
from functools import wraps

import casadi as ca
import numpy as np

_SYMBOLIC = (ca.SX, ca.MX, ca.DM)

_LN2_HIGH, _LN2_LOW = 0.6931471803691238, 1.9082149292705877e-10  # high: 32 bits, so k * high is exact for k < 2**21
_LOG2_E = 1.4426950408889634
_PI_HIGH, _PI_LOW = 3.1415926534682512, 1.2154201013012384e-10  # high: 32 bits
_ONE_OVER_PI = 0.3183098861837907
_BELOW_ONE = 1.0 - 2.0**-53

# (expm1(r) - r)/r**2: on [-ln2/2, ln2/2], error of exp 4e-18; and on [-ln(4/3), ln(3/2)], of expm1 2e-17, relative.
_EXP = (
    0.5000000000000012,
    0.166666666666667,
    0.041666666666515535,
    0.008333333333307229,
    0.001388888894698169,
    0.00019841269917335243,
    2.4801489980598028e-05,
    2.755721634223376e-06,
    2.763126570919476e-07,
    2.5117848389313583e-08,
)
_EXPM1 = (
    0.4999999999999999,
    0.16666666666667324,
    0.041666666666691804,
    0.008333333332653759,
    0.001388888888090004,
    0.00019841272093146188,
    2.4801585433711727e-05,
    2.7554295469915115e-06,
    2.7584384562680177e-07,
    2.649555655371121e-08,
)
# In z = r**2 on [0, (pi/2)**2]: (sin(r) - r)/r**3, error of sin 2e-19, and (cos(r) - 1 + z/2)/z**2, of cos 6e-18.
_SIN = (
    -0.16666666666666666,
    0.008333333333333212,
    -0.00019841269841215352,
    2.755731921214361e-06,
    -2.5052106961290822e-08,
    1.6058943987721576e-10,
    -7.643098978461492e-13,
    2.7222687618561966e-15,
)
_COS = (
    0.04166666666666583,
    -0.001388888888883005,
    2.4801587285783923e-05,
    -2.7557317068512745e-07,
    2.087659259260441e-09,
    -1.1463635440086631e-11,
    4.616135077009849e-14,
)
# log((1 + s)/(1 - s)) = 2 s + s R(s**2), of fdlibm's e_log.c (Sun Microsystems, 1993).
_LOG = (
    0.6666666666666735,
    0.3999999999940942,
    0.2857142874366239,
    0.22222198432149784,
    0.1818357216161805,
    0.15313837699209373,
    0.14798198605116586,
)
# (a, b, c, n) with ((a*k + b)**2 + c)**(2**n) strictly inside one octave for every integer k of the range.
_FROM_MINUS_1021 = (5.9814909079623564e-05, 0.7079209871015584, 0.49880732972663083, 13)  # (2**(k-1), 2**k), k <= 1024
_FROM_MINUS_72 = (0.00012453944236091613, 0.6778441607144275, 0.540442055763247, 12)  # (2**(k-1), 2**k), k <= 1024
_FROM_0_TO_55 = (0.03602643452295455, 0.782986317026327, 2.531945514966581, 5)  # (2**(k+52), 2**(k+53))


def _arithmetic(function: Callable) -> Callable:
    """Let a function of CasADi expressions take floats and NumPy arrays too, as float64 and without warnings."""

    @wraps(function)
    def either(*arguments):
        if any(isinstance(a, _SYMBOLIC) for a in arguments):
            return function(*arguments)
        with np.errstate(all="ignore"):
            result = np.asarray(function(*(np.asarray(a, dtype=np.float64) for a in arguments)))
        return result if result.ndim else float(result)

    return either


def _floor(x):
    return ca.floor(x) if isinstance(x, _SYMBOLIC) else np.floor(x)


def _sqrt(x):
    return ca.sqrt(x) if isinstance(x, _SYMBOLIC) else np.sqrt(x)


def _less(a, b):
    """1 where a < b, else 0 (also where one is NaN)."""
    return a < b if isinstance(a, _SYMBOLIC) or isinstance(b, _SYMBOLIC) else np.less(a, b) * 1.0


def _no(condition):
    return ca.logic_not(condition) if isinstance(condition, _SYMBOLIC) else np.equal(condition, 0) * 1.0


def _only(condition, x):
    """x where the condition holds, else +0, whatever x is there."""
    if isinstance(condition, _SYMBOLIC) or isinstance(x, _SYMBOLIC):
        return ca.if_else(condition, x, 0)
    return np.where(condition, x, 0.0)


def _polynomial(coefficients, x):
    """Horner's rule, lowest coefficient first."""
    value = coefficients[-1]
    for coefficient in coefficients[-2::-1]:
        value = value * x + coefficient
    return value


def _power_of_two(k, rough):
    """2**(m - 52) exactly, where the rough value of the integer k lies strictly inside (2**m, 2**(m+1))."""
    a, b, c, squarings = rough
    y = square(k * a + b) + c
    for _ in range(squarings):
        y = square(y)
    return y - y * _BELOW_ONE


@_arithmetic
def square(x):
    """x*x."""
    return x * x


@_arithmetic
def absolute(x):
    """|x|."""
    return ca.fabs(x) if isinstance(x, _SYMBOLIC) else np.fabs(x)


@_arithmetic
def minimum(a, b):
    """The lesser operand; a NaN operand is ignored, and of equal operands the first is returned."""
    if isinstance(a, _SYMBOLIC) or isinstance(b, _SYMBOLIC):
        return ca.fmin(a, b)
    return np.where((a <= b) | np.isnan(b), a, b)


@_arithmetic
def maximum(a, b):
    """The greater operand; a NaN operand is ignored, and of equal operands the first is returned."""
    if isinstance(a, _SYMBOLIC) or isinstance(b, _SYMBOLIC):
        return ca.fmax(a, b)
    return np.where((a >= b) | np.isnan(b), a, b)


@_arithmetic
def clip(x, low, high):
    """minimum(maximum(x, low), high); NaN becomes `low`."""
    return minimum(maximum(x, low), high)


@_arithmetic
def sign0(x):
    """(x > 0) - (x < 0): -1, 0 or 1; 0 at zero and for NaN."""
    return _less(0.0, x) - _less(x, 0.0)


@_arithmetic
def where(condition, a, b):
    """a where the condition is not 0, else b. The value of the other one, infinite or NaN, does not enter.

    In a derivative it does: there 0 times an infinite or NaN derivative of the other one is NaN.
    """
    return _only(condition, a) + _only(_no(condition), b)


@_arithmetic
def exp(x):
    """e**x = 2**k * e**r, k = floor(x/ln2 + 1/2); at most 2 ulp. 0 below -708; infinite where it overflows (709.78)."""
    enough = _no(_less(x, -708.0))
    x = _only(enough, x)
    k = _floor(minimum((x + 0.34657359027997) * _LOG2_E, 1024.5))
    r = x - k * _LN2_HIGH - k * _LN2_LOW
    p = 1.0 + (r + square(r) * _polynomial(_EXP, r))
    # The power is 2**(k - 53): for k = 1024, 2**k itself would overflow.
    return _only(enough, p * 2.0**53 * _power_of_two(k, _FROM_MINUS_1021))


@_arithmetic
def expm1(x):
    """e**x - 1 = (2**k - 1) + 2**k * expm1(r), r in [-ln(4/3), ln(3/2)]; at most 2 ulp. -1 below -45; infinite from 709.78.

    With r from -ln2/2, 2*expm1(r) + 1 would cancel more; from -ln(4/3) on, no term is finer than the result by a bit.
    """
    low = _less(x, -45.0)
    x = _only(_no(low), x)
    k = _floor(minimum((x + 0.28768207245178) * _LOG2_E, 1024.5))
    r = x - k * _LN2_HIGH - k * _LN2_LOW
    half = _power_of_two(k, _FROM_MINUS_72) * 2.0**52
    small = r + square(r) * _polynomial(_EXPM1, r)
    return 2.0 * (half * small + (half - 0.5)) - low


@_arithmetic
def tanh(x):
    """E/(E + 2) with E = expm1(2|x|), and the sign of x; at most 2 ulp. +-1 from |x| = 19.0625."""
    a = absolute(x)
    high = _less(19.0625, a)
    a = _only(_no(high), a)
    k = _floor((a + 0.14384103622589) * (2.0 * _LOG2_E))
    r = 2.0 * a - k * _LN2_HIGH - k * _LN2_LOW
    power = _power_of_two(k, _FROM_0_TO_55)
    e = power * (r + square(r) * _polynomial(_EXPM1, r)) + (power - 1.0)
    return (e / (e + 2.0) + high) * (1.0 - 2.0 * _less(x, 0.0))


def _half_turns(x):
    """(r, sign): x = n*pi + r with r in [-pi/2, pi/2], and (-1)**n."""
    n = _floor((x + 1.57079632679489) * _ONE_OVER_PI)
    r = x - n * _PI_HIGH - n * _PI_LOW
    return r, 1.0 - 2.0 * (n - 2.0 * _floor(0.5 * n))


@_arithmetic
def sin(x):
    """sin(x) by reduction to [-pi/2, pi/2]; absolute error below 2.3e-16 for |x| <= 1e5 (the reduction: to 6e6)."""
    r, sign = _half_turns(x)
    z = square(r)
    return sign * (r + r * z * _polynomial(_SIN, z))


@_arithmetic
def cos(x):
    """cos(x) by reduction to [-pi/2, pi/2]; absolute error below 2.3e-16 for |x| <= 1e5. The reduction is that of sin(x)."""
    r, sign = _half_turns(x)
    z = square(r)
    return sign * (1.0 - 0.5 * z + square(z) * _polynomial(_COS, z))


@_arithmetic
def log(x):
    """log(x) = e*ln2 + log(m), m in [0.707, 1.414], as fdlibm does; at most 2 ulp for 1e-300 <= x. NaN if x <= 0 or inf.

    The exponent e is rounded from a rough logarithm of the power of two: ten square roots bring that to [1/2, 2].
    """
    # x*2**-53 is between half an ulp and one: the bracket is the next double below, and the difference one ulp of x.
    two_to_e = (x - (x - x * 2.0**-53)) * 2.0**52
    m = x / two_to_e  # in (1, 2]
    root = two_to_e
    for _ in range(10):
        root = _sqrt(root)
    t = (root - 1.0) / (root + 1.0)
    e = _floor(t * (2951.4972777724865 + 1084.1655571878018 * square(t)) + 0.5)
    large = _less(1.4142135623730951, m)
    e = e + large
    f = m - 0.5 * m * large - 1.0
    s = f / (2.0 + f)
    z = square(s)
    h = 0.5 * square(f)
    return e * _LN2_HIGH - ((h - (s * (h + z * _polynomial(_LOG, z)) + e * _LN2_LOW)) - f)


@_arithmetic
def power(x, y):
    """x**y = exp(y*log(x)) for x >= 0; relative error 1e-14 while |y*log(x)| <= 30. 0 where x <= 0."""
    none = x <= 0.0 if isinstance(x, _SYMBOLIC) else np.less_equal(x, 0.0) * 1.0
    return _only(_no(none), exp(y * log(x + none)))
