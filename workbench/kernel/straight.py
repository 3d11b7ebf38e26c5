"""Straight-line functions of generated kernels, put into LLVM instructions one by one as they are written.

Numba analyses every name of what it compiles: four fifths of the time that a kernel of some thousand lines takes. A straight line has nothing to
analyse: each name is given a value once, and each operation of `kernel.program.EXPRESSIONS` is one instruction. What numba then
compiles is the loops about it. Several lanes may be taken side by side: then an instruction is one of vectors, and no compiler has to find
out that it might be.
"""

import ast
import inspect
from collections.abc import Callable
from functools import lru_cache, partial

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

DOUBLE, WHOLE = ir.DoubleType(), ir.IntType(64)
DOUBLE_BYTES = 8  # to which rows of arrays are aligned
LANE = "lane"  # the argument that says which of several lanes is the first
COMPARED = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="}
FLOATS = {ast.Add: "fadd", ast.Sub: "fsub", ast.Mult: "fmul", ast.Div: "fdiv"}
INTEGERS = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.BitAnd: "and_", ast.BitOr: "or_"}
FUNCTIONS = {"sqrt": "llvm.sqrt", "fabs": "llvm.fabs", "floor": "llvm.floor"}
NUMBERS = {"INF": float("inf"), "NAN": float("nan")}


def abreast(width: int):
    """Return what makes a function straight (see there) for `width` neighbouring lanes at once.

    What is read or written at an index that holds the argument `lane` is one element a lane, from that on; every other value is one, for all.
    """
    return partial(straight, width=width)


def straight(function: Callable, width: int = 1):
    """Return a function for code that numba compiles, whose instructions are the lines of this one's text, in their order.

    Arguments: floats, integers, arrays of floats (contiguous, one or two axes), tuples of floats. Each line gives a new name, or an
    array's element, the value of an expression of the operations of `kernel.program`; indices are not checked, and count from zero.
    The last line may return a tuple of floats.
    """

    named = inspect.signature(function)

    @lru_cache(maxsize=1)
    def body() -> list[ast.stmt]:
        return ast.parse(inspect.getsource(function)).body[0].body

    def typed(typing, *arguments):
        last = body()[-1]
        returned = isinstance(last, ast.Return)
        out = types.UniTuple(types.float64, len(last.value.elts)) if returned else types.void

        def code(context, builder, signature, values):
            lines = _Lines(context, builder, width)
            for argument in zip(named.parameters, signature.args, values, strict=True):
                lines.take(*argument)
            for line in body():
                lines.write(line)
            return lines.returned if returned else context.get_dummy_value()

        return out(*arguments), code

    typed.__name__ = function.__name__
    typed.__signature__ = named.replace(
        parameters=[next(iter(inspect.signature(typed).parameters.values())), *named.parameters.values()]
    )
    return intrinsic(typed)


