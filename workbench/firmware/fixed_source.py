"""A law's firmware in fixed point as C99: the same header, and a source in 32-bit integers."""

import re
from collections import Counter
from collections.abc import Mapping

from workbench.firmware.fixed import Typed, Value
from workbench.firmware.identity import law_code
from workbench.firmware.naming import identifier
from workbench.firmware.numbers import Numbers
from workbench.firmware.parts import Part
from workbench.firmware.scales import REACH, Scales
from workbench.firmware.stage_text import parameter
from workbench.firmware.stages import ADDED, COMMAND
from workbench.firmware.units import power_of, unit
from workbench.firmware.write import Source
from workbench.kernel.c import LONGEST, bare

PRODUCT = re.compile(r"(wb_times\(.*, )(\d+)\)", re.DOTALL)


def _joined(value: Value, known: Mapping[str, str]) -> str:
    """Return a value's text in which a product that is shifted further is shifted once: the same bits, an instruction less."""
    text = value.text
    for name in value.operands:
        product = PRODUCT.fullmatch(known[name])
        for by in re.findall(rf"wb_right\(\{{{name}\}}, (\d+)\)", text) if product else ():
            once = f"{product[1]}{int(product[2]) + int(by)})".replace("{", "{{").replace("}", "}}")
            text = text.replace(f"wb_right({{{name}}}, {by})", once)
    return text


