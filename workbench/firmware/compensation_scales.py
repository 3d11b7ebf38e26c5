"""The numbers of a compensation's firmware in float32 and in fixed point: formats that hold whatever comes in."""

from dataclasses import dataclass
from functools import cached_property
from math import ceil, log2

import numpy as np

from workbench.errors import WorkbenchError
from workbench.firmware import interval
from workbench.firmware.compensation import FORCE, SEEN, Compensation
from workbench.firmware.fixed import WHOLE, Format, Typed, envelope, fitting
from workbench.firmware.numbers import FAR, MARGIN
from workbench.firmware.scales import REACH, stored

FRACTION = 16  # bits of a count beyond the whole ones, of a reference that is finer than the encoder
TRIES = 80  # passes until the states' intervals hold still: a delay line of 64 samples hands them on one a pass


@dataclass(frozen=True, eq=False)
class Scales:
    """Formats of a compensation in fixed point."""

    made: Compensation

    @cached_property
    def jump(self) -> int:
        """Counts a sample that are no motion any more: of an encoder as for its law, of a reference a step of any size."""
        c = self.made
        if c.compensator.source != "measured":
            return FAR
        return int(min(max(MARGIN * c.speed / c.count * c.loop.sample_time, 64.0), FAR))

    @cached_property
    def fraction(self) -> int:
        """Bits of a count that the way since the last sample keeps."""
        return min(FRACTION, WHOLE - 1 - ceil(log2(self.jump + 1)))

    @cached_property
    def constants(self) -> tuple[Format, ...]:
        return tuple(envelope(float(v)) for v in self.made.values)

    @cached_property
    def limit(self) -> Format:
        return envelope(self.made.limit)

    @cached_property
    def observe(self) -> Typed:
        return self.typed(self.made.observe, {"gap": fitting(-0.5, 0.5), "vh": self.speed, "before": self.speed})

    @cached_property
    def speed(self) -> Format:
        top = 2.0 ** ceil(log2(MARGIN * self.made.speed))
        return fitting(-top, top)

    @cached_property
    def act(self) -> Typed:
        """The stage of the effects, with their states' formats: from nothing on, until no interval grows."""
        own = [n for n in self.made.act.outputs if n != FORCE]
        found = dict.fromkeys(own, (0.0, 0.0))
        for _ in range(TRIES):
            typed = self.typed(self.made.act, {n: fitting(*v) for n, v in found.items()})
            after = dict(zip(typed.part.outputs, typed.part.program.outputs[0], strict=True))
            wider = {n: interval.union(v, typed.interval(after[n])) for n, v in found.items()}
            if wider == found:
                return typed
            grown = next(n for n in own if wider[n] != found[n])
            found = wider
        raise WorkbenchError(
            f"state '{grown}' of this compensation has no bound that arithmetic shows; export it in float32."
        )

    def typed(self, part, states: dict[str, Format]) -> Typed:
        rows = {n: self.given(n, states) for n in part.rows}
        inputs = {f"i0_{j}": rows[n] for j, n in enumerate(part.rows)}
        inputs |= {f"i1_{j}": self.constants[k] for j, k in enumerate(part.constants)}
        top = self.limit.high
        bounds = {"v": self.speed.high, "vh": self.speed.high, "comp_smooth": top}
        return Typed(part, inputs, bounds)

    def given(self, name: str, states: dict[str, Format]) -> Format:
        """The format of a row: a state, what was observed, the way, the place, or what a table says."""
        if name in states:
            return states[name]
        if name in SEEN:
            return self.result(self.observe, name)
        if name in self.made.tables:
            return self.value(name)
        top = float(self.jump)
        return Format(self.fraction, -top, top) if name == "moved" else Format(0, -REACH, REACH)

    def row(self, name: str) -> Format:
        """The format of anything that is kept from sample to sample."""
        if name in self.made.observe.outputs:
            return {"gap": fitting(-0.5, 0.5), "vh": self.speed, "before": self.speed}.get(name) or self.result(
                self.observe, name
            )
        if name in self.made.act.rows:
            return self.act.values[f"i0_{self.made.act.rows.index(name)}"].format
        return self.result(self.act, name)

    def result(self, typed: Typed, name: str) -> Format:
        """The format of a stage's output; of the force that of the law's `added`."""
        if name == FORCE:
            return Format(self.limit.bits, -self.limit.high, self.limit.high)
        return typed.format(typed.part.program.outputs[0][typed.part.outputs.index(name)])

    def value(self, table: str) -> Format:
        size = float(np.abs(self.made.tables[table].values).max())
        top = 2.0 ** ceil(log2(size))
        return fitting(-top, top)

    def over(self, table: str) -> Format:
        """The format of what a table is looked up over."""
        return Format(0, -REACH, REACH) if self.made.over(table) == "place" else self.row("v")

    def slope(self, table: str) -> Format:
        """The format of a table's slopes, and so the shift of what they are multiplied with, 0 to 62."""
        curve, value, over = self.made.tables[table], self.value(table), self.over(table)
        size = max(float(np.abs(curve.slopes).max()), 1e-30)
        bits = min(WHOLE - ceil(log2(size)), 62 + value.bits - over.bits)
        return Format(max(bits, value.bits - over.bits), -size, size)

    def shift(self, table: str) -> int:
        return self.slope(table).bits + self.over(table).bits - self.value(table).bits

    @cached_property
    def text(self) -> str:
        """What belongs to the identity of a compensation: every format and bound."""
        rows = dict.fromkeys((*self.made.observe.rows, *self.made.act.rows, *self.made.states))
        kept = {n: self.row(n) if n in self.made.states else self.given(n, {}) for n in rows}
        tables = [(n, self.value(n), self.over(n), self.slope(n)) for n in self.made.tables]
        return "\n".join(map(str, (*kept.items(), *self.constants, *tables, self.limit)))

    def words(self) -> np.ndarray:
        """Return every number of the table as int32: constants, then knots, values and slopes of each table."""
        out = [int(stored(v, f)) for v, f in zip(self.made.values, self.constants, strict=True)]
        for n, c in self.made.tables.items():
            for values, form in ((c.knots, self.over(n)), (c.values, self.value(n)), (c.slopes, self.slope(n))):
                out += stored(values, form).tolist()
        return np.array(out, np.int32)


def real_words(made: Compensation) -> np.ndarray:
    """Return every number of the table as float32, in the same order."""
    parts = [made.values]
    for c in made.tables.values():
        parts += [c.knots, c.values, c.slopes]
    return np.concatenate(parts).astype(np.float32)


def offsets(made: Compensation) -> dict[str, int]:
    """Return table -> where its knots begin among the numbers."""
    out, at = {}, made.values.size
    for n, c in made.tables.items():
        out[n] = at
        at += 3 * c.knots.size
    return out
