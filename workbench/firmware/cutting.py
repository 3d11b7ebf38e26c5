"""Stages cut in two: what depends on constants alone is evaluated once, and no lines are kept that nobody needs."""

from dataclasses import replace

import casadi as ca

from workbench.control.law import Law
from workbench.firmware.naming import formulas, identifier
from workbench.firmware.parts import Constant, Part, Stages
from workbench.firmware.units import power_of, spread
from workbench.kernel.choice import with_choices
from workbench.kernel.program import Line, Program
from workbench.kernel.split import split
from workbench.simulation.dynamics import Symbols

PROBE = "?"  # before the names of values that only get a name in the C text


def pruned(made, wanted: set[str]):
    """Return a stage without lines that only probes need, and without probes that are gone then."""
    program, needed = made.program, set()
    for name, value in zip(made.outputs, program.outputs[0], strict=True):
        if name in wanted:
            needed.add(value)
    lines = []
    for line in reversed(program.lines):
        if line.out in needed:
            lines.append(line)
            needed |= {line.a, line.b}
    kept = [
        (n, v) for n, v in zip(made.outputs, program.outputs[0], strict=True)
        if n in wanted or (v in needed and v.startswith("w"))
    ]  # fmt: skip
    used = [j for j in range(len(made.inputs)) if f"i0_{j}" in needed]
    again = {f"i0_{j}": f"i0_{k}" for k, j in enumerate(used)}

    def renamed(name: str) -> str:
        return again.get(name, name)

    lines = tuple(replace(x, a=renamed(x.a), b=renamed(x.b)) for x in reversed(lines))
    outputs = (tuple(renamed(v) for _, v in kept),)
    program = Program(program.name, (len(used),), lines, outputs)
    return replace(made, inputs=tuple(made.inputs[j] for j in used), outputs=tuple(n for n, _ in kept), program=program)


def _unfloored(program: Program) -> Program:
    """Return a program in which max(|x|, 0) is |x|."""
    sizes, again, lines = {x.out for x in program.lines if x.op == ca.OP_FABS}, {}, []
    for line in program.lines:
        line = replace(line, a=again.get(line.a, line.a), b=again.get(line.b, line.b))
        if line.op == ca.OP_FMAX and line.a in sizes and line.b == "0.0":
            again[line.out] = line.a
        else:
            lines.append(line)
    return replace(
        program, lines=tuple(lines), outputs=tuple(tuple(again.get(n, n) for n in o) for o in program.outputs)
    )


def _reciprocals(program: Program, constant: list[bool]) -> Program:
    """Return a program in which what moves is divided by no constant, but multiplied by its reciprocal."""
    once = {f"i0_{j}" for j, c in enumerate(constant) if c}
    lines = []
    for line in program.lines:
        still = [o in once or not o.startswith(("w", "i")) for o in (line.a, line.b)]
        if all(still):
            once.add(line.out)
        if line.op == ca.OP_DIV and still[1] and not still[0]:
            inverse = Line(ca.OP_INV, f"{line.out}r", line.b, "0.0")
            once.add(inverse.out)
            lines += [inverse, replace(line, op=ca.OP_MUL, b=inverse.out)]
        else:
            lines.append(line)
    return replace(program, lines=tuple(lines))


def cut(law: Law, feedback: str, symbols: Symbols, made) -> Stages:
    """Return the stages cut in two, the halves that are evaluated once joined to one program."""
    given = tuple(dict.fromkeys(n for s in made for n in s.inputs if n in symbols.constants))
    lines, outputs, constants, parts = [], [], [], []
    for s in made:
        constant = [n in symbols.constants for n in s.inputs]
        before, after = split(_reciprocals(_unfloored(s.program), constant), constant)
        own = [n for n in s.inputs if n in symbols.constants]
        before = _joined(before, own, given, s.name)
        lines += before.lines
        described = formulas(before, given)
        places = []
        for value in before.outputs[0]:
            identifier, formula = described[value]
            power = spread(before, {f"i0_{j}": power_of(n) for j, n in enumerate(given)})[value]
            one = Constant(identifier, formula, power)
            if one not in constants:
                constants.append(one)
                outputs.append(value)
            places.append(constants.index(one))
        parts.append(_part(s, with_choices(after), symbols, places, constants))
    before = Program("constants", (len(given),), tuple(lines), (tuple(outputs),))
    return Stages(law, feedback, *parts, given, before, tuple(constants), made[0].outputs)


def _joined(before: Program, own: list[str], given: tuple[str, ...], prefix: str) -> Program:
    """Return the program with inputs counted among `given`, and names that are no other stage's."""
    again = {f"i0_{j}": f"i0_{given.index(n)}" for j, n in enumerate(own)}
    again |= {line.out: f"w_{prefix}_{line.out}" for line in before.lines}
    lines = tuple(
        replace(x, out=again[x.out], a=again.get(x.a, x.a), b=again.get(x.b, x.b)) for x in before.lines
    )  # fmt: skip
    return Program(before.name, (len(given),), lines, (tuple(again.get(n, n) for n in before.outputs[0]),))


def _part(made, program: Program, symbols: Symbols, places: list[int], constants: list[Constant]) -> Part:
    rows = tuple(n for n in made.inputs if n not in symbols.constants)
    inputs = {f"i0_{j}": power_of(n) for j, n in enumerate(rows)}
    inputs |= {f"i1_{j}": constants[place].power for j, place in enumerate(places)}
    named = list(zip(made.outputs, program.outputs[0], strict=True))
    alive = {line.out for line in program.lines}
    names = {v: identifier(n.removeprefix(PROBE)) for n, v in reversed(named) if v in alive}
    kept = [(n, v) for n, v in named if n[0] != PROBE]
    program = replace(program, outputs=(tuple(v for _, v in kept),))
    powers = spread(program, inputs)
    return Part(made.name, rows, tuple(places), tuple(n for n, _ in kept), program, names, powers)
