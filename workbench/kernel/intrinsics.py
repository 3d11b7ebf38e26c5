"""Operations that generated kernels use and Python has no branch-free word for.

They compile to one instruction each, so that a loop over lanes stays one straight block, which vectorises.
"""

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


@intrinsic
def select(typing, condition, a, b):
    """`a if condition else b` of two floats, both evaluated already."""

    def code(context, builder, signature, arguments):
        return builder.select(*arguments)

    return types.float64(types.boolean, types.float64, types.float64), code


@intrinsic
def bits(typing, x):
    """The 64 bits of a float, as an integer."""

    def code(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.IntType(64))

    return types.int64(types.float64), code


@intrinsic
def branch(typing, condition, a, b):
    """As `select`, with a hint that the condition is predictable, so that one lane branches and does not wait for it."""

    def code(context, builder, signature, arguments):
        condition, a, b = arguments
        before = builder.block
        seldom, after = builder.append_basic_block("seldom"), builder.append_basic_block("after")
        builder.cbranch(condition, seldom, after).set_weights([1, 2000])
        builder.position_at_end(seldom)
        builder.branch(after)
        builder.position_at_end(after)
        chosen = builder.phi(ir.DoubleType())
        chosen.add_incoming(a, seldom)
        chosen.add_incoming(b, before)
        return chosen

    return types.float64(types.boolean, types.float64, types.float64), code
