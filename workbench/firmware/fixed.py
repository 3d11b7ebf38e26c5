"""A part's program in integers: every value gets a format from its interval, so that nothing overflows.

A value x is held as the 32-bit n = x 2^bits, |n| <= 2^30: one bit is left for sums and rounding. Products are formed in 64
bits, and what does not fit is cut off downwards. Signals that physics bounds rather than arithmetic (error, speed, way of a sample) are cut off
there. One text serves C and Python: calls of the helpers that wb_fixed.h and FixedReference define alike.
"""

from collections.abc import Mapping, Set
from dataclasses import dataclass
from math import ceil, log2

import casadi as ca

from workbench.errors import WorkbenchError
from workbench.firmware import interval
from workbench.firmware.interval import Interval
from workbench.firmware.parts import Part
from workbench.kernel.c import LOGIC
from workbench.kernel.choice import Choice
from workbench.kernel.program import Line

WHOLE = 30  # bits that a value fills at most
COMPARED = {ca.OP_LT: "<", ca.OP_LE: "<=", ca.OP_EQ: "==", ca.OP_NE: "!="}
BOTH = {ca.OP_NOT: "wb_not({0})", ca.OP_AND: "wb_and({0}, {1})", ca.OP_OR: "wb_or({0}, {1})"}


@dataclass(frozen=True)
class Format:
    """n stands for n 2^-bits, and lies between low and high."""

    bits: int
    low: float
    high: float

    @property
    def interval(self) -> Interval:
        return self.low, self.high


@dataclass(frozen=True)
class Value:
    """A typed value: text over operands, its format, and whether it is a condition (0 or 1)."""

    out: str
    text: str
    operands: tuple[str, ...]
    format: Format
    condition: bool = False


def _room(a: Interval) -> int:
    """The most fractional bits with which an interval fits into 30 bits."""
    largest = max(abs(a[0]), abs(a[1]))
    return WHOLE if largest == 0.0 else WHOLE - ceil(log2(largest))


def fitting(low: float, high: float, most: int = 60) -> Format:
    return Format(min(_room((low, high)), most), low, high)


def envelope(value: float, spare: int = WHOLE) -> Format:
    """The format of a table's number: good for every number of its sign up to the next power of two."""
    if value == 0.0:
        return Format(0, 0.0, 0.0)
    top = 2.0 ** ceil(log2(abs(value)))
    low, high = (top / 4.0, top) if value > 0.0 else (-top, -top / 4.0)
    return Format(spare - ceil(log2(abs(value))), low, high)


def _shifted(name: str, by: int) -> str:
    """Text of an operand with `by` fractional bits fewer, rounded down; more where `by` is negative."""
    if by == 0:
        return name
    if by > WHOLE:
        return "0"
    return f"wb_right({name}, {by})" if by > 0 else f"wb_left({name}, {-by})"


