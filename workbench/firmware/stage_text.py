"""One stage of a law as a C function: its declarations with their units, its arguments, and its call."""

from collections.abc import Mapping

from workbench.firmware.naming import identifier
from workbench.firmware.parts import Part, Stages
from workbench.firmware.units import power_of, unit
from workbench.kernel.c import Writer, bare

PARAMETERS = {"now.y": "y", "now.motor.y": "motor_counts", "now.load.y": "load_counts"}


def parameter(row: str) -> str:
    """Return the C name of what is handed to a stage from outside its state."""
    return PARAMETERS.get(row, identifier(row.removeprefix("gain.")))


def commented(text: str, said: str, indent: str = "    ") -> str:
    return f"{indent}{text} /* [{said}] */"


class StageText:
    """Stages of a law as C. p: what its names begin with. effort: "N*m" or "N"."""

    kind = "float"

    def __init__(self, stages: Stages, p: str, effort: str):
        self.stages, self.p, self.effort = stages, p, effort

    def unit_of(self, name: str) -> str:
        return unit(power_of(name), self.effort)

    def number(self, place: int) -> str:
        return f"k[{self.stages.constants[place].identifier.upper()}]"

    def arguments(self, part: Part) -> list[str]:
        """Rows of a part that are no state."""
        return [n for n in part.rows if n not in self.stages.states]

    def body(self, part: Part) -> tuple[list[str], Mapping[str, str]]:
        """Return the declarations of a part, and the text of each of its outputs."""
        inputs = {
            f"i0_{j}": f"s->{identifier(n)}" if n in self.stages.states else parameter(n)
            for j, n in enumerate(part.rows)
        }
        inputs |= {f"i1_{j}": self.number(place) for j, place in enumerate(part.constants)}
        names = {v: n for v, n in part.names.items() if n not in map(parameter, self.arguments(part))}
        numbers = {n for n in inputs if n.startswith("i1_")}
        writer = Writer(part.program, self.kind, inputs, names, numbers, finite=True)
        back = {name: value for value, name in names.items()}
        lines = []
        for line in writer.lines():
            declared = line.split(" = ")[0].split()[-1]
            lines.append(commented(line, unit(part.powers[back.get(declared, declared)], self.effort)))
        return lines, {n: bare(writer.value(v)) for n, v in zip(part.outputs, part.program.outputs[0], strict=True)}

    def function(self, part: Part, name: str, result: str | None) -> str:
        """Return one stage as a static function; result: the output that it returns."""
        lines, values = self.body(part)
        kept = [n for n in part.outputs if n in self.stages.states]
        reads = any(n in self.stages.states for n in part.rows)
        given = [f"{self.kind} {parameter(n)}" for n in self.arguments(part)]
        states = [f"{'' if kept else 'const '}{self.p}_state *s"] if kept or reads else []
        table = [f"const {self.kind} *k"] if part.constants else []
        head = f"static {self.kind if result else 'void'} {name}({', '.join(states + table + given)})"
        lines += [f"    s->{identifier(n)} = {values[n]};" for n in kept if values[n] != f"s->{identifier(n)}"]
        lines += [f"    return {values[result]};"] if result else []
        return "\n".join([head, "{", *lines, "}"])

    def call(self, part: Part, name: str, given: Mapping[str, str]) -> str:
        kept = [n for n in part.outputs if n in self.stages.states]
        reads = any(n in self.stages.states for n in part.rows)
        arguments = ["state"] * bool(kept or reads) + ["table->number"] * bool(part.constants)
        return f"{name}({', '.join(arguments + [given[n] for n in self.arguments(part)])})"
