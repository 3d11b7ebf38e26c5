"""The firmware in Python, in float32 and over any number of axes side by side: what the C is held to, bit for bit.

Written from the same programs and, for what is by hand in wb_runtime.c, apart from it in NumPy.
"""

from dataclasses import dataclass

import numpy as np

from workbench.firmware.numbers import FAR, Numbers
from workbench.firmware.parts import Part
from workbench.firmware.stages import ADDED, COMMAND, INCREMENT, POSITIONS
from workbench.kernel import single
from workbench.schedule.tables import slopes
from workbench.simulation.given import REFERENCE
from workbench.simulation.sampled import AMPLITUDE

F, U, WIDE = np.float32, np.uint32, np.int64
END = 2**30  # WB_END


@dataclass(eq=False)
class Axes:
    """n axes. state: name -> (n,). origin: uint32; position: counts from it; fault: bool."""

    state: dict[str, np.ndarray]
    origin: np.ndarray
    position: np.ndarray
    fault: np.ndarray
    way: np.ndarray | None = None  # counts since the last sample


def signed(word: np.ndarray) -> np.ndarray:
    """uint32 as two's complement, int64."""
    return np.asarray(word, U).astype(WIDE) - ((np.asarray(word, U) >> U(31)).astype(WIDE) << 32)


class Reference:
    """The firmware of a controller. constants, slopes: what the table holds, in float32."""

    dtype, end = F, END

    def __init__(self, numbers: Numbers):
        self.numbers, self.stages = numbers, numbers.stages
        self.constants = numbers.values.astype(F)
        self.knots = numbers.knots.astype(F)
        self.rows = _rows(numbers)
        self._limited(lambda v, place: _downwards(abs(v)))

    def _limited(self, rounded) -> None:
        """Round the limit towards zero, so that no command is beyond it."""
        for place, c in enumerate(self.stages.constants):
            if c.formula in ("limit", "-limit"):
                v = self.numbers.values[place]
                self.constants[place] = rounded(v, place) * (1 if v >= 0.0 else -1)

    def stored(self, name: str, value) -> np.ndarray:
        """Return real values of a signal or state as the firmware holds them."""
        return np.asarray(value).astype(F)

    def real(self, name: str, value) -> np.ndarray:
        """Return what the firmware holds as real numbers, float64."""
        return np.asarray(value, dtype=float)

    def _run(self, part: Part, inputs: dict) -> dict[str, np.ndarray]:
        values = [inputs[n] for n in part.rows]
        found = single.evaluate(part.program, values, self.constants[list(part.constants)])[0]
        shape = np.shape(inputs[REFERENCE])
        return {n: np.broadcast_to(x, shape).astype(F) for n, x in zip(part.outputs, found, strict=True)}

    def _inputs(self, axes: Axes, other, reference) -> dict:
        """Positions of this sample, float32, relative to the origin."""
        made = {REFERENCE: signed(np.asarray(reference, U) - axes.origin).astype(F), "now.y": axes.position.astype(F)}
        made[INCREMENT] = axes.way.astype(F)
        if self.stages.both:
            name = "now.load.y" if self.stages.feedback == "position" else "now.motor.y"
            made[name] = signed(other).astype(F)
        return made

    def start(self, raw, reference, other=0) -> Axes:
        """Return axes at rest, at the readings `raw` (n,) of the encoder that closes the loop, and of the other one."""
        raw = np.atleast_1d(np.asarray(raw, U))
        zero = np.zeros(raw.shape, WIDE)
        origin = U(0) * raw if self.stages.both else raw
        axes = Axes({}, origin, signed(raw - origin), zero != 0, zero)
        axes.state = self._run(self.stages.start, self._inputs(axes, other, reference))
        return axes

    def follow(self, axes: Axes, raw: np.ndarray) -> None:
        """Take new readings."""
        shift = U(32 - self.numbers.bits)
        way = signed((raw - axes.origin - (axes.position & 0xFFFFFFFF).astype(U)) << shift) >> int(shift)
        axes.fault = axes.fault | (np.abs(way) > self.numbers.jump)
        moved = ~axes.fault
        axes.way = np.where(moved, way, 0)
        axes.position = axes.position + axes.way
        if self.stages.both:
            axes.fault = axes.fault | (np.abs(axes.position) > self.end)

    def _recentre(self, axes: Axes) -> None:
        """Move the origin along where it is far; two encoders share one that does not move."""
        if self.stages.both:
            return
        by = np.where(~axes.fault & (np.abs(axes.position) > FAR), axes.position, 0)
        axes.origin = axes.origin + (by & 0xFFFFFFFF).astype(U)
        axes.position = axes.position - by
        for name in POSITIONS:
            if name in axes.state:
                axes.state[name] = self._lowered(axes.state[name], by)

    def _lowered(self, value: np.ndarray, by: np.ndarray) -> np.ndarray:
        return np.where(by != 0, value - by.astype(F), value)

    def _bounded(self, added) -> np.ndarray:
        return np.where(np.isnan(added), F(0.0), np.asarray(added, F))

    def look_up(self, amplitude: np.ndarray) -> list[np.ndarray]:
        """Return each column at amplitudes in counts."""
        if not self.stages.columns:
            return []
        a = (amplitude * F(self.numbers.count)).astype(F)
        shift = U(23 - (self.numbers.per_octave.bit_length() - 1))
        first, last = int(self.knots[:1].view(U)[0] >> shift), self.knots.size - 1
        i = (a.view(U) >> shift).astype(WIDE) - first
        inside = (i >= 0) & (i < last)
        i = np.clip(i, 0, last)
        beyond = np.where(inside, a - self.knots[i], F(0.0))
        return [gain[i] + slope[i] * beyond for gain, slope in zip(self.rows[::2], self.rows[1::2], strict=True)]

    def step(self, axes: Axes, raw, reference, added=0.0, other=0) -> np.ndarray:
        """Move every axis by one sample, and return the commands (n,); those of axes at fault are zero."""
        raw = np.broadcast_to(np.asarray(raw, U), axes.origin.shape)
        self.follow(axes, raw)
        inputs = axes.state | self._inputs(axes, other, reference)
        inputs[REFERENCE] = np.broadcast_to(inputs[REFERENCE], raw.shape)
        seen = self._run(self.stages.observe, inputs)
        inputs |= {n: x for n, x in seen.items() if n != AMPLITUDE}
        if AMPLITUDE in seen:
            gains = self.look_up(seen[AMPLITUDE])
            inputs |= {f"gain.{n}": x for n, x in zip(self.stages.columns, gains, strict=True)}
        inputs[ADDED] = np.broadcast_to(self._bounded(added), raw.shape)
        decided = self._run(self.stages.command, inputs)
        after = {**seen, **decided}
        kept = ~axes.fault
        axes.state = {n: np.where(kept, after.get(n, x), x) for n, x in axes.state.items()}
        self._recentre(axes)
        return np.where(kept, decided[COMMAND], 0).astype(self.dtype)


def _downwards(x: float) -> np.float32:
    near = F(x)
    return near if float(near) <= x else np.nextafter(near, F(0.0))


def _rows(numbers: Numbers) -> list[np.ndarray]:
    """Return gain and slope of each column, float32 (m,): slopes of the rounded gains, the last zero."""
    knots, out = numbers.knots.astype(F), []
    for column in numbers.columns.values():
        gain = column.astype(F)
        out += [gain, slopes(knots, gain)]
    return out
