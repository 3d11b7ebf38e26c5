"""A program as C99: the third writer of the instruction list, beside NumPy (kernel.arrays) and numba lanes.

Arithmetic and order are those of the list, so that float32 and float64 give the bits of kernel.single and kernel.arrays on
any machine whose compiler neither fuses nor reorders: -std=c99 -ffp-contract=off. What is used once stands where it is used,
so that a formula reads as one; conditions are conditions of C, and become 1 or 0 only where they are added or multiplied.
"""

from collections import Counter
from collections.abc import Mapping, Set
from dataclasses import dataclass

import casadi as ca
import numpy as np

from workbench.errors import WorkbenchError
from workbench.kernel.choice import Choice
from workbench.kernel.program import Line, Program

CONDITIONS = {
    ca.OP_LT: "({a} < {b})",
    ca.OP_LE: "({a} <= {b})",
    ca.OP_EQ: "({a} == {b})",
    ca.OP_NE: "({a} != {b})",
}
LOGIC = {ca.OP_NOT: "(!{a})", ca.OP_AND: "({a} && {b})", ca.OP_OR: "({a} || {b})"}
VALUES = {
    ca.OP_ASSIGN: "{a}",
    ca.OP_ADD: "({a} + {b})",
    ca.OP_SUB: "({a} - {b})",
    ca.OP_MUL: "({a} * {b})",
    ca.OP_DIV: "({a} / {b})",
    ca.OP_NEG: "(-{a})",
    ca.OP_SQRT: "wb_sqrt{s}({a})",
    ca.OP_FABS: "wb_abs{s}({a})",
    ca.OP_FLOOR: "wb_floor{s}({a})",
    ca.OP_FMIN: "wb_min{s}({a}, {b})",
    ca.OP_FMAX: "wb_max{s}({a}, {b})",
}
SURE = {ca.OP_FMIN: "wb_low", ca.OP_FMAX: "wb_high"}  # beside an operand that is a number for certain
TWICE = {ca.OP_SQ: "({a} * {a})", ca.OP_TWICE: "({a} + {a})"}  # an operand that is written twice is not written out
LONGEST = 84  # characters of an expression that is still put into another


@dataclass(frozen=True)
class Text:
    """C text of one value. condition: it is one of C, 0 or 1, and no number."""

    text: str
    condition: bool = False


def _operands(line: Line) -> tuple[str, ...]:
    """Names that a line reads."""
    if isinstance(line, Choice):
        return (line.condition, line.a, line.b)
    return (line.a,) if line.op in UNARY else (line.a, line.b)


UNARY = {ca.OP_ASSIGN, ca.OP_NEG, ca.OP_SQRT, ca.OP_FABS, ca.OP_FLOOR, ca.OP_NOT, ca.OP_INV, *TWICE}


def _number(value: float, kind: str) -> str:
    """A literal that reads back to the same bits of this type."""
    if not np.isfinite(value):
        raise WorkbenchError("a program that becomes C holds an infinite constant; C99 has no literal for it.")
    if kind == "float":
        return f"{np.float32(value)}f"
    return repr(float(value))


class Writer:
    """Lines of C of one program. kind: "float" or "double". names: line -> the C name that its value gets.

    numbers: inputs that are never NaN, so that a minimum or maximum with them takes one comparison. finite: no value is
    ever NaN, so that every one does, and x <= 0 may be written as the opposite of 0 < x, and is compared once.
    """

    def __init__(
        self,
        program: Program,
        kind: str,
        inputs: Mapping[str, str],
        names: Mapping[str, str],
        numbers: Set[str] = frozenset(),
        finite: bool = False,
    ):
        self.kind, self.suffix = kind, {"float": "f", "double": "d"}[kind]
        self.names, self.program, self.numbers, self.finite = names, program, numbers, finite
        self.known: dict[str, Text] = {name: Text(text) for name, text in inputs.items()}
        self.lines_by_name = {line.out: line for line in program.lines}
        self.uses = Counter(o for line in program.lines for o in _operands(line))
        self.uses.update(n for output in program.outputs for n in output)
        self.uses.update(line.a for line in program.lines if line.op in TWICE)

    def of(self, name: str) -> Text:
        """The text of an operand."""
        if name in self.known:
            return self.known[name]
        return Text(_number(float(name.strip("()")), self.kind))

    def value(self, name: str) -> str:
        """The text of an operand as a number."""
        found = self.of(name)
        one, zero = (_number(x, self.kind) for x in (1.0, 0.0))
        return f"({found.text} ? {one} : {zero})" if found.condition else found.text

    def condition(self, name: str) -> str:
        """The text of an operand as a condition."""
        found = self.of(name)
        return found.text if found.condition else f"({found.text} != {_number(0.0, self.kind)})"

    def _sign(self, line: Line) -> str:
        """The operand x of (0 < x) - (x < 0), else nothing."""
        a, b = self.lines_by_name.get(line.a), self.lines_by_name.get(line.b)
        if line.op != ca.OP_SUB or a is None or b is None or not a.op == b.op == ca.OP_LT:
            return ""
        return self.value(a.b) if a.b == b.a and (a.a, b.b) == ("0.0", "0.0") else ""

    def expression(self, line: Line) -> Text:
        if isinstance(line, Choice):
            c, a, b = self.condition(line.condition), self.value(line.a), self.value(line.b)
            return Text(f"({c} ? {a} : {b})")
        if line.op == ca.OP_IF_ELSE_ZERO:
            return Text(f"({self.condition(line.a)} ? {self.value(line.b)} : {_number(0.0, self.kind)})")
        if line.op in LOGIC:
            b = self.condition(line.b) if line.op != ca.OP_NOT else ""
            return Text(LOGIC[line.op].format(a=self.condition(line.a), b=b), True)
        if line.op == ca.OP_LE and line.b == "0.0" and self.finite:
            return Text(f"(!({_number(0.0, self.kind)} < {self.value(line.a)}))", True)
        if line.op in CONDITIONS:
            return Text(CONDITIONS[line.op].format(a=self.value(line.a), b=self.value(line.b)), True)
        if signed := self._sign(line):
            return Text(f"wb_sign{self.suffix}({signed})")
        if line.op in SURE and (self.finite or line.b in self.numbers or line.b not in self.known):
            return Text(f"{SURE[line.op]}{self.suffix}({self.value(line.a)}, {self.value(line.b)})")
        if line.op == ca.OP_INV:
            return Text(f"({_number(1.0, self.kind)} / {self.value(line.a)})")
        if line.op in TWICE:
            return Text(TWICE[line.op].format(a=self.value(line.a)))
        b = self.value(line.b) if line.op not in UNARY else ""
        return Text(VALUES[line.op].format(a=self.value(line.a), b=b, s=self.suffix))

    def lines(self) -> list[str]:
        """Declarations, in order; afterwards `value` gives the text of every output."""
        out = []
        for line in self.program.lines:
            text = self.expression(line)
            name = self.names.get(line.out)
            if name is None and self.uses[line.out] == 1 and len(text.text) <= LONGEST:
                self.known[line.out] = text
                continue
            name = name or line.out
            kind = "int" if text.condition else self.kind
            out.append(f"const {kind} {name} = {bare(text.text)};")
            self.known[line.out] = Text(name, text.condition)
        return out


def bare(text: str) -> str:
    """Text without one pair of parentheses around all of it."""
    if not (text.startswith("(") and text.endswith(")")):
        return text
    depth = 0
    for i, c in enumerate(text):
        depth += (c == "(") - (c == ")")
        if depth == 0 and i < len(text) - 1:
            return text
    return text[1:-1]
