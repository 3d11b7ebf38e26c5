"""A compensation's firmware in Python, in both arithmetics: what the C is held to, bit for bit."""

from dataclasses import dataclass

import numpy as np

from workbench.firmware.compensation import FORCE, Compensation
from workbench.firmware.compensation_scales import FRACTION, Scales, offsets, real_words
from workbench.firmware.fixed_reference import compiled
from workbench.firmware.reference import signed
from workbench.firmware.scales import REACH
from workbench.kernel import single

F, U, WIDE = np.float32, np.uint32, np.int64


@dataclass(eq=False)
class Axes:
    """n axes: states by name, the position that was followed last and its fraction, and whether it has jumped."""

    state: dict[str, np.ndarray]
    position: np.ndarray
    part: np.ndarray
    fault: np.ndarray


class FloatReference:
    """In float32."""

    dtype, fraction = F, FRACTION

    def __init__(self, made: Compensation, scales: Scales):
        self.made, self.scales = made, scales
        self.words = real_words(made)

    def start(self, position, fraction=0) -> Axes:
        """Return axes at rest at positions (n,) in counts, modulo 2^32."""
        position = np.atleast_1d(np.asarray(position, U))
        states = {n: np.zeros(position.shape, self.dtype) for n in self.made.states}
        return Axes(states, position, self._part(fraction, position.shape), np.zeros(position.shape, bool))

    def _part(self, fraction, shape) -> np.ndarray:
        return np.broadcast_to((np.asarray(fraction, WIDE) & 65535) >> (FRACTION - self.fraction), shape)

    def _moved(self, way: np.ndarray, parts: np.ndarray) -> np.ndarray:
        return way.astype(F) + parts.astype(F) * F(2.0**-FRACTION)

    def _place(self, position: np.ndarray) -> np.ndarray:
        return signed(position).astype(F)

    def _run(self, part, rows: dict) -> dict:
        found = single.evaluate(part.program, [rows[n] for n in part.rows], self.words[list(part.constants)])[0]
        shape = next(iter(rows.values())).shape
        return {n: np.broadcast_to(x, shape).astype(F) for n, x in zip(part.outputs, found, strict=True)}

    def _limited(self, force: np.ndarray) -> np.ndarray:
        most = F(self.made.limit)
        return np.where(np.where(force >= -most, force, -most) <= most, np.where(force >= -most, force, -most), most)

    def _line(self, table: str, value, slope, over) -> np.ndarray:
        return value + slope * over

    def look_up(self, table: str, x: np.ndarray) -> np.ndarray:
        """Return what a table says at x, in the arithmetic of the firmware."""
        at, n = offsets(self.made)[table], self.made.tables[table].knots.size
        knots, values, slopes = (self.words[at + k * n : at + (k + 1) * n] for k in range(3))
        x = np.clip(x, knots[0], knots[-1])
        i = np.clip(np.searchsorted(knots, x, side="right") - 1, 0, n - 2)
        return self._line(table, values[i], slopes[i], x - knots[i])

    def step(self, axes: Axes, position, fraction=0) -> np.ndarray:
        """Move every axis by one sample, and return the forces (n,); those of axes that have jumped are zero."""
        position = np.broadcast_to(np.asarray(position, U), axes.position.shape)
        way = signed(position - axes.position)
        axes.fault = axes.fault | (np.abs(way) > self.scales.jump)
        part = self._part(fraction, position.shape)
        rows = dict(axes.state) | {"moved": self._moved(way, part - axes.part), "place": self._place(position)}
        seen = self._run(self.made.observe, rows)
        rows |= seen
        for name in self.made.tables:
            rows[name] = self.look_up(name, rows["place" if self.made.over(name) == "place" else "v"])
        after = seen | self._run(self.made.act, rows)
        kept = ~axes.fault
        axes.state = {n: np.where(kept, after[n], x).astype(self.dtype) for n, x in axes.state.items()}
        axes.position, axes.part = np.where(kept, position, axes.position), np.where(kept, part, axes.part)
        return np.where(kept, self._limited(after[FORCE]), 0).astype(self.dtype)

    def real(self, force: np.ndarray) -> np.ndarray:
        """Return forces in N*m or N, float64."""
        return np.asarray(force, dtype=float)


class FixedReference(FloatReference):
    """In integers."""

    dtype = np.int32

    def __init__(self, made: Compensation, scales: Scales):
        self.made, self.scales, self.words = made, scales, scales.words().astype(WIDE)
        self.fraction = scales.fraction
        kept = {n: scales.row(n) for n in made.states} | {FORCE: scales.result(scales.act, FORCE)}
        self._functions = {t.part.name: compiled(t, kept) for t in (scales.observe, scales.act)}

    def _moved(self, way: np.ndarray, parts: np.ndarray) -> np.ndarray:
        return way * (1 << self.fraction) + parts

    def _place(self, position: np.ndarray) -> np.ndarray:
        return np.clip(signed(position), -REACH, REACH)

    def _run(self, part, rows: dict) -> dict:
        given = [np.asarray(rows[n], WIDE) for n in part.rows]
        found, _ = self._functions[part.name](given, self.words[list(part.constants)])
        shape = next(iter(rows.values())).shape
        return {n: np.broadcast_to(x, shape).astype(WIDE) for n, x in zip(part.outputs, found, strict=True)}

    def _limited(self, force: np.ndarray) -> np.ndarray:
        most = int(self.made.limit * 2.0**self.scales.limit.bits)
        return np.clip(force, -most, most)

    def _line(self, table: str, value, slope, over) -> np.ndarray:
        return value + ((slope * over) >> self.scales.shift(table))

    def real(self, force: np.ndarray) -> np.ndarray:
        return np.asarray(force, dtype=float) * 2.0**-self.scales.limit.bits
