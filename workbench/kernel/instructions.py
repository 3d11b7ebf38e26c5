"""The lines of a generated function, put into LLVM instructions one by one as they are written.

A straight line has nothing to analyse: each name is given a value once, and each operation is one instruction, which no compiler may reorder
or contract. Integers have 64 bits and wrap; `//`, `%` and `>>` are only ever of numbers that are not negative, by such that are positive (where
the bits of a float or of noise are shifted, `>>` brings in zeros, as for numbers without sign). Indices are not checked, and count from zero.
"""

import ast
from typing import NamedTuple

from llvmlite import ir
from numba.core import cgutils

DOUBLE, WHOLE, INDEX = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
ELEMENT_BYTES = 8  # to which elements of arrays are aligned
LANE = "lane"  # the argument that says which of several lanes is the first
COMPARED = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="}
FLOATS = {ast.Add: "fadd", ast.Sub: "fsub", ast.Mult: "fmul", ast.Div: "fdiv"}
INTEGERS = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.FloorDiv: "udiv", ast.Mod: "urem"}
INTEGERS |= {ast.RShift: "lshr", ast.BitAnd: "and_", ast.BitOr: "or_", ast.BitXor: "xor"}
FUNCTIONS = {"sqrt": "llvm.sqrt", "fabs": "llvm.fabs", "floor": "llvm.floor"}
NUMBERS = {"INF": float("inf"), "NAN": float("nan")}


class Array(NamedTuple):
    """A contiguous array of one or two axes. data: pointer to its first element; across: length of its last axis."""

    data: ir.Value
    across: ir.Value


