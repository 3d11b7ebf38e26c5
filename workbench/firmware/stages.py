"""A law's stages as the firmware runs them: observe (velocity, reversals, where to look up) and command.

They are the functions that the simulated loop is made of (simulate.sampled), from the reading on. What depends on constants
alone is cut out and becomes a number of the table; a division by such a number becomes a multiplication by its reciprocal.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca

from workbench.control.law import Law
from workbench.effects.elementary import absolute
from workbench.firmware.units import Power, power_of, spread
from workbench.kernel.choice import with_choices
from workbench.kernel.program import Line, Program
from workbench.kernel.split import split
from workbench.simulation.dynamics import Symbols
from workbench.simulation.given import INJECTED, REFERENCE
from workbench.simulation.sampled import AMPLITUDE, command, followed, observed
from workbench.simulation.stage import stage

COMMAND, ADDED = "u_c", "added"
INCREMENT = "increment"  # counts since the last sample
SCALE = "law.scale"  # the command is proportional to the gains of every schedule, so that it may be in them
PROBE = "?"  # before the names of values that only get a name in the C text
POSITIONS = ("furthest", "turned")  # states that move along with the origin


@dataclass(frozen=True)
class Constant:
    """A number that the table holds. formula: of what the engineer states; identifier: its name in C."""

    identifier: str
    formula: str
    power: Power


@dataclass(frozen=True, eq=False)
class Part:
    """rows: what moves, in the order of the program's first input; constants: places in Stages.constants, of its second.

    names: value -> the name it gets in C. powers: value -> unit.
    """

    name: str
    rows: tuple[str, ...]
    constants: tuple[int, ...]
    outputs: tuple[str, ...]
    program: Program
    names: dict[str, str]
    powers: dict[str, Power]


@dataclass(frozen=True, eq=False)
class Stages:
    """start: states at rest. before: (given names, program) -> constants, evaluated once.

    states: what the firmware keeps from sample to sample.
    """

    law: Law
    feedback: str
    start: Part
    observe: Part
    command: Part
    given: tuple[str, ...]
    before: Program
    constants: tuple[Constant, ...]
    states: tuple[str, ...]

    @property
    def both(self) -> bool:
        """Whether two encoders are read."""
        return self.law.both

    def place(self, formula: str) -> int:
        """Where a constant is that is nothing but a given number."""
        return next(i for i, c in enumerate(self.constants) if c.formula == formula)

    @property
    def columns(self) -> tuple[str, ...]:
        return self.law.columns


class Folded(Symbols):
    """Symbols of a firmware. The factor on a schedule's gains is one: the table holds the gains times that factor.

    The reading that closes the loop is no state: this sample's is there, and the way since the last is counted.
    """

    def state(self, name: str) -> ca.SX:
        return super().state("now.y" if name == "y" else name)

    def constant(self, name: str) -> ca.SX:
        return ca.SX(1.0) if name == SCALE else super().constant(name)


@lru_cache(maxsize=64)
def stages(law: Law, feedback: str = "position") -> Stages:
    """Return the stages of a law. feedback: the encoder that closes the loop, where the law reads two."""
    symbols = Folded()
    begun, seen, decided = _outputs(law, symbols, feedback)
    seen.pop("y")
    wanted = {COMMAND} | ({AMPLITUDE} if law.columns else set())
    while True:  # what a kept value needs from the sample before is kept too
        made = [
            stage(name, symbols.all, {n: x for n, x in outputs.items() if n in wanted or n[0] == PROBE})
            for name, outputs in (("observe", seen), ("command", decided))
        ]
        made = [_pruned(s, wanted) for s in made]
        more = {n for s in made for n in s.inputs} & (set(seen) | set(decided)) - wanted
        if not more:
            break
        wanted |= more
    states = {n for s in made for n in s.inputs} & wanted
    first = stage("start", symbols.all, {n: begun.get(n, ca.SX(0.0)) for n in (*seen, *decided) if n in states})
    return _cut(law, feedback, symbols, [first, *made])


def _outputs(law: Law, symbols: Symbols, feedback: str):
    """Return the outputs of all three stages, with probes."""
    first = {"y": symbols.state("now.y")}
    if law.both:
        other = symbols.state("now.load.y" if feedback == "position" else "now.motor.y") * symbols.constant(
            "other_count"
        )
        both = (symbols.state("now.y"), other)
        motor, load = both if feedback == "position" else both[::-1]
        first = {"y": symbols.state("now.y"), "motor.y": motor, "load.y": load}
    driven = {REFERENCE: symbols.state(REFERENCE), INJECTED: symbols.state(ADDED)}
    step = symbols.state(INCREMENT)
    seen = observed(law, symbols, first, driven, step)
    at = followed(law, first)
    error = driven[REFERENCE] - first["y"]
    probes = {
        "rate": step * symbols.constant("sample_rate"),
        "from_furthest": at - symbols.state("furthest"),
        "stroke": absolute(at - seen["turned"]),
        "error": error,
    }
    if law.both:
        for body in ("motor", "load"):
            if f"{body}_vh" in law.reads:
                probes[f"{body}_increment"] = first[f"{body}.y"] - symbols.state(f"{body}.y")
    decided = command(law, symbols, driven)
    late = {"error": driven[REFERENCE] - symbols.state("y")}
    begun = first | {"furthest": at, "turned": at, "share": ca.SX(1.0)}
    if law.start is not None:
        begun |= {f"law.{n}": ca.SX(x) for n, x in law.start(driven[REFERENCE], first["y"]).items()}
    return begun, seen | _probed(probes), decided | _probed(late)


def _probed(values: dict) -> dict:
    return {PROBE + n: v for n, v in values.items()}


def _pruned(made, wanted: set[str]):
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


def _cut(law: Law, feedback: str, symbols: Symbols, made) -> Stages:
    """Return the stages cut in two, the halves that are evaluated once joined to one program."""
    given = tuple(dict.fromkeys(n for s in made for n in s.inputs if n in symbols.constants))
    lines, outputs, constants, parts = [], [], [], []
    for s in made:
        constant = [n in symbols.constants for n in s.inputs]
        before, after = split(_reciprocals(s.program, constant), constant)
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


WORDS = {ca.OP_ADD: "plus", ca.OP_SUB: "minus", ca.OP_MUL: "times", ca.OP_DIV: "over"}
SIGNS = {ca.OP_ADD: "+", ca.OP_SUB: "-", ca.OP_MUL: "*", ca.OP_DIV: "/"}
LONGEST = 40  # characters of a name that is put together from others


def identifier(name: str) -> str:
    """A row's or constant's name in C."""
    return name.removeprefix("law.").removeprefix("now.").replace(".", "_")


def formulas(program: Program, given: tuple[str, ...]) -> dict[str, tuple[str, str]]:
    """Return value -> (name in C, formula) of a program of constants."""
    known = {f"i0_{j}": (identifier(n), identifier(n)) for j, n in enumerate(given)}
    for k, line in enumerate(program.lines):
        (a, fa), (b, fb) = (known.get(o, (o.replace(".", "_").strip("()-"), o)) for o in (line.a, line.b))
        if line.op in WORDS:
            name, text = f"{a}_{WORDS[line.op]}_{b}", f"({fa} {SIGNS[line.op]} {fb})"
        elif line.op == ca.OP_NEG:
            name, text = f"minus_{a}", f"-{fa}"
        elif line.op == ca.OP_INV:
            name, text = f"per_{a}", f"1/{fa}"
        elif line.op in (ca.OP_SQ, ca.OP_TWICE):
            word, sign = {ca.OP_SQ: ("squared", f"{fa}^2"), ca.OP_TWICE: ("twice", f"2*{fa}")}[line.op]
            name, text = f"{a}_{word}", sign
        else:
            name, text = f"number_{k}", line.text
        known[line.out] = (name if len(name) <= LONGEST else f"number_{k}", text)
    return known
