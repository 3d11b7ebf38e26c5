"""Elementary functions written from arithmetic alone, so that every evaluator agrees to the last bit.

Each function takes CasADi SX or MX and builds a graph of + - * /, fabs, sqrt, square, floor, fmin, fmax, comparisons
and if-else-zero only; floats and NumPy arrays go through the same operations in the same order. All of these are exact
or correctly rounded by IEEE 754, so CasADi, NumPy, numba and every machine return the same bits, as long as nothing
contracts a*b + c into a fused multiply-add. There is no branch and no library call, so loops over lanes vectorise.

Three devices take the place of the exponent field of a double:

- *Power of two*: for a rough value y strictly inside (2**j, 2**(j+1)), y - (1 - 2**-53)*y is exactly the unit in its
  last place, 2**(j - 52) (after Rump, Zimmermann, Boldo, Melquiond, "Computing predecessor and successor in rounding to
  nearest", BIT 49, 2009). For 2**k the rough value is a quadratic in k, squared again and again.
- *Argument reduction* with a constant in two parts, the first short enough for k * part to be exact (Cody & Waite,
  "Software Manual for the Elementary Functions", 1980).
- *Polynomials* are minimax fits (Remez) of what is left behind exact first terms.

CasADi rewrites c1*(c2*x) to (c1*c2)*x and (x - c) + c to x, which are other bits. An argument is therefore first met by
the addition of a constant that nobody else writes, or by a factor that is a power of two: then no rewriting matters.
Derivatives are right, since every step (k, the exponent of log) passes through floor or a comparison, whose derivative
is 0. Where the same argument goes to sin and cos, `casadi.cse` merges the reductions.

NaN: exp, expm1, tanh, sin, cos, log, power, square and absolute return NaN. minimum, maximum and clip ignore a NaN
operand; sign0 returns 0. The sign of a zero is not kept, except by square, absolute, minimum, maximum and clip.
"""

import casadi as ca
import numpy as np

from workbench.effects._arithmetic import (
    BELOW_ONE,
    FOURS,
    FROM_MINUS_72,
    FROM_MINUS_1021,
    arithmetic,
    floor,
    less,
    less_equal,
    no,
    only,
    polynomial,
    power_of_two,
    sqrt,
    symbolic,
)
from workbench.effects._coefficients import COS, EXP, LOG, SIN, TANH

__all__ = "absolute clip cos exp expm1 log maximum minimum power sign0 sin square tanh where".split()

_LN2_HIGH, _LN2_LOW = 0.6931471803691238, 1.9082149292705877e-10  # high: 32 bits, so k * high is exact for k < 2**21
_LOG2_E = 1.4426950408889634
_PI_HIGH, _PI_LOW = 3.1415926534682512, 1.2154201013012384e-10  # high: 32 bits
_ONE_OVER_PI = 0.3183098861837907


@arithmetic
def square(x):
    """x*x."""
    return x * x


@arithmetic
def absolute(x):
    """|x|."""
    return ca.fabs(x) if symbolic(x) else np.fabs(x)


@arithmetic
def minimum(a, b):
    """The lesser operand; a NaN operand is ignored, and of equal operands the first is returned."""
    if symbolic(a, b):
        return ca.fmin(a, b)
    return np.where((a <= b) | np.isnan(b), a, b)


@arithmetic
def maximum(a, b):
    """The greater operand; a NaN operand is ignored, and of equal operands the first is returned."""
    if symbolic(a, b):
        return ca.fmax(a, b)
    return np.where((a >= b) | np.isnan(b), a, b)


@arithmetic
def clip(x, low, high):
    """minimum(maximum(x, low), high); NaN becomes `low`."""
    return minimum(maximum(x, low), high)


@arithmetic
def sign0(x):
    """(x > 0) - (x < 0): -1, 0 or 1; 0 at zero and for NaN."""
    return less(0.0, x) - less(x, 0.0)


@arithmetic
def where(condition, a, b):
    """a where the condition is not 0, else b. The value of the other one, infinite or NaN, does not enter.

    In a derivative it does: there 0 times an infinite or NaN derivative of the other one is NaN.
    """
    return only(condition, a) + only(no(condition), b)


def _small(r):
    """expm1(r) = 2r/(r*coth(r/2) - r) for |r| <= ln(3/2): the division halves the polynomial (as fdlibm's e_exp.c)."""
    z = square(r)
    return 2.0 * r / (2.0 + (z * polynomial(EXP, z) - r))


@arithmetic
def exp(x):
    """e**x = 2**k * e**r, k = floor(x/ln2 + 1/2), by Cody & Waite; at most 2 ulp (1.2 measured).

    0 below -708; infinite where it overflows (709.78). NaN for infinity itself.
    """
    enough = no(less(x, -708.0))
    x = only(enough, x)
    k = floor(minimum((x + 0.34657359027997) * _LOG2_E, 1024.5))
    r = x - k * _LN2_HIGH - k * _LN2_LOW
    # The power is 2**(k - 53): for k = 1024, 2**k itself would overflow.
    return only(enough, (1.0 + _small(r)) * 2.0**53 * power_of_two(k, FROM_MINUS_1021))