class Lines:
    """Lines of a function, written as instructions. known: name -> LLVM value, Array, or a tuple's list of values.

    width: lanes side by side. Where there are several, an array's index that holds `lane` stands for one element a lane, neighbours
    from that on; what is computed of such is one value a lane, and every other value one for all. spread: such values -> as many as lanes.
    """

    def __init__(self, builder: ir.IRBuilder, width: int, given: dict):
        self.builder, self.width = builder, width
        self.known = {n: ir.Constant(DOUBLE, x) for n, x in NUMBERS.items()} | given
        self.spread = {}
        self.beginning = False  # whether `lane` is now the first of the lanes, not one value a lane
        self.returned: list = []

    def write(self, line: ast.stmt) -> None:
        if isinstance(line, ast.Return):
            self.returned = self.value(line.value)
            return
        (target,) = line.targets
        self.assign(target, self.value(line.value))

    def assign(self, target: ast.expr, value) -> None:
        if isinstance(target, ast.Subscript):
            (value,) = self.alike([value], self._neighbours(target))
            self.builder.store(value, self._place(target)).align = ELEMENT_BYTES
        else:
            self.known[target.id] = value

    def alike(self, values: list, wide: bool = False) -> list:
        """Return values of which all are one a lane where any is, or where that is asked for."""
        if not (wide or any(map(_is_wide, values))):
            return values
        return [v if _is_wide(v) else self._spread(v) for v in values]

    def _spread(self, value):
        """Return one value for all lanes as one a lane."""
        wide = ir.VectorType(value.type, self.width)
        if isinstance(value, ir.Constant):
            return ir.Constant(wide, [value] * self.width)
        if value not in self.spread:
            nothing = ir.Constant(wide, ir.Undefined)
            first = self.builder.insert_element(nothing, value, ir.Constant(INDEX, 0))
            zeros = ir.Constant(ir.VectorType(INDEX, self.width), [0] * self.width)
            self.spread[value] = self.builder.shuffle_vector(first, nothing, zeros)
        return self.spread[value]

    def _neighbours(self, node: ast.Subscript) -> bool:
        """Whether a subscript stands for one element a lane, each beside the one before."""
        names = {n.id for n in ast.walk(node.slice) if isinstance(n, ast.Name)}
        return self.width > 1 and LANE in names and not any(_is_wide(self.known[n]) for n in names)

    def _place(self, node: ast.Subscript, at=None):
        """Return the pointer to an array's element, or to those of neighbouring lanes."""
        data, _ = self.known[node.value.id]
        several = self._neighbours(node)
        at = self._index(node) if at is None else at
        place = self.builder.gep(data, [at], inbounds=True)
        return (
            self.builder.bitcast(place, ir.VectorType(data.type.pointee, self.width).as_pointer()) if several else place
        )

    def _index(self, node: ast.Subscript):
        """Return which element a subscript stands for: of neighbours the first, of others one a lane where they differ."""
        self.beginning = self._neighbours(node)
        if isinstance(node.slice, ast.Tuple):
            row, column = map(self.value, node.slice.elts)
            at = self.builder.add(self.builder.mul(row, self.known[node.value.id].across), column)
        else:
            at = self.value(node.slice)
        self.beginning = False
        return at

    def _load(self, node: ast.Subscript):
        at = self._index(node)
        if not _is_wide(at):
            return self._element(self._place(node, at))
        found = ir.Constant(ir.VectorType(self.known[node.value.id].data.type.pointee, self.width), ir.Undefined)
        for lane in range(self.width):
            number = ir.Constant(INDEX, lane)
            one = self._element(self._place(node, self.builder.extract_element(at, number)))
            found = self.builder.insert_element(found, one, number)
        return found

    def _element(self, place):
        element = self.builder.load(place)
        element.align = ELEMENT_BYTES
        return element

    def _lanes(self):
        """Return the numbers of the lanes, one a lane."""
        ahead = ir.Constant(ir.VectorType(WHOLE, self.width), list(range(self.width)))
        return self.builder.add(self._spread(self.known[LANE]), ahead)

    def value(self, node: ast.expr):
        """Return the LLVM value of an expression."""
        match node:
            case ast.Name(id=name):
                return self._lanes() if name == LANE and self.width > 1 and not self.beginning else self.read(name)
            case ast.Constant(value=float()):
                return ir.Constant(DOUBLE, node.value)
            case ast.Constant(value=int()):
                return ir.Constant(
                    WHOLE, node.value - (node.value >> 63 << 64)
                )  # as a number with sign, of the same bits
            case ast.Attribute(attr="size") | ast.Subscript(value=ast.Attribute(attr="shape")):
                return self._length(node)
            case ast.Subscript():
                known = self.read(node.value.id)
                return self._load(node) if isinstance(known, Array) else known[node.slice.value]
            case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=float())):
                return ir.Constant(DOUBLE, -node.operand.value)
            case ast.UnaryOp(op=ast.USub()):
                return self.builder.fneg(self.value(node.operand))
            case ast.BinOp():
                return self._combined(node)
            case ast.Compare():
                return self._compared(node)
            case ast.Call():
                return self.called(node)
            case ast.Tuple():
                return [self.value(v) for v in node.elts]
        raise _unknown(node)

    def read(self, name: str):
        return self.known[name]

    def _length(self, node):
        """Return the length of the last axis of an array: `a.size` of one axis, `a.shape[1]` of two."""
        named = node.value if isinstance(node, ast.Attribute) else node.value.value
        return self.known[named.id].across

    def _combined(self, node: ast.BinOp):
        left, right = self.alike([self.value(node.left), self.value(node.right)])
        names = FLOATS if _of(left) == DOUBLE else INTEGERS
        if type(node.op) not in names or _of(left) != _of(right):
            raise _unknown(node)
        return getattr(self.builder, names[type(node.op)])(left, right)

    def _compared(self, node: ast.Compare):
        sign = COMPARED[type(node.ops[0])]
        left, right = self.alike([self.value(node.left), self.value(node.comparators[0])])
        if _of(left) != DOUBLE:
            return self.builder.icmp_signed(sign, left, right)
        of = self.builder.fcmp_unordered if sign == "!=" else self.builder.fcmp_ordered
        return of(sign, left, right)

    def called(self, node: ast.Call):
        values = [self.value(a) for a in node.args]
        match node.func.id, values:
            case "select", (condition, *chosen):
                return self.builder.select(condition, *self.alike(chosen, _is_wide(condition)))
            case "branch", (condition, a, b):
                return _branched(self.builder, condition, a, b)
            case "float", (value,):
                return self.builder.sitofp(value, _like(value, DOUBLE))
            case "bits", (value,):
                return self.builder.bitcast(value, _like(value, WHOLE))
            case "uint64", (value,):  # whether bits have a sign is a matter of what is done with them
                return value
        if node.func.id not in FUNCTIONS:
            raise _unknown(node)
        (value,) = values
        suffix = f"v{self.width}f64" if _is_wide(value) else "f64"
        kind = ir.FunctionType(value.type, [value.type])
        name = f"{FUNCTIONS[node.func.id]}.{suffix}"
        return self.builder.call(cgutils.get_or_insert_function(self.builder.module, kind, name), values)


def _is_wide(value) -> bool:
    return isinstance(value, ir.Value) and isinstance(value.type, ir.VectorType)


def _of(value) -> ir.Type:
    """Return the type of a value in one lane."""
    return value.type.element if _is_wide(value) else value.type


def _like(value, kind: ir.Type) -> ir.Type:
    """Return a type for as many lanes as a value has."""
    return ir.VectorType(kind, value.type.count) if _is_wide(value) else kind


def _unknown(node: ast.AST) -> TypeError:
    return TypeError(f"a straight line holds {ast.unparse(node)}, for which there is no instruction")


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
