"""The formats of a fixed-point firmware: of every signal, constant and column, from the bounds of physics and of arithmetic."""

from dataclasses import dataclass
from functools import cached_property
from math import ceil, log2

import numpy as np

from workbench.errors import WorkbenchError
from workbench.firmware.fixed import WHOLE, Format, Typed, envelope, fitting
from workbench.firmware.numbers import FAR, Numbers
from workbench.firmware.parts import Part
from workbench.firmware.stages import ADDED, COMMAND, INCREMENT
from workbench.simulation.given import REFERENCE
from workbench.simulation.sampled import AMPLITUDE

REACH = 2**24  # counts: how far a target, a turn or a second encoder is told from the origin; WB_REACH of wb_runtime.h
GAIN = 18  # bits of a gain beside its sign. With 15, steps landed 2.3 counts elsewhere than in float64, for small gains far
# below the largest had 11 left; with more, the way between two knots would have less than the 12 bits that it has beside them
RINGS = 8.0  # times the limit that a notch's memory holds, as its input is not limited yet; half cuts off a hard start
FINEST = 64  # units of the amplitude between two knots, at least


@dataclass(frozen=True, eq=False)
class Scales:
    """Formats for the numbers of one controller."""

    numbers: Numbers

    @property
    def both(self) -> bool:
        return self.numbers.stages.both

    def row(self, name: str) -> Format:
        """The format of a state, an input or a gain."""
        n = self.numbers
        speed = 2.0 ** ceil(log2(n.speed))
        limit, jump = self.limit.high, 2.0 ** ceil(log2(n.jump))
        known = {
            "way": Format(0, -1.0, 1.0),
            "share": Format(1, 0.5, 1.0),
            "law.held": fitting(0.0, float(self.travel)),
            "law.integral": fitting(-limit, limit),
            ADDED: Format(self.limit.bits, -limit, limit),
            "now.y": Format(0, -REACH, REACH) if self.both else Format(0, -2.0 * FAR, 2.0 * FAR),
            REFERENCE: Format(0, -2.0 * REACH, 2.0 * REACH),
            INCREMENT: Format(0, -jump, jump),
        }
        if name in known:
            return known[name]
        if name.startswith("gain."):
            return self.column(name.removeprefix("gain."))
        if name.split(".")[-1] in ("vh", "asked_rate"):
            return fitting(-speed, speed)
        if name.startswith(("law.first", "law.second", "law.notch_")):  # memories of a notch
            return fitting(-RINGS * limit, RINGS * limit)
        if self.both and name in ("motor.y", "load.y", "furthest", "turned"):
            return Format(5, -2.0 * REACH, 2.0 * REACH) if "." in name else Format(4, -4.0 * REACH, 4.0 * REACH)
        return Format(0, -REACH, REACH)

    @cached_property
    def travel(self) -> int:
        """Counts from the reading at which a target is cut off."""
        return 2 ** ceil(log2(self.numbers.travel))

    @cached_property
    def limit(self) -> Format:
        return envelope(self.numbers.limit)

    @cached_property
    def constants(self) -> tuple[Format, ...]:
        return tuple(envelope(float(v)) for v in self.numbers.values)

    def column(self, name: str) -> Format:
        """The format of a column of gains, 19 bits with the sign."""
        values = self.numbers.columns[name]
        largest = float(np.max(np.abs(values)))
        top = 2.0 ** ceil(log2(largest)) if largest > 0.0 else 1.0
        return Format(GAIN - ceil(log2(top)), -top if (values < 0.0).any() else 0.0, top)

    @cached_property
    def bounds(self) -> dict[str, float]:
        """C name of a value -> what physics allows of it: the motion of a sample, the speed, the error told apart."""
        n = self.numbers
        speed = 2.0 ** ceil(log2(n.speed))
        travel = float(self.travel)
        jumps = dict.fromkeys(("motor_increment", "load_increment"), 2.0 ** ceil(log2(n.jump)))
        return {"error": travel, "vh": speed, "asked_rate": speed, "motor_vh": speed, **jumps}

    def typed(self, part: Part) -> Typed:
        inputs = {f"i0_{j}": self.row(n) for j, n in enumerate(part.rows)}
        inputs |= {f"i1_{j}": self.constants[place] for j, place in enumerate(part.constants)}
        return Typed(part, inputs, self.bounds, {"error"})  # the target is cut off as far away

    @cached_property
    def parts(self) -> tuple[Typed, Typed, Typed]:
        """Start, observe and command."""
        s = self.numbers.stages
        return self.typed(s.start), self.typed(s.observe), self.typed(s.command)

    def result(self, name: str) -> Format:
        """The format of what a stage hands on: the command, or the amplitude."""
        typed = self.parts[2] if name == COMMAND else self.parts[1]
        return typed.format(typed.part.program.outputs[0][typed.part.outputs.index(name)])

    @cached_property
    def amplitude(self) -> tuple[int, int, int]:
        """(bits of the amplitude in SI, bits of its factor, shift) of N = factor * amplitude >> shift.

        N counts 2^-bits rad or m (rad/s, m/s): the last knot fills 30 bits.
        """
        last, first = float(self.numbers.knots[-1]), float(self.numbers.knots[0])
        bits = WHOLE - 1 - ceil(log2(last))
        if first * 2.0**bits < FINEST * self.numbers.per_octave:
            raise WorkbenchError(
                f"the table's knots reach from {first:.3g} to {last:.3g}, which is too wide for fixed point: its amplitudes "
                f"have 30 bits, and between two knots {FINEST} have to fit. Leave the lowest or the highest out."
            )
        factor = envelope(self.numbers.count)
        shift = factor.bits + self.result(AMPLITUDE).bits - bits
        if not 2 <= shift <= 32:
            raise WorkbenchError(
                f"an encoder count of {self.numbers.count:.3g} does not fit knots that end at {last:.3g} in fixed point."
            )
        return bits, factor.bits, shift

    @property
    def amplitude_factor(self) -> int:
        return round(self.numbers.count * 2.0 ** self.amplitude[1])

    @cached_property
    def text(self) -> str:
        """What belongs to a law's identity: every format and bound."""
        s = self.numbers.stages
        said = [f"{n} {self.row(n)}" for p in (s.start, s.observe, s.command) for n in p.rows]
        said += [f"{c.formula} {f}" for c, f in zip(s.constants, self.constants, strict=True)]
        said += [f"{n} {b}" for n, b in self.bounds.items()]
        return "\n".join(said + ([f"amplitude {self.amplitude} {self.amplitude_factor}"] if s.columns else []))


def stored(value, form: Format) -> np.ndarray:
    """Real values in a format, rounded to nearest, as int64."""
    return np.rint(np.asarray(value, dtype=float) * 2.0**form.bits).astype(np.int64)
