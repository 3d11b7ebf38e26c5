"""An operation that generated kernels use and Python has no word for."""

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


@intrinsic
def bits(typing, x):
    """The 64 bits of a float, as an integer: one instruction, so that a loop over lanes stays one straight block, which vectorises."""

    def code(context, builder, signature, arguments):
        return builder.bitcast(arguments[0], ir.IntType(64))

    return types.int64(types.float64), code
