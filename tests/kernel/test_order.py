"""The order of a program's lines: operands before what needs them, and what is waited for longest first."""

import casadi as ca
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.kernel.arrays import evaluate
from workbench.kernel.choice import with_choices
from workbench.kernel.order import by_latency
from workbench.kernel.program import read


def a_program(draw_from: list[int]):
    """Return a program of two inputs whose lines take operands as these numbers say."""
    x = ca.SX.sym("x", 2)
    known = [x[0], x[1], x[0] + 1.0]
    for n in draw_from:
        a, b = known[n % len(known)], known[(n // 7) % len(known)]
        known.append([a + b, a * b, a / (1.0 + b * b), ca.fmin(a, b), ca.if_else(a < b, a, b), ca.floor(a)][n % 6])
    return with_choices(read(ca.Function("any", [x], [ca.vertcat(*known[-4:])]).expand()))


@settings(deadline=None)
@given(st.lists(st.integers(0, 10_000), min_size=1, max_size=40))
def test_another_order_holds_the_same_lines_after_their_operands_and_gives_the_same_bits(draw_from):
    program = a_program(draw_from)
    made = by_latency(program)
    assert sorted(made.lines, key=repr) == sorted(program.lines, key=repr)
    seen = set()
    for line in made.lines:
        assert not {name for name in line.operands if name.startswith("w")} - seen
        seen.add(line.out)
    x = np.array([0.3, -1.7])
    np.testing.assert_array_equal(evaluate(made, x)[0], evaluate(program, x)[0])


def test_a_long_way_begins_before_what_can_wait():
    x = ca.SX.sym("x", 3)
    short = x[0] + x[1]
    long = x[2]
    for _ in range(6):
        long = 1.0 / (1.0 + long)
    program = read(ca.Function("two", [x], [ca.vertcat(short, long)]).expand())
    begun = [line.operands for line in by_latency(program).lines]
    assert "i0_2" in begun[0], "the longer way's first line comes first, though the other was written before it"
    assert program.lines[0].operands == ("i0_0", "i0_1")
