"""The firmware in integers, with NumPy: what the fixed-point C is held to, bit for bit."""

import numpy as np

from workbench.firmware.fixed import Typed
from workbench.firmware.numbers import Numbers
from workbench.firmware.parts import Part
from workbench.firmware.reference import WIDE, Axes, Reference, signed
from workbench.firmware.scales import GAIN, REACH, Scales, stored
from workbench.firmware.stages import COMMAND, INCREMENT
from workbench.simulation.given import REFERENCE

MOST = 2**30


def _over(a, b, up):
    """a 2^up / b towards zero, within +-2^30."""
    above, below = np.asarray(a, WIDE) << up, np.where(np.asarray(b) == 0, 1, b)
    sign = np.where((above < 0) != (below < 0), -1, 1)
    return np.minimum(np.abs(above) // np.abs(below), MOST) * sign


def _root(a, up):
    """The square root of a 2^up, downwards."""
    whole = np.where(np.asarray(a) > 0, a, 0) << up
    found = np.floor(np.sqrt(whole.astype(float))).astype(WIDE)
    found = np.where(found * found > whole, found - 1, found)
    return np.where((found + 1) * (found + 1) <= whole, found + 1, found)


HELPERS = {
    "wb_right": lambda a, by: a >> by,
    "wb_left": lambda a, by: a * (1 << by),
    "wb_times": lambda a, b, by: (a * b) >> by,
    "wb_over": _over,
    "wb_root": _root,
    "wb_min": np.minimum,
    "wb_max": np.maximum,
    "wb_size": np.abs,
    "wb_within": lambda a, most: np.clip(a, -most, most),
    "wb_choose": np.where,
    "wb_truth": lambda a: np.asarray(a).astype(WIDE),
    "wb_not": np.logical_not,
    "wb_and": np.logical_and,
    "wb_or": np.logical_or,
}


def compiled(typed: Typed, formats: dict):
    """Return f(rows, constants) -> (outputs, every value) of a typed part. formats: output -> the format it is kept in."""
    part, names = typed.part, {n: n for n in typed.values}
    source = ["def run(i0, i1):"]
    source += [f"    i0_{j} = i0[{j}]" for j in range(len(part.rows))]
    source += [f"    i1_{j} = i1[{j}]" for j in range(len(part.constants))]
    source += [f"    {v.out} = {v.text.format(**names)}" for v in typed.lines]
    outputs = []
    for name, value in zip(part.outputs, part.program.outputs[0], strict=True):
        text = typed.output(value, formats[name]) if name in formats else typed._at(value, typed.format(value).bits)
        outputs.append(text.format(**names))
    source.append(f"    return [{', '.join(outputs)}], [{', '.join(v.out for v in typed.lines)}]")
    scope = dict(HELPERS)
    exec(compile("\n".join(source), f"<{part.name}>", "exec"), scope)  # noqa: S102 - our own generated text
    return scope["run"]


class FixedReference(Reference):
    """The firmware of a controller in fixed point. States and commands are int32 of the formats in `scales`."""

    dtype, end = np.int32, REACH

    def __init__(self, numbers: Numbers):
        self.numbers, self.stages, self.scales = numbers, numbers.stages, Scales(numbers)
        values = zip(numbers.values, self.scales.constants, strict=True)
        self.constants = np.array([stored(v, f) for v, f in values], WIDE)
        down = self.scales.limit.bits - self.scales.result(COMMAND).bits
        unit = 2 ** max(down, 0)  # of the command: so that its limit is the same on both sides
        self._limited(lambda v, place: int(abs(v) * 2.0 ** self.scales.constants[place].bits) // unit * unit)
        self.limit = int(self.constants[self.stages.place("limit")])
        self.rows = [
            np.clip(stored(c, self.scales.column(n)), -(2**GAIN) + 1, 2**GAIN - 1) for n, c in numbers.columns.items()
        ]
        kept = {n: self.scales.row(n) for n in self.stages.states}
        self.last: dict[str, list] = {}  # part -> every value of its latest step
        self._functions = {typed.part.name: compiled(typed, kept) for typed in self.scales.parts}

    def format(self, name: str):
        return self.scales.result(name) if name == COMMAND else self.scales.row(name)

    def stored(self, name: str, value) -> np.ndarray:
        form = self.format(name)
        return stored(np.clip(np.asarray(value, dtype=float), form.low, form.high), form).astype(np.int32)

    def real(self, name: str, value) -> np.ndarray:
        return np.asarray(value, dtype=float) * 2.0 ** -self.format(name).bits

    def _run(self, part: Part, inputs: dict) -> dict[str, np.ndarray]:
        rows = [np.asarray(inputs[n], WIDE) for n in part.rows]
        found, self.last[part.name] = self._functions[part.name](rows, self.constants[list(part.constants)])
        shape = np.shape(inputs[REFERENCE])
        return {n: np.broadcast_to(x, shape).astype(WIDE) for n, x in zip(part.outputs, found, strict=True)}

    def _inputs(self, axes: Axes, other, reference) -> dict:
        y = np.clip(axes.position, -REACH, REACH)
        away = signed(np.asarray(reference, np.uint32) - axes.origin - (y & 0xFFFFFFFF).astype(np.uint32))
        made = {REFERENCE: y + np.clip(away, -self.scales.travel, self.scales.travel), "now.y": y}
        made[INCREMENT] = axes.way
        if self.stages.both:
            name = "now.load.y" if self.stages.feedback == "position" else "now.motor.y"
            made[name] = np.clip(signed(other), -REACH, REACH)
        return made

    def _lowered(self, value: np.ndarray, by: np.ndarray) -> np.ndarray:
        return np.where(by != 0, np.clip(value - by, -REACH, REACH), value)

    def _bounded(self, added) -> np.ndarray:
        return np.clip(np.asarray(added, WIDE), -self.limit, self.limit)

    def look_up(self, amplitude: np.ndarray) -> list[np.ndarray]:
        if not self.stages.columns:
            return []
        bits, _, shift = self.scales.amplitude
        n = (amplitude * self.scales.amplitude_factor) >> shift
        shown = np.minimum(n, MOST) | 1
        step = self.numbers.per_octave.bit_length() - 1
        exponent = np.frexp(shown.astype(float))[1] - 1
        word = shown << (31 - exponent)
        head = self.numbers.knots[:1].astype(np.float32).view(np.uint32)[0]
        i = ((exponent + 127 - bits) << step) + ((word >> (31 - step)) & ((1 << step) - 1)) - int(head >> (23 - step))
        into = (word >> (19 - step)) & 0xFFF
        last = self.numbers.knots.size - 1
        into = np.where((i < 0) | (i >= last), 0, into)
        i = np.clip(i, 0, last)
        after = np.minimum(i + 1, last)
        return [row[i] + (((row[after] - row[i]) * into) >> 12) for row in self.rows]