@arithmetic
def expm1(x):
    """e**x - 1 = (2**k - 1) + 2**k * expm1(r), r in [-ln(4/3), ln(3/2)]; at most 2 ulp (1.6 measured).

    -1 below -45; infinite where it overflows (709.78), NaN for infinity itself. With r from -ln2/2, 2*expm1(r) + 1
    would cancel more; from -ln(4/3) on, no term is coarser than the result by more than a bit.
    """
    low = less(x, -45.0)
    x = only(no(low), x)
    k = floor(minimum((x + 0.28768207245178) * _LOG2_E, 1024.5))
    r = x - k * _LN2_HIGH - k * _LN2_LOW
    half = power_of_two(k, FROM_MINUS_72) * 2.0**52
    return 2.0 * (half * _small(r) + (half - 0.5)) - low


@arithmetic
def tanh(x):
    """(e**2x - 1)/(e**2x + 1), for |x| = k*ln2 + r with r in [-0.093, 0.6]; at most 2 ulp (1.6 measured).

    With D = r*coth(r), tanh|x| = r/D for k = 0, else 1 - (D - r)/(D + h(D + r)) with h = (4**k - 1)/2: from tanh = 0.54
    on, the subtraction shrinks the error of the quotient. +-1 beyond |x| = 19.0625.
    """
    # Not absolute(x): its derivative at 0 is 0.
    sign = 1.0 - 2.0 * less(x, 0.0)
    a = x * sign
    high = less(19.0625, a)
    a = only(no(high), a)
    k = floor((a + 0.09314718055991) * _LOG2_E)
    r = a - k * _LN2_HIGH - k * _LN2_LOW
    z = square(r)
    d = 1.0 + z * polynomial(TANH, z)
    h = power_of_two(k, FOURS) - 0.5
    one = less(0.0, k)
    return (one + (r - one * d) / (d + h * (d + r)) + high) * sign


def _half_turns(x):
    """(r, sign): x = n*pi + r with r in [-pi/2, pi/2], and (-1)**n."""
    n = floor((x + 1.57079632679489) * _ONE_OVER_PI)
    r = x - n * _PI_HIGH - n * _PI_LOW
    return r, 1.0 - 2.0 * (n - 2.0 * floor(0.5 * n))


@arithmetic
def sin(x):
    """sin(x) = (-1)**n sin(x - n*pi), by Cody & Waite; for |x| <= 1e5, absolute error below 2.3e-16 (2.0e-16 measured).

    Within |x| <= pi/2, 2 ulp. Two parts of pi suffice: n times the second is rounded at 2**-65 up to |x| = 6e6.
    """
    r, sign = _half_turns(x)
    z = square(r)
    return sign * (r + r * z * polynomial(SIN, z))


@arithmetic
def cos(x):
    """cos(x) = (-1)**n cos(x - n*pi), by Cody & Waite; for |x| <= 1e5, absolute error below 2.5e-16 (2.3e-16 measured).

    The reduction is that of sin, to be shared; the price is that near its zeros the error is not relative.
    """
    r, sign = _half_turns(x)
    z = square(r)
    return sign * (1.0 - 0.5 * z + square(z) * polynomial(COS, z))


@arithmetic
def log(x):
    """log(x) = e*ln2 + log(m), m in [0.707, 1.414], as fdlibm; for x >= 1e-300 at most 2 ulp (0.82 measured).

    NaN for x <= 0 and for infinity.

    The exponent e is rounded from a rough logarithm of the power of two: ten square roots bring that to [1/2, 2].
    """
    y = x + x * 2.0**-60  # x itself, but CasADi does not look through a sum
    two_to_e = (y - y * BELOW_ONE) * 2.0**52
    # Of two_to_e and its inverse, one is a whole number and the other at most 1: the quotient of the two maxima is
    # two_to_e again, but floor has taken away the derivative that two_to_e seems to have.
    m = y / (maximum(floor(two_to_e), 1.0) / maximum(floor(1.0 / two_to_e), 1.0))  # in (1, 2]
    root = two_to_e
    for _ in range(10):
        root = sqrt(root)
    t = (root - 1.0) / (root + 1.0)
    e = floor(t * (2951.4972777724865 + 1084.1655571878018 * square(t)) + 0.5)
    large = less(1.4142135623730951, m)
    e = e + large
    f = m - 0.5 * m * large - 1.0
    s = f / (2.0 + f)
    z = square(s)
    h = 0.5 * square(f)
    return e * _LN2_HIGH - ((h - (s * (h + z * polynomial(LOG, z)) + e * _LN2_LOW)) - f)


@arithmetic
def power(x, y):
    """x**y = exp(y*log(x)) for x >= 1e-300; relative error 1e-14 while |y*log(x)| <= 40. 0 where x <= 0, whatever y."""
    none = less_equal(x, 0.0)
    return only(no(none), exp(y * log(x + none)))