class Typed:
    """The typed lines of one part. inputs: "i0_0" -> Format. bounds: C name of a value -> largest size; proven: of which it needs no cut."""

    def __init__(
        self, part: Part, inputs: Mapping[str, Format], bounds: Mapping[str, float], proven: Set[str] = frozenset()
    ):
        self.part, self.bounds, self.proven = part, bounds, proven
        self.values: dict[str, Value] = {n: Value(n, n, (), f) for n, f in inputs.items()}
        self.lines: list[Value] = []
        for line in part.program.lines:
            value = self._bounded(line, self._value(line))
            self.values[line.out] = value
            self.lines.append(value)

    def format(self, name: str) -> Format | None:
        """The format of an operand; None of a literal, which takes any."""
        return self.values[name].format if name in self.values else None

    def interval(self, name: str) -> Interval:
        found = self.format(name)
        return found.interval if found else (float(name.strip("()")),) * 2

    def _literal(self, name: str, bits: int) -> str:
        return str(round(float(name.strip("()")) * 2.0**bits))

    def _at(self, name: str, bits: int) -> str:
        """Text of an operand with these fractional bits; operands are written {name}."""
        if name not in self.values:
            return self._literal(name, bits)
        text = f"wb_truth({{{name}}})" if self.values[name].condition else f"{{{name}}}"
        return _shifted(text, self.values[name].format.bits - bits)

    def _truth(self, name: str) -> str:
        if name in self.values and self.values[name].condition:
            return f"{{{name}}}"
        return f"({self._at(name, self.format(name).bits if name in self.values else 0)} != 0)"

    def _common(self, *names: str) -> int:
        """Fractional bits that operands are brought to: as fine as the finest, as far as each has room."""
        known = [self.format(n) for n in names if n in self.values]
        finest = max((f.bits for f in known), default=WHOLE)
        return min(finest, *(_room(self.interval(n)) for n in names))

    def _value(self, line: Line) -> Value:
        if isinstance(line, Choice):
            return self._choice(line)
        a, b = self.interval(line.a), self.interval(line.b) if line.b else (0.0, 0.0)
        found = interval.of(line, a, b)
        if line.op in COMPARED:
            bits = self._common(line.a, line.b)
            text = f"({self._at(line.a, bits)} {COMPARED[line.op]} {self._at(line.b, bits)})"
            return self._made(line, text, Format(0, 0.0, 1.0), True)
        if line.op in LOGIC:
            second = self._truth(line.b) if line.op != ca.OP_NOT else ""
            return self._made(line, BOTH[line.op].format(self._truth(line.a), second), Format(0, 0.0, 1.0), True)
        return self._number(line, found)

    def _number(self, line: Line, found: Interval) -> Value:
        op, a, b = line.op, line.a, line.b
        if op in (ca.OP_ADD, ca.OP_SUB, ca.OP_FMIN, ca.OP_FMAX):
            bits = min(self._common(a, b), _room(found))
            text = {ca.OP_ADD: "({0} + {1})", ca.OP_SUB: "({0} - {1})",
                    ca.OP_FMIN: "wb_min({0}, {1})", ca.OP_FMAX: "wb_max({0}, {1})"}[op]  # fmt: skip
            text = text.replace("{0}", self._at(a, bits)).replace("{1}", self._at(b, bits))
            return self._made(line, text, Format(bits, *found))
        if op in (ca.OP_MUL, ca.OP_SQ):
            return self._product(line, a, b if op == ca.OP_MUL else a, found)
        if op in (ca.OP_DIV, ca.OP_INV):
            return self._quotient(line, *((a, b) if op == ca.OP_DIV else ("1.0", a)), found)
        bits = self.format(a).bits if a in self.values else _room(found)
        if op == ca.OP_TWICE:
            return self._made(line, self._at(a, bits), Format(bits - 1, *found))
        if op == ca.OP_SQRT:
            up = 30 if bits % 2 == 0 else 29
            return self._made(line, f"wb_root({self._at(a, bits)}, {up})", Format((bits + up) // 2, *found))
        if op == ca.OP_IF_ELSE_ZERO:
            bits = self.format(b).bits if b in self.values else _room(found)
            return self._made(line, f"wb_choose({self._truth(a)}, {self._at(b, bits)}, 0)", Format(bits, *found))
        text = {ca.OP_NEG: "(-{0})", ca.OP_FABS: "wb_size({0})", ca.OP_ASSIGN: "{0}"}[op]
        return self._made(line, text.replace("{0}", self._at(a, bits)), Format(bits, *found))

    def _choice(self, line: Choice) -> Value:
        bits = self._common(line.a, line.b)
        text = f"wb_choose({self._truth(line.condition)}, {self._at(line.a, bits)}, {self._at(line.b, bits)})"
        found = interval.union(self.interval(line.a), self.interval(line.b))
        return self._made(line, text, Format(bits, *found))

    def _own(self, name: str) -> int:
        """Fractional bits of an operand of a product; a literal as coarse as it may be."""
        if name in self.values:
            return self.format(name).bits
        value = abs(float(name.strip("()")))
        return next(
            b for b in range(WHOLE + 1) if value * 2.0**b == round(value * 2.0**b) or b == _room((value, value))
        )

    def _product(self, line: Line, a: str, b: str, found: Interval) -> Value:
        fa, fb = self._own(a), self._own(b)
        bits = min(_room(found), fa + fb)
        x, y = self._at(a, fa), self._at(b, fb)
        text = f"({x} * {y})" if bits == fa + fb else f"wb_times({x}, {y}, {fa + fb - bits})"
        return self._made(line, text, Format(bits, *found))

    def _quotient(self, line: Line, a: str, b: str, found: Interval) -> Value:
        fa, fb = self._own(a), self._own(b)
        up = min(_room(found) + fb - fa, 32)
        if up < 0:
            raise WorkbenchError("a quotient of this law is too large for fixed point.")
        return self._made(line, f"wb_over({self._at(a, fa)}, {self._at(b, fb)}, {up})", Format(up + fa - fb, *found))

    def _made(self, line: Line, text: str, form: Format, condition: bool = False) -> Value:
        operands = tuple(dict.fromkeys(n for n in (line.a, line.b, getattr(line, "condition", "")) if n in self.values))
        return Value(line.out, text, operands, form, condition)

    def _bounded(self, line: Line, value: Value) -> Value:
        """Cut a value off at the bound that its name has."""
        bound = self.bounds.get(self.part.names.get(line.out, ""))
        if bound is None or max(abs(value.format.low), abs(value.format.high)) <= bound:
            return value
        bits = value.format.bits
        most = int(bound * 2.0**bits)
        low, high = interval.within(value.format.interval, (-bound, bound))
        proven = self.part.names[line.out] in self.proven
        return Value(
            line.out,
            value.text if proven else f"wb_within({value.text}, {most})",
            value.operands,
            Format(bits, low, high),
        )

    def output(self, name: str, form: Format) -> str:
        """Text of a value in a given format (of a state), cut off at that format's ends where it may be beyond."""
        text = self._at(name, form.bits)
        low, high = self.interval(name)
        most = max(abs(form.low), abs(form.high))
        if max(abs(low), abs(high)) <= most:
            return text
        own = self.values[name].format.bits if name in self.values else form.bits
        if own < form.bits:  # it is finer there: cut off first, for what is beyond would not fit
            return _shifted(f"wb_within({{{name}}}, {int(most * 2.0**own)})", own - form.bits)
        return f"wb_within({text}, {round(most * 2.0**form.bits)})"