class FixedSource(Source):
    """The C of one law with the scales of one controller's numbers."""

    said = "fixed point"
    number_type = kind = "int32_t"
    template = "law_fixed.c.in"
    runtime = (*Source.runtime, "wb_fixed.h", "wb_fixed.c")
    include = "wb_fixed.h"
    end = "WB_REACH"
    words = ("wb_signed", "(uint32_t)")

    def __init__(self, numbers: Numbers, scales: Scales, name: str, effort: str = "N*m"):
        super().__init__(numbers.stages, name, numbers.knots.size, effort)
        self.scales, self.numbers = scales, numbers
        self.typed = {t.part.name: t for t in scales.parts}

    @property
    def rows(self) -> int:
        return len(self.stages.columns)

    def code(self) -> int:
        return law_code(self.stages, self.scales.text)

    def scaled(self, power, bits: int) -> str:
        return f"{unit(power, self.effort)} 2^{-bits}" if bits else unit(power, self.effort)

    def body(self, part: Part) -> tuple[list[str], Mapping[str, str]]:
        typed = self.typed[part.name]
        known = {
            f"i0_{j}": f"s->{identifier(n)}" if n in self.stages.states else parameter(n)
            for j, n in enumerate(part.rows)
        }
        known |= {f"i1_{j}": self.number(place) for j, place in enumerate(part.constants)}
        arguments = set(map(parameter, self.arguments(part)))
        texts = self._outputs(typed)
        uses = Counter(n for v in typed.lines for n in v.operands for _ in range(v.text.count(f"{{{n}}}")))
        uses.update(n for text in texts.values() for n in typed.values for _ in range(text.count(f"{{{n}}}")))
        lines = []
        for v in typed.lines:
            text, name = _joined(v, known).format(**known), part.names.get(v.out)
            name = None if name in arguments else name
            if name is None and uses[v.out] == 1 and len(text) <= LONGEST:
                known[v.out] = text
                continue
            known[v.out] = name or v.out
            said = "1" if v.condition else self.scaled(part.powers[v.out], v.format.bits)
            lines.append(
                f"    const {'int' if v.condition else 'int32_t'} {known[v.out]} = {bare(text)}; /* [{said}] */"
            )
        return lines, {n: bare(text.format(**known)) for n, text in texts.items()}

    def _outputs(self, typed: Typed) -> dict[str, str]:
        """Name -> text, over operands, of each output in the format that it is kept in."""
        found = {}
        for name, value in zip(typed.part.outputs, typed.part.program.outputs[0], strict=True):
            form = self.scales.row(name) if name in self.stages.states else self.scales.result(name)
            found[name] = typed.output(value, form)
        return found

    def given(self) -> dict[str, str]:
        real = {
            "now.y": "y",
            "increment": "way",
            "reference": "reference",
            "added": "wb_within(now->added, table->number[LIMIT])",
        }
        return real | dict.fromkeys(("now.motor.y", "now.load.y"), f"wb_within(wb_signed(now->other), {REACH})")

    def step(self) -> str:
        given = self.given()
        seen = self.call(self.stages.observe, "observe", given)
        y = "now.y" in (*self.stages.observe.rows, *self.stages.command.rows)
        lines = ["int32_t way;", *["int32_t y;"] * y, "int32_t reference;"]
        if self.stages.columns:
            lines += ["int32_t into;", "uint32_t i;", *(f"int32_t {n};" for n in self.stages.columns)]
        within = f" || !wb_encoder_within(&state->encoder, {self.end})" if self.stages.both else ""
        follow = "!wb_encoder_follow(&state->encoder, &table->head, now->position, &way)"
        lines += [f"if ({follow}{within}) {{", "    return 0;", "}"]
        lines += ["y = state->encoder.position;"] * y + [f"reference = {self.target('state->encoder.position')};"]
        if self.stages.columns:
            bits, _, shift = self.scales.amplitude
            lines += [
                f"i = wb_segment_fixed(&table->head, wb_times_most({seen}, table->factor, {shift}), {bits}, &into);"
            ]
            for j, n in enumerate(self.stages.columns):
                lines += [f"{n} = wb_between(table->row[{j}], i, into);"]
                given[f"gain.{n}"] = n
        else:
            lines += [f"{seen};"]
        lines += self.ending(given, f"wb_within({{0}} - y, {REACH})")
        return "\n".join(f"    {x}" for x in lines) + "\n"

    def target(self, position: str) -> str:
        """The target, no further from the reading than is told apart."""
        away = f"(uint32_t)now->reference - state->encoder.origin - (uint32_t)({position})"
        return f"{position} + wb_within(wb_signed({away}), {self.scales.travel})"

    def begin(self) -> str:
        """The arguments of the first stage; an axis of two encoders that starts too far away stops in its first step."""
        y = f"wb_within(state->encoder.position, {REACH})" if self.stages.both else "state->encoder.position"
        given = self.given() | {"now.y": y, "reference": self.target(y)}
        return self.call(self.stages.start, "begin", given)

    def state_lines(self) -> list[str]:
        return [
            f"    int32_t {identifier(n)}; /* [{self.scaled(power_of(n), self.scales.row(n).bits)}] */"
            for n in self.stages.states
        ]

    def enumeration(self) -> str:
        constants = list(zip(self.stages.constants, self.scales.constants, strict=True))
        lines = [
            f"    {c.identifier.upper()}{',' if i + 1 < len(constants) else ' '} "
            f"/* {c.formula} [{self.scaled(c.power, f.bits)}] */"
            for i, (c, f) in enumerate(constants)
        ]
        return "\n".join(lines)

    def read(self, word: str) -> str:
        return f"wb_signed({word})"

    def fields(self) -> dict:
        made = super().fields()
        u, bits = self.scales.result(COMMAND).bits, self.scales.row(ADDED).bits
        factor = (
            f"    int32_t factor; /* amplitudes in counts to the table's [2^-{self.scales.amplitude[1]}] */\n"
            if self.rows
            else ""
        )
        load = f"    table->factor = {self.scales.amplitude_factor};\n" if self.rows else ""
        last = (
            f"    for (j = 0u; j < {self.p.upper()}_ROWS; ++j) {{ /* so that the last knot has one after it */\n"
            "        table->row[j][table->head.knots] = (table->head.knots > 0u) ? table->row[j][table->head.last] : 0;\n    }\n"
            if self.rows
            else ""
        )
        return made | {
            "factor": factor,
            "load_rows": made["load_rows"] + load + last,
            "spare": " + 1" if self.rows else "",
            "unit": f"{self.effort} 2^{-u}",
            "added_unit": f"{self.effort} 2^{-bits}",
            "added_said": "",
            "command_said": "",
        }
