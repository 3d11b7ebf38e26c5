"""Functions of generated kernels whose text becomes LLVM instructions as it is written (see `workbench.kernel.instructions`).

Numba analyses every name of what it compiles: of a kernel of some thousand lines that takes four fifths of the time. Generated text needs no
analysis. A straight function is lines of arithmetic, for one lane or for several side by side: then an instruction is one of vectors, and no
compiler has to find out that it might be. A looped one is the loops about them (see `workbench.kernel.loops`). Numba compiles what calls it.
"""

import ast
import inspect
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from workbench.kernel.instructions import DOUBLE, Array, Lines
from workbench.kernel.loops import Loops


@dataclass(frozen=True, eq=False)
class Text:
    """A function as it is written. width: lanes that it is for, side by side."""

    function: Callable
    width: int

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        return tuple(inspect.signature(self.function).parameters)

    @cached_property
    def body(self) -> list[ast.stmt]:
        return ast.parse(inspect.getsource(self.function)).body[0].body

    def within(self, builder: ir.IRBuilder, arguments) -> list:
        """Write the lines with values for its parameters; return what it returns."""
        lines = Lines(builder, self.width, dict(zip(self.parameters, arguments, strict=True)))
        for line in self.body:
            lines.write(line)
        return lines.returned

    def looped(self, builder: ir.IRBuilder, arguments) -> list:
        """Write the loops with values for its parameters. The straight functions of the same module may be called."""
        called = {
            n: f.text.within for n, f in self.function.__globals__.items() if isinstance(getattr(f, "text", None), Text)
        }
        Loops(builder, dict(zip(self.parameters, arguments, strict=True)), self.body, called)
        return []


def abreast(width: int):
    """Return what makes a function straight (see there) for `width` neighbouring lanes at once.

    What is read or written at an index that holds the argument `lane` is one element a lane, from that on; every other value is one, for all.
    """
    return partial(straight, width=width)


def straight(function: Callable, width: int = 1):
    """Return a function for code that numba compiles, whose instructions are the lines of this one's text, in their order.

    Arguments: floats, integers, arrays of them (contiguous, one or two axes), tuples of floats. Each line gives a new name, or an
    array's element, the value of an expression of `workbench.kernel.instructions`. The last line may return a tuple of floats.
    """
    text = Text(function, width)
    return _compiled(text, text.within)


def looped(function: Callable):
    """Return a function for code that numba compiles, whose instructions are the loops, branches and lines of this one's text.

    Arguments as of a straight function, of which it may call those of its module; it returns nothing. See `workbench.kernel.loops`.
    """
    text = Text(function, 1)
    return _compiled(text, text.looped)


def _compiled(text: Text, write: Callable[[ir.IRBuilder, list], list]):
    """Return a function for code that numba compiles, of which `write` writes the instructions."""

    def typed(typing, *arguments):
        last = text.body[-1]
        out = types.UniTuple(types.float64, len(last.value.elts)) if isinstance(last, ast.Return) else types.void

        def code(context, builder, signature, values):
            returned = write(
                builder, [_taken(context, builder, *each) for each in zip(signature.args, values, strict=True)]
            )
            if signature.return_type == types.void:
                return context.get_dummy_value()
            whole = ir.Constant(ir.ArrayType(DOUBLE, len(returned)), ir.Undefined)
            for k, value in enumerate(returned):
                whole = builder.insert_value(whole, value, k)
            return whole

        return out(*arguments), code

    typed.__name__, typed.text = text.function.__name__, text
    first = next(iter(inspect.signature(typed).parameters.values()))
    typed.__signature__ = inspect.Signature([first, *inspect.signature(text.function).parameters.values()])
    return intrinsic(typed)


def _taken(context, builder, kind, value):
    """Return an argument of a numba type as lines know it."""
    if isinstance(kind, types.BaseTuple):
        return [builder.extract_value(value, k) for k in range(kind.count)]
    if not isinstance(kind, types.Array):
        return value
    array = context.make_array(kind)(context, builder, value)
    return Array(array.data, builder.extract_value(array.shape, kind.ndim - 1))
