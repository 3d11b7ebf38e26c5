"""C that a firmware and the header of a gain table have in common, so that both say it once: the look-up, and how a law
finds reversals and the amplitude.
"""

import re
from dataclasses import replace
from pathlib import Path

from workbench.control.named import every
from workbench.firmware.naming import identifier
from workbench.firmware.parts import Part
from workbench.firmware.stages import stages
from workbench.firmware.units import POSITION
from workbench.kernel.c import Writer, bare
from workbench.kernel.choice import Choice
from workbench.simulation.given import REFERENCE
from workbench.simulation.sampled import AMPLITUDE

RUNTIME = Path(__file__).with_name("wb_runtime.h")
GIVEN = {"now.y": "position", REFERENCE: "target"}  # what a header's functions are handed


def interpolated(gain: str, slope: str) -> str:
    """Return the C of a gain between two knots, from those of the knot below and of the segment's slope."""
    return f"{gain} + {slope} * beyond"


HELPERS = (
    "wb_word",
    "wb_real",
    "wb_bits",
    "wb_minf",
    "wb_maxf",
    "wb_absf",
    "wb_lowf",
    "wb_segment",
)  # of wb_runtime.h that a header needs
PREFIX = "wb_table_"  # their names in a header, which may stand beside wb_runtime.h


def helpers() -> str:
    """Return HELPERS with the comment above each, under names that begin with PREFIX."""
    text = RUNTIME.read_text(encoding="utf-8")
    either = (
        r"(/\*(?:(?!\*/).)*?\*/\n)?(static inline \w+ {0}\([^;]*?\n{{[^}}]*?.*?\n}}\n|typedef union {{[^}}]*}} {0};\n)"
    )
    found = [re.search(either.format(n), text, re.DOTALL)[0] for n in HELPERS]
    return re.sub(r"\bwb_", PREFIX, "\n".join(found))


def _joined(lines: list[str]) -> str:
    """Lines with their helpers by the names that they have in a header."""
    return re.sub(r"\bwb_(absf|minf|maxf|lowf)\b", rf"{PREFIX}\1", "\n".join(lines))


def _observing(rule: str) -> tuple[Part, Part]:
    """Return (start, observe) of a schedule's law under a rule, of what its amplitude needs alone, positions in any unit."""
    made = stages(every()[f"scheduled_pd, {rule}"], "position", False)
    wanted = {n for n in made.observe.outputs if n != "vh"}
    keep = dict(zip(made.start.outputs, made.start.program.outputs[0], strict=True))
    first = replace(made.start.program, outputs=(tuple(v for n, v in keep.items() if n in wanted),))
    start = replace(made.start, outputs=tuple(n for n in keep if n in wanted), program=first)
    return start, _pruned(made.observe, wanted)


def _pruned(part: Part, wanted: set[str]) -> Part:
    """Return a part that gives only some of its outputs."""
    kept = [(n, v) for n, v in zip(part.outputs, part.program.outputs[0], strict=True) if n in wanted]
    needed, lines = {v for _, v in kept}, []
    for line in reversed(part.program.lines):
        if line.out in needed:
            needed |= {line.a, line.b} | ({line.condition} if isinstance(line, Choice) else set())
            lines.append(line)
    program = replace(part.program, lines=tuple(reversed(lines)), outputs=(tuple(v for _, v in kept),))
    return replace(part, outputs=tuple(n for n, _ in kept), program=program)


def _text_of(part: Part, known: dict[str, str], position: str) -> tuple[list[str], dict[str, str]]:
    """Return (declarations, text of each output) of a part in float32. known: number of a constant -> its C.

    position: the unit of a place. Whatever comes in, a NaN too: unlike the firmware's, this C knows no loader or encoder before it.
    """
    inputs = {f"i0_{j}": GIVEN.get(n, f"state->{identifier(n)}") for j, n in enumerate(part.rows)}
    inputs |= {f"i1_{j}": known.get(str(place), "") for j, place in enumerate(part.constants)}
    writer = Writer(part.program, "float", inputs, part.names, {n for n in inputs if n.startswith("i1_")})
    back = {name: value for value, name in part.names.items()}
    lines = []
    for line in writer.lines():
        declared = line.split(" = ")[0].split()[-1]
        power = part.powers[back.get(declared, declared)]
        lines.append(f"    {line} /* [{position if power == POSITION else '1'}] */")
    return lines, {n: bare(writer.value(v)) for n, v in zip(part.outputs, part.program.outputs[0], strict=True)}


def _known(rule: str, p: str) -> dict[str, str]:
    """Return number -> C of the constants that a header states: how far a reversal has to come back, and multiples of that."""
    made = stages(every()[f"scheduled_pd, {rule}"], "position", False)
    formulas = {str(i): c.formula for i, c in enumerate(made.constants) if "back" in c.formula}
    return {i: re.sub(r"(\d+\.\d+)", r"\1f", f).replace("back", f"{p.upper()}_REVERSAL") for i, f in formulas.items()}


def scheduling(rule: str, p: str, position: str) -> dict[str, str]:
    """Return the state, the first sample and every further one of a schedule over amplitude, as C behind the prefix p."""
    start, observe = _observing(rule)
    lines, values = _text_of(observe, _known(rule, p), position)
    first, begun = _text_of(start, {}, position)
    states = [n for n in observe.outputs if n != AMPLITUDE]
    units = dict(zip(observe.rows, (observe.powers.get(f"i0_{j}", ()) for j in range(len(observe.rows))), strict=True))
    unused = [] if REFERENCE in observe.rows else ["    (void)target;"]
    after = [f"    state->{identifier(n)} = {values[n]};" for n in states]
    return {
        "state": "\n".join(
            f"    float {identifier(n)}; /**< [{position if units.get(n) == POSITION else '1'}] */" for n in states
        ),
        "begin": _joined([*first, *(f"    state->{identifier(n)} = {begun[n]};" for n in states)]),
        "update": _joined([*unused, *lines, *after, f"    return {values[AMPLITUDE]};"]),
    }
