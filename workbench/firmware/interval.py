"""Interval arithmetic over a program: where every value lies, whatever comes in within its bounds."""

from math import inf, sqrt

import casadi as ca

from workbench.errors import WorkbenchError
from workbench.kernel.choice import Choice
from workbench.kernel.program import Line

Interval = tuple[float, float]
TRUTH = {ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE, ca.OP_NOT, ca.OP_AND, ca.OP_OR}


def _product(a: Interval, b: Interval) -> Interval:
    corners = [x * y for x in a for y in b]
    return min(corners), max(corners)


def union(a: Interval, b: Interval) -> Interval:
    return min(a[0], b[0]), max(a[1], b[1])


def _quotient(a: Interval, b: Interval) -> Interval:
    if b[0] <= 0.0 <= b[1]:
        raise WorkbenchError("a value is divided by one that may be zero: fixed point cannot hold that.")
    return _product(a, (1.0 / b[1], 1.0 / b[0]))


def size(a: Interval) -> Interval:
    low, high = abs(a[0]), abs(a[1])
    return (0.0 if a[0] <= 0.0 <= a[1] else min(low, high)), max(low, high)


def of(line: Line, a: Interval, b: Interval) -> Interval:
    """Return the interval of a line's value from those of its operands (of a Choice: of its two values)."""
    if isinstance(line, Choice):
        return union(a, b)
    if line.op in TRUTH:
        return 0.0, 1.0
    plain = {
        ca.OP_ASSIGN: lambda: a,
        ca.OP_ADD: lambda: (a[0] + b[0], a[1] + b[1]),
        ca.OP_SUB: lambda: (a[0] - b[1], a[1] - b[0]),
        ca.OP_MUL: lambda: _product(a, b),
        ca.OP_DIV: lambda: _quotient(a, b),
        ca.OP_INV: lambda: _quotient((1.0, 1.0), a),
        ca.OP_NEG: lambda: (-a[1], -a[0]),
        ca.OP_SQ: lambda: _product(size(a), size(a)),
        ca.OP_TWICE: lambda: (2.0 * a[0], 2.0 * a[1]),
        ca.OP_FABS: lambda: size(a),
        ca.OP_SQRT: lambda: (sqrt(max(a[0], 0.0)), sqrt(max(a[1], 0.0))),
        ca.OP_IF_ELSE_ZERO: lambda: union(b, (0.0, 0.0)),
        ca.OP_FMIN: lambda: (min(a[0], b[0]), min(a[1], b[1])),
        ca.OP_FMAX: lambda: (max(a[0], b[0]), max(a[1], b[1])),
    }
    if line.op not in plain:
        raise WorkbenchError(f"fixed point does not know an operation of this law (CasADi number {line.op}).")
    found = plain[line.op]()
    if not all(-inf < x < inf for x in found):
        raise WorkbenchError("a value of this law has no bound: fixed point cannot hold it.")
    return found


def within(a: Interval, bound: Interval) -> Interval:
    """The part of an interval that a bound leaves."""
    return max(a[0], bound[0]), min(a[1], bound[1])
