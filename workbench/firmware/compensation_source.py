"""A compensation's firmware as C99, in float32 or in fixed point, around the instructions of its two stages."""

import re
import zlib
from pathlib import Path
from string import Template
from types import SimpleNamespace

from workbench.firmware.compensation import FORCE, Compensation
from workbench.firmware.compensation_scales import Scales, offsets
from workbench.firmware.fixed_source import FixedSource
from workbench.firmware.naming import identifier
from workbench.firmware.parts import Part
from workbench.firmware.scales import REACH
from workbench.firmware.write import Source
from workbench.kernel.choice import Choice

HERE = Path(__file__).parent
UNITLESS = re.compile(r" /\* \[1( 2\^-?\d+)?\] \*/")  # of SI numbers the header says the unit once


def _text_of(made: Compensation, scales: str) -> str:
    """Return what identifies a compensation: every instruction, the shape of its tables, and the scales."""
    said = ["compensation", made.compensator.source, scales]
    said += [f"{n} {c.knots.size} {made.over(n)}" for n, c in made.tables.items()]
    for part in (made.observe, made.act):
        said += [part.name, *part.rows, *map(str, part.constants)]
        for x in part.program.lines:
            said.append(f"{x.out} {x.op} {x.a} {x.b} {x.condition if isinstance(x, Choice) else ''}")
        said += [f"{n} {v}" for n, v in zip(part.outputs, part.program.outputs[0], strict=True)]
    return "\n".join(said)


class Written:
    """What both arithmetics share. name: of files and, behind "wb_", of functions."""

    def setup(self, made: Compensation, name: str):
        self.made, self.name, self.effort, self.p = made, name, made.effort, f"wb_{name}"
        self.stages = SimpleNamespace(states=made.states, constants=made.constants, columns=(), both=False)

    def number(self, place: int) -> str:
        return f"k[{place}]"

    def code(self) -> int:
        return zlib.crc32(_text_of(self.made, self.scale_text).encode())

    def stage(self, part: Part, result: str | None) -> str:
        """Return one stage as a static function."""
        return UNITLESS.sub("", self.function(part, part.name, result))

    def table_lines(self) -> list[str]:
        """Look-ups, a line each."""
        lines = []
        for n, at in offsets(self.made).items():
            over = "place" if self.made.over(n) == "place" else "state->v"
            lines.append(
                f"{n} = looked(table->number + {at}, {self.made.tables[n].knots.size}u, {over}{self.shift(n)});"
            )
        return lines

    def fields(self) -> dict[str, str]:
        made, p = self.made, self.p
        given = {n: n for n in (*made.tables, "moved", "place")}
        tables = list(made.tables)
        declared = "".join(f"    {self.kind} {n};\n" for n in (*tables, *(["place"] if self.placed else [])))
        place = [f"place = {self.placing};"] if self.placed else []
        lines = [*place, f"{self.call(made.observe, 'observe', given)};", *self.table_lines()]
        lines.append(f"return {self.call(made.act, 'act', given)};")
        keys = ", ".join(e.key for e in made.compensator.forces)
        return {
            "p": p, "P": p.upper(), "header": f"{self.name}.h", "law": f"{self.code():08X}", "said": self.said,
            "keys": keys, "source": made.compensator.source, "number": self.number_type, "numbers": str(self.size),
            "include": self.include, "arithmetic": self.arithmetic, "unit": self.force_unit, "read": self.read("wb_u32(at)"),
            "states": "\n".join(f"    {self.number_type} {identifier(n)};" for n in made.states),
            "zero": "\n".join(f"    state->{identifier(n)} = {self.zero};" for n in made.states),
            "observe": self.stage(made.observe, None), "act": self.stage(made.act, FORCE), "looked": self.looked if tables else "",
            "declared": declared, "moved": self.moved, "steps": "\n".join(f"    {x}" for x in lines), "fraction": str(self.fraction),
            "limit": self.limited,
        }  # fmt: skip

    @property
    def placed(self) -> bool:
        return "place" in self.made.act.rows or any(self.made.over(n) == "place" for n in self.made.tables)

    @property
    def size(self) -> int:
        return self.made.values.size + sum(3 * c.knots.size for c in self.made.tables.values())

    def files(self) -> dict[str, str]:
        """Return file name -> text of everything that is compiled, the part by hand included."""
        fields = self.fields()
        out = {
            f"{self.name}.{end}": Template((HERE / f"compensation.{end}.in").read_text(encoding="utf-8")).substitute(
                fields
            )
            for end in ("h", "c")
        }
        return out | {n: (HERE / n).read_text(encoding="utf-8") for n in self.runtime}


class FloatCompensation(Written, Source):
    """In float32."""

    arithmetic, zero, fraction, scale_text = "WB_FLOAT32", "0.0f", 16, "float32"
    moved = "(float)way + (float)(part - state->part) * 1.52587890625e-05f"
    placing = "(float)wb_signed(state->encoder.origin + (uint32_t)state->encoder.position)"
    limited = "wb_lowf(wb_highf(force, -table->head.limit), table->head.limit)"
    looked = """static float looked(const float *k, uint32_t n, float x)
{
    uint32_t low = 0u, high = n - 1u;
    const float at = (x < k[0]) ? k[0] : (k[n - 1u] < x) ? k[n - 1u] : x;
    while (high - low > 1u) {
        const uint32_t middle = (low + high) / 2u;
        if (k[middle] <= at) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return k[n + low] + k[2u * n + low] * (at - k[low]);
}
"""

    def __init__(self, made: Compensation, name: str = "compensation"):
        self.setup(made, name)

    @property
    def force_unit(self) -> str:
        return self.effort

    def shift(self, table: str) -> str:
        return ""


class FixedCompensation(Written, FixedSource):
    """In fixed point, with the scales of one compensation's numbers."""

    arithmetic, zero = "WB_FIXED", "0"
    placing = f"wb_within(wb_signed(state->encoder.origin + (uint32_t)state->encoder.position), {REACH})"
    looked = """static int32_t looked(const int32_t *k, uint32_t n, int32_t x, int shift)
{
    uint32_t low = 0u, high = n - 1u;
    const int32_t at = wb_min(wb_max(x, k[0]), k[n - 1u]);
    while (high - low > 1u) {
        const uint32_t middle = (low + high) / 2u;
        if (k[middle] <= at) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return k[n + low] + wb_times(k[2u * n + low], at - k[low], shift);
}
"""

    def __init__(self, made: Compensation, scales: Scales, name: str = "compensation"):
        self.setup(made, name)
        self.own, self.typed = scales, {"observe": scales.observe, "act": scales.act}
        self.scales = SimpleNamespace(row=scales.row, result=lambda n: scales.result(scales.act, n))

    @property
    def scale_text(self) -> str:
        return self.own.text

    @property
    def fraction(self) -> int:
        return self.own.fraction

    @property
    def moved(self) -> str:
        return f"way * {1 << self.fraction} + (part - state->part)"

    @property
    def limited(self) -> str:
        most = int(self.made.limit * 2.0**self.own.limit.bits)
        return f"wb_within(force, {most})"

    @property
    def force_unit(self) -> str:
        return f"{self.effort} 2^-{self.own.limit.bits}"

    def shift(self, table: str) -> str:
        return f", {self.own.shift(table)}"
