"""A law's firmware as C99: the generated header and source, from the same programs that the reference runs."""

from collections.abc import Mapping
from pathlib import Path
from string import Template

from workbench import control
from workbench.firmware.identity import law_code
from workbench.firmware.naming import identifier
from workbench.firmware.parts import Stages
from workbench.firmware.shared import interpolated
from workbench.firmware.stage_text import StageText, commented
from workbench.firmware.stages import COMMAND, POSITIONS
from workbench.firmware.units import unit
from workbench.simulation.sampled import AMPLITUDE

HERE = Path(__file__).parent
MOST_KNOTS = 64  # memory that a header sets aside where no table says how many


def _formula_of(stages: Stages) -> str:
    """Return the law's formula: the first sentence of the function that makes such controllers."""
    maker = getattr(control, stages.law.name.split(",")[0])
    return maker.__doc__.split("\n")[0].strip()


class Source(StageText):
    """The C of one law. name: of files and, behind "wb_", of functions. knots: memory for the table. effort: "N*m" or "N"."""

    template = "law_float.c.in"
    runtime: tuple[str, ...] = ("wb_runtime.h", "wb_runtime.c", "wb_root.c")
    include = "wb_runtime.h"
    end = "WB_END"  # where an axis of two encoders stops

    def __init__(self, stages: Stages, name: str, knots: int = MOST_KNOTS, effort: str = "N*m"):
        super().__init__(stages, f"wb_{name}", effort)
        self.name, self.knots = name, knots if stages.columns else 0

    @property
    def rows(self) -> int:
        return 2 * len(self.stages.columns)

    def given(self) -> dict[str, str]:
        """What is handed to the stages: row -> C text in start and step."""
        real = {"now.y": "y", "increment": "(float)way", "reference": "reference", "added": "wb_givenf(now->added)"}
        return real | dict.fromkeys(("now.motor.y", "now.load.y"), "(float)wb_signed(now->other)")

    def step(self) -> str:
        """The body of the step."""
        given = self.given()
        seen = self.call(self.stages.observe, "observe", given)
        y = "now.y" in (*self.stages.observe.rows, *self.stages.command.rows)
        lines = ["int32_t way;", *["float y;"] * y, "float reference;"]
        if self.stages.columns:
            lines += [
                "float amplitude;",
                "float beyond;",
                "int within;",
                "uint32_t i;",
                *(f"float {n};" for n in self.stages.columns),
            ]
        within = f" || !wb_encoder_within(&state->encoder, {self.end})" if self.stages.both else ""
        follow = "!wb_encoder_follow(&state->encoder, &table->head, now->position, &way)"
        lines += [f"if ({follow}{within}) {{", "    return 0.0f;", "}"]
        lines += ["y = (float)state->encoder.position;"] * y
        lines += ["reference = (float)wb_signed((uint32_t)now->reference - state->encoder.origin);"]
        if self.stages.columns:
            lines += [f"amplitude = {seen} * table->head.count;", "i = wb_segment(&table->head, amplitude, &within);"]
            lines += ["beyond = within ? amplitude - table->knot[i] : 0.0f;"]
            for j, n in enumerate(self.stages.columns):
                lines += [f"{n} = {interpolated(f'table->row[{2 * j}][i]', f'table->row[{2 * j + 1}][i]')};"]
                given[f"gain.{n}"] = n
        else:
            lines += [f"{seen};"]
        lines += self.ending(given, "{0} - y")
        return "\n".join(f"    {x}" for x in lines) + "\n"

    def ending(self, given: Mapping[str, str], lowered: str) -> list[str]:
        """Command, and move the origin along; that of two encoders does not move. lowered: text of a position {0} from there."""
        decided = self.call(self.stages.command, "command", given)
        if self.stages.both:
            return [f"return {decided};"]
        moved = [f"state->{identifier(n)}" for n in self.stages.states if n in POSITIONS]
        lines = [
            "if (wb_encoder_recentre(&state->encoder)) {",
            *(f"    {n} = {lowered.format(n)};" for n in moved),
            "}",
        ]
        if not moved:
            lines = ["(void)wb_encoder_recentre(&state->encoder);"]
        return ["{", f"    const {self.kind} u_c = {decided};", *(f"    {x}" for x in lines), "    return u_c;", "}"]

    def begin(self) -> str:
        """The arguments of the first stage."""
        given = self.given() | {
            "now.y": "(float)state->encoder.position",
            "reference": "(float)wb_signed((uint32_t)now->reference - state->encoder.origin)",
        }
        return self.call(self.stages.start, "begin", given)

    def fields(self) -> dict:
        """Return what the templates are filled with."""
        stages, p = self.stages, self.p
        other = ("    uint32_t other;     /* reading of the other encoder [its counts] */\n") if stages.both else ""
        return {
            "title": f"{stages.law.name}, {self.said}",
            "said": self.said,
            "formula": _formula_of(stages),
            "p": p,
            "P": p.upper(),
            "header": f"{self.name}.h",
            "law": f"{self.code():08X}",
            "numbers": len(stages.constants),
            "rows": self.rows,
            "knots": self.knots,
            "number": self.number_type,
            "states": "\n".join(self.state_lines()),
            "other": other,
            "unit": self.effort,
            "added_unit": self.effort,
            "added_said": "; a NaN is 0",
            "command_said": "",
            "include": self.include,
            "factor": "",
            "spare": "",
            "enumeration": self.enumeration(),
            "row_index": "    uint32_t j;\n" if stages.columns else "",
            "load_rows": self.load_rows(),
            "functions": "\n\n".join(self.functions()) + "\n",
            "origin": "0u" if stages.both else "now->position",
            "begin": self.begin(),
            "step": self.step(),
        }

    said = "float32"
    number_type = "float"

    def code(self) -> int:
        return law_code(self.stages)

    def state_lines(self) -> list[str]:
        return [commented(f"{self.number_type} {identifier(n)};", self.unit_of(n)) for n in self.stages.states]

    def enumeration(self) -> str:
        constants = self.stages.constants
        lines = [f"{c.identifier.upper()}{',' if i + 1 < len(constants) else ' '} /* {c.formula} [{unit(c.power, self.effort)}] */"
                 for i, c in enumerate(constants)]  # fmt: skip
        return "\n".join(f"    {x}" for x in lines)

    def load_rows(self) -> str:
        if not self.stages.columns:
            return ""
        words = "table->head.rows_at + 4u * (j * table->head.knots + i)"
        lines = ["for (i = 0u; i < table->head.knots; ++i) {",
                 "    table->knot[i] = wb_real(wb_u32(bytes + table->head.knots_at + 4u * i));",
                 f"    for (j = 0u; j < {self.p.upper()}_ROWS; ++j) {{",
                 f"        table->row[j][i] = {self.read(f'wb_u32(bytes + {words})')};",
                 "    }", "}"]  # fmt: skip
        return "\n".join(f"    {x}" for x in lines) + "\n"

    def read(self, word: str) -> str:
        return f"wb_real({word})"

    def functions(self) -> list[str]:
        s = self.stages
        return [
            self.function(s.start, "begin", None),
            self.function(s.observe, "observe", AMPLITUDE if s.columns else None),
            self.function(s.command, "command", COMMAND),
        ]

    def vectors(self) -> dict[str, str]:
        """Return the test bench: file name -> text."""
        read, write = self.words
        other = "    now.other = in[1];\n" if self.stages.both else ""
        names = [identifier(n) for n in self.stages.states]
        fields = {
            "p": self.p, "header": f"{self.name}.h", "read": read, "write": write, "other": other,
            "set": "".join(f"    state.{n} = {read}(in[{3 + i}]);\n" for i, n in enumerate(names)),
            "get": "".join(f"    out[{3 + i}] = {write}(state.{n});\n" for i, n in enumerate(names)),
        }  # fmt: skip
        return {"vectors.c": Template((HERE / "vectors.c.in").read_text(encoding="utf-8")).substitute(fields)}

    words = ("wb_real", "wb_bits")

    def files(self) -> dict[str, str]:
        """Return file name -> text of everything that a firmware compiles, the part by hand included."""
        fields = self.fields()
        made = {
            f"{self.name}.h": Template((HERE / "law.h.in").read_text(encoding="utf-8")).substitute(fields),
            f"{self.name}.c": Template((HERE / self.template).read_text(encoding="utf-8")).substitute(fields),
        }
        return made | {n: (HERE / n).read_text(encoding="utf-8") for n in self.runtime}
