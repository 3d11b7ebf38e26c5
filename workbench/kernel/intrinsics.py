"""Two operations that generated kernels use and Python has no branch-free word for.

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