class _Lines:
    """Lines of a function, written as instructions. known: name -> LLVM value. arrays: name -> (pointer, length of a row).

    wide: the type of a value a lane, where there are several. spread: values that are one for all -> as many of them as lanes."""

    def __init__(self, context, builder, width: int):
        self.context, self.builder, self.width = context, builder, width
        self.wide = ir.VectorType(DOUBLE, width) if width > 1 else None
        self.spread = {}
        self.known = {n: ir.Constant(DOUBLE, x) for n, x in NUMBERS.items()}
        self.arrays = {}
        self.returned = None

    def take(self, name: str, kind, value) -> None:
        """Take in an argument of a numba type."""
        if not isinstance(kind, types.Array):
            self.known[name] = value
            return
        array = self.context.make_array(kind)(self.context, self.builder, value)
        self.arrays[name] = array.data, self.builder.extract_value(array.shape, kind.ndim - 1)

    def write(self, line: ast.stmt) -> None:
        if isinstance(line, ast.Return):
            values = [self.value(v) for v in line.value.elts]
            self.returned = ir.Constant(ir.ArrayType(DOUBLE, len(values)), ir.Undefined)
            for k, value in enumerate(values):
                self.returned = self.builder.insert_value(self.returned, value, k)
            return
        (target,) = line.targets
        value = self.value(line.value)
        if isinstance(target, ast.Subscript):
            place = self.place(target)
            (value,) = self.alike([value], self._is_wide(target))
            self.builder.store(value, place).align = DOUBLE_BYTES
        else:
            self.known[target.id] = value

    def place(self, node: ast.Subscript):
        """Return the pointer to an array's element, or to those of several lanes."""
        data, across = self.arrays[node.value.id]
        if isinstance(node.slice, ast.Tuple):
            row, column = map(self.value, node.slice.elts)
            at = self.builder.add(self.builder.mul(row, across), column)
        else:
            at = self.value(node.slice)
        place = self.builder.gep(data, [at], inbounds=True)
        return self.builder.bitcast(place, self.wide.as_pointer()) if self._is_wide(node) else place

    def _is_wide(self, node: ast.Subscript) -> bool:
        """Whether a subscript stands for one element a lane."""
        return self.wide is not None and any(isinstance(n, ast.Name) and n.id == LANE for n in ast.walk(node.slice))

    def alike(self, values: list, wide: bool = False) -> list:
        """Return values of which all are one a lane where any is, or where that is asked for."""
        if not (wide or any(isinstance(v.type, ir.VectorType) for v in values)):
            return values
        return [v if isinstance(v.type, ir.VectorType) else self._spread(v) for v in values]

    def _spread(self, value):
        """Return one value for all lanes as one a lane."""
        wide, index = ir.VectorType(value.type, self.width), ir.IntType(32)
        if isinstance(value, ir.Constant):
            return ir.Constant(wide, [value] * self.width)
        if value not in self.spread:
            nothing = ir.Constant(wide, ir.Undefined)
            first = self.builder.insert_element(nothing, value, ir.Constant(index, 0))
            zeros = ir.Constant(ir.VectorType(index, self.width), [0] * self.width)
            self.spread[value] = self.builder.shuffle_vector(first, nothing, zeros)
        return self.spread[value]

    def value(self, node: ast.expr):
        """Return the LLVM value of an expression."""
        match node:
            case ast.Name():
                return self.known[node.id]
            case ast.Constant(value=float()):
                return ir.Constant(DOUBLE, node.value)
            case ast.Constant(value=int()):
                return ir.Constant(WHOLE, node.value)
            case ast.Subscript():
                if node.value.id not in self.arrays:
                    return self.builder.extract_value(self.known[node.value.id], node.slice.value)
                element = self.builder.load(self.place(node))
                element.align = DOUBLE_BYTES
                return element
            case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=float())):
                return ir.Constant(DOUBLE, -node.operand.value)
            case ast.UnaryOp(op=ast.USub()):
                return self.builder.fneg(self.value(node.operand))
            case ast.BinOp(op=ast.Add() | ast.Sub() | ast.Mult() | ast.Div() | ast.BitAnd() | ast.BitOr()):
                left, right = self.alike([self.value(node.left), self.value(node.right)])
                names = FLOATS if left.type in (DOUBLE, self.wide) else INTEGERS
                return getattr(self.builder, names[type(node.op)])(left, right)
            case ast.Compare():
                return self.compared(node)
            case ast.Call():
                return self.called(node.func.id, [self.value(a) for a in node.args])
        raise TypeError(f"a straight line holds {ast.unparse(node)}, for which there is no instruction")

    def compared(self, node: ast.Compare):
        sign = COMPARED[type(node.ops[0])]
        left, right = self.alike([self.value(node.left), self.value(node.comparators[0])])
        of = self.builder.fcmp_unordered if sign == "!=" else self.builder.fcmp_ordered
        return of(sign, left, right)

    def called(self, name: str, values: list):
        if name == "select":
            condition, *values = values
            return self.builder.select(condition, *self.alike(values, isinstance(condition.type, ir.VectorType)))
        if name == "branch":
            return _branched(self.builder, *values)
        (value,) = values
        suffix = "f64" if value.type == DOUBLE else f"v{self.width}f64"
        kind = ir.FunctionType(value.type, [value.type])
        return self.builder.call(
            cgutils.get_or_insert_function(self.builder.module, kind, f"{FUNCTIONS[name]}.{suffix}"), values
        )


def _branched(builder, condition, a, b):
    """Write `a if condition else b` as a branch that is seldom taken, so that one lane goes on and does not wait for the condition."""
    before = builder.block
    seldom, after = builder.append_basic_block("seldom"), builder.append_basic_block("after")
    builder.cbranch(condition, seldom, after).set_weights([1, 2000])
    builder.position_at_end(seldom)
    builder.branch(after)
    builder.position_at_end(after)
    chosen = builder.phi(DOUBLE)
    chosen.add_incoming(a, seldom)
    chosen.add_incoming(b, before)
    return chosen
