"""The operations that elementary functions are made of, each for CasADi expressions and for NumPy arrays.

Every one is exact or correctly rounded by IEEE 754, and picks its NumPy or CasADi form by the type of its operands.
"""

from collections.abc import Callable
from functools import wraps

import casadi as ca
import numpy as np

SYMBOLIC = (ca.SX, ca.MX, ca.DM)
BELOW_ONE = 1.0 - 2.0**-53

# (a, b, c, n) with ((a*k + b)**2 + c)**(2**n) strictly inside one octave for every integer k of the range: a minimax
# fit of 2**((j + 1/2)/2**n), where j is the exponent at which that octave begins. A longer range takes more squarings.
FROM_MINUS_1021 = (5.9814909079623564e-05, 0.7079209871015584, 0.49880732972663083, 13)  # j = k - 1, to k = 1024
FROM_MINUS_72 = (0.00012453944236091613, 0.6778441607144275, 0.540442055763247, 12)  # j = k - 1, to k = 1024
FOURS = (0.07092020715034542, 0.7844981474966605, 2.4607836406013117, 5)  # j = 2*k + 51, from k = 0 to 27


def arithmetic(function: Callable) -> Callable:
    """Let a function of CasADi expressions take floats and NumPy arrays too, as float64 and without warnings."""

    @wraps(function)
    def either(*arguments):
        if symbolic(*arguments):
            return function(*arguments)
        with np.errstate(all="ignore"):
            result = np.asarray(function(*(np.asarray(a, dtype=np.float64) for a in arguments)))
        return result if result.ndim else float(result)

    return either


def symbolic(*arguments) -> bool:
    return any(isinstance(a, SYMBOLIC) for a in arguments)


def floor(x):
    return ca.floor(x) if symbolic(x) else np.floor(x)


def sqrt(x):
    return ca.sqrt(x) if symbolic(x) else np.sqrt(x)


def less(a, b):
    """1 where a < b, else 0 (also where one is NaN)."""
    return a < b if symbolic(a, b) else np.less(a, b) * 1.0


def less_equal(a, b):
    """1 where a <= b, else 0 (also where one is NaN)."""
    return a <= b if symbolic(a, b) else np.less_equal(a, b) * 1.0


def no(condition):
    """1 where the condition is 0, else 0: no(less(x, c)) holds for NaN."""
    return ca.logic_not(condition) if symbolic(condition) else np.equal(condition, 0.0) * 1.0


def only(condition, x):
    """x where the condition is not 0, else +0, whatever x is there."""
    return ca.if_else(condition, x, 0) if symbolic(condition, x) else np.where(condition, x, 0.0)


def polynomial(coefficients: tuple[float, ...], x):
    """Horner's rule, lowest coefficient first."""
    value = coefficients[-1]
    for coefficient in coefficients[-2::-1]:
        value = value * x + coefficient
    return value


def power_of_two(k, rough: tuple[float, float, float, int]):
    """2**(j - 52) exactly, for the integer k of a range above: the unit in the last place of the rough value."""
    a, b, c, squarings = rough
    y = k * a + b
    y = y * y + c
    for _ in range(squarings):
        y = y * y
    return y - y * BELOW_ONE
