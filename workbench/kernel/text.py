"""The text of a program's lines, in a straight function of a loop over lanes (see `workbench.kernel.straight`)."""

from collections.abc import Mapping

import casadi as ca

from workbench.kernel.choice import Choice
from workbench.kernel.order import by_latency
from workbench.kernel.program import Line, Program


def written(program: Program, read: Mapping[str, str], lanes: int) -> list[str]:
    """Return the lines of a program, each operand of `read` (name -> text) being read where it is first needed, in many lanes."""
    if lanes == 1:
        every = [f"{name} = {text}" for name, text in read.items()]
        return every + [f"{line.out} = {_expression(line, lanes)}" for line in program.lines]
    inside, left = [], dict(read)
    for line in by_latency(program).lines:
        inside += [f"{name} = {left.pop(name)}" for name in dict.fromkeys(line.operands) if name in left]
        inside.append(f"{line.out} = {_expression(line, lanes)}")
    return inside + [f"{name} = {left[name]}" for name in dict.fromkeys(program.outputs[0]) if name in left]


def _expression(line: Line, lanes: int) -> str:
    """The text of a line. Beside a constant, which is never NaN, fmin and fmax need one comparison, and in this form are
    one instruction of the processor; of two zeros of unlike sign they may return the other one."""
    if line.op in (ca.OP_FMIN, ca.OP_FMAX):
        sign = "<" if line.op == ca.OP_FMIN else ">"
        if _known(line.b):
            return f"select({line.a} {sign} {line.b}, {line.a}, {line.b})"
        if _known(line.a):
            return f"select({line.b} {sign} {line.a}, {line.b}, {line.a})"
    if isinstance(line, Choice) and lanes == 1:
        return line.text.replace("select", "branch", 1)
    return line.text


def _known(name: str) -> bool:
    return not name.startswith(("w", "i0_")) and name != "NAN"
