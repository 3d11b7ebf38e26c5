"""A CasADi SX function read as a list of scalar instructions.

CasADi keeps an SX function as a straight-line program; `read` turns it into data that the NumPy evaluation
(kernel.arrays) and the kernel writer (kernel.source) share, so that both do the same arithmetic in the same order.
"""

from dataclasses import dataclass
from functools import cached_property
from math import copysign

import casadi as ca

from workbench.errors import WorkbenchError

# operation -> Python expression over operands a and b. One table serves NumPy, numba and the tests, so no operation can
# mean two things. fmin and fmax: a NaN operand is ignored, of equal operands the first is returned (as CasADi does).
EXPRESSIONS = {
    ca.OP_ASSIGN: "{a}",
    ca.OP_ADD: "{a} + {b}",
    ca.OP_SUB: "{a} - {b}",
    ca.OP_MUL: "{a} * {b}",
    ca.OP_DIV: "{a} / {b}",
    ca.OP_NEG: "-{a}",
    ca.OP_SQ: "{a} * {a}",
    ca.OP_TWICE: "{a} + {a}",
    ca.OP_INV: "1.0 / {a}",
    ca.OP_SQRT: "sqrt({a})",
    ca.OP_FABS: "fabs({a})",
    ca.OP_FLOOR: "floor({a})",
    ca.OP_SIGN: "select({a} > 0.0, 1.0, 0.0) - select({a} < 0.0, 1.0, 0.0)",  # the slope of fabs
    ca.OP_LT: "select({a} < {b}, 1.0, 0.0)",
    ca.OP_LE: "select({a} <= {b}, 1.0, 0.0)",
    ca.OP_EQ: "select({a} == {b}, 1.0, 0.0)",
    ca.OP_NE: "select({a} != {b}, 1.0, 0.0)",
    ca.OP_NOT: "select({a} == 0.0, 1.0, 0.0)",
    ca.OP_AND: "select(({a} != 0.0) & ({b} != 0.0), 1.0, 0.0)",
    ca.OP_OR: "select(({a} != 0.0) | ({b} != 0.0), 1.0, 0.0)",
    ca.OP_IF_ELSE_ZERO: "select({a} != 0.0, {b}, 0.0)",
    ca.OP_FMIN: "select(({a} <= {b}) | ({b} != {b}), {a}, {b})",
    ca.OP_FMAX: "select(({a} >= {b}) | ({b} != {b}), {a}, {b})",
}


@dataclass(frozen=True)
class Line:
    """work[out] = expression of `op` over the operands' names, each "w<k>", "i<argument>_<element>" or a literal."""

    op: int
    out: str
    a: str
    b: str

    @property
    def operands(self) -> tuple[str, ...]:
        return self.a, self.b

    @property
    def text(self) -> str:
        return EXPRESSIONS[self.op].format(a=self.a, b=self.b)


@dataclass(frozen=True)
class Program:
    """Straight-line arithmetic.

    lines: in order; every name is assigned once. outputs: for each output of the function, a tuple of operand names.
    inputs: lengths of the input vectors.
    """

    name: str
    inputs: tuple[int, ...]
    lines: tuple[Line, ...]
    outputs: tuple[tuple[str, ...], ...]

    def __hash__(self) -> int:  # made once: what is kept under a program is looked up at every pass
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash((self.name, self.inputs, self.lines, self.outputs))


def _literal(value: float) -> str:
    """A float as source text that reads back to the same bits."""
    text = repr(abs(float(value)))
    text = {"inf": "INF", "nan": "NAN"}.get(text, text)
    return f"(-{text})" if copysign(1.0, value) < 0 else text


def read(function: ca.Function) -> Program:
    """Return the program of an expanded SX function; WorkbenchError where it holds an operation kernels may not hold."""
    lines: list[Line] = []
    names: dict[int, str] = {}  # work register -> the name that holds its present value
    outputs = [["0.0"] * function.nnz_out(i) for i in range(function.n_out())]
    for k in range(function.n_instructions()):
        op, into, out_of = function.instruction_id(k), function.instruction_output(k), function.instruction_input(k)
        if op == ca.OP_CONST:
            names[into[0]] = _literal(function.instruction_constant(k))
        elif op == ca.OP_INPUT:
            names[into[0]] = f"i{out_of[0]}_{out_of[1]}"
        elif op == ca.OP_OUTPUT:
            outputs[into[0]][into[1]] = names[out_of[0]]
        elif op in EXPRESSIONS:
            a = names[out_of[0]]
            b = names[out_of[1]] if len(out_of) > 1 else "0.0"
            name = f"w{len(lines)}"
            lines.append(Line(op, name, a, b))
            names[into[0]] = name
        else:
            raise WorkbenchError(
                f"'{function.name()}' holds an operation (CasADi number {op}) that kernels may not hold; "
                "write it with workbench.effects.elementary."
            )
    for i in range(function.n_in()):
        if function.nnz_in(i) != function.numel_in(i):
            raise WorkbenchError(f"'{function.name()}': input {i} is sparse; declare it dense.")
    for i in range(function.n_out()):
        if function.nnz_out(i) != function.numel_out(i):
            raise WorkbenchError(f"'{function.name()}': output {i} is sparse; densify it.")
    return Program(
        function.name(),
        tuple(function.numel_in(i) for i in range(function.n_in())),
        tuple(lines),
        tuple(tuple(o) for o in outputs),
    )
