"""Two of CasADi's if-else-zeros and their sum, (c ? a : 0) + (!c ? b : 0), read back as the one choice that was meant.

One selection instead of two and an addition; the value is the same, except that a zero keeps its sign.
"""

from collections import Counter
from dataclasses import dataclass, replace

import casadi as ca

from workbench.kernel.program import Line, Program


@dataclass(frozen=True)
class Choice(Line):
    """work[out] = a where condition is not 0, else b."""

    condition: str = ""

    @property
    def operands(self) -> tuple[str, ...]:
        return self.condition, self.a, self.b

    @property
    def text(self) -> str:
        return f"select({self.condition} != 0.0, {self.a}, {self.b})"


def with_choices(program: Program) -> Program:
    """Return the program with such sums made choices, and without the lines that nothing needs then."""
    by_name = {line.out: line for line in program.lines}
    lines = [_choice(line, by_name) or line for line in program.lines]
    uses = Counter(name for output in program.outputs for name in output)
    kept = []
    for line in reversed(lines):
        if uses[line.out]:
            kept.append(line)
            uses.update(line.operands)
    return replace(program, lines=tuple(reversed(kept)))


def _choice(line: Line, by_name: dict[str, Line]) -> Choice | None:
    a, b = by_name.get(line.a), by_name.get(line.b)
    if line.op != ca.OP_ADD or a is None or b is None or not a.op == b.op == ca.OP_IF_ELSE_ZERO:
        return None
    other = by_name.get(b.a)
    if other is None or other.op != ca.OP_NOT or other.a != a.a:
        return None
    return Choice(line.op, line.out, a.b, b.b, a.a)
