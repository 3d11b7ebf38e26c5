"""The separable least-squares problem that a plant and some records pose.

Residual: F(chain(u) - required(q)), stacked over records without the trimmed ends. Linear in the linear parameters; the
shape parameters are searched on a scale of their own (logarithmic where the parameter is positive by nature).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import exp, log

import numpy as np

from workbench import definition as fx
from workbench.inverse.command import command_maps
from workbench.inverse.dynamics import InverseDynamics
from workbench.inverse.side_by_side import stacked
from workbench.parameter import Parameter
from workbench.plant import Plant, reads_load

LOGARITHMIC = ("speed", "stroke", "rate", "resonance", "settling")
STEP = 1e-4  # relative step of the directional derivative of a required drive
ROUNDED = (
    1e-13  # of the drive: one that changes by less with a step is one that rounding changes, and no direction to search
)


@dataclass(frozen=True)
class Name:
    """One parameter of a plant: effect key and inside name."""

    key: str
    parameter: str


def _scale_of(p: Parameter) -> float:
    """The size of one unit of the search scale where it is not logarithmic."""
    return max(abs(p.value), 1e-3 * (p.upper - p.lower) if np.isfinite(p.upper - p.lower) else 0.0, 1e-12)


def to_search(p: Parameter) -> float:
    return log(p.value) if p.scale in LOGARITHMIC else p.value


def from_search(p: Parameter, value: float) -> float:
    return float(np.clip(exp(value) if p.scale in LOGARITHMIC else value, p.lower, p.upper))


def _needed_by(plant: Plant, key: str) -> Plant:
    """Return what of a plant a change of one effect shows in: all of it, unless that is a force from which no other one reads.

    Such a force needs the maps, and what gives the direction of motion at its place. What follows the load reads them all.
    """
    if plant[key].provides or any(reads_load(e) for e in plant.effects):
        return plant
    return read_by(plant, key)


def read_by(plant: Plant, *keys: str) -> Plant:
    """Return what of a plant the own columns of effects need: all of it, unless they are forces that do not follow the load.

    Such a force needs the maps, and what gives the direction of motion at its place.
    """
    changed = [plant[key] for key in keys]
    if any(reads_load(e) or e.port != fx.FORCE for e in changed):
        return plant
    places = {e.at for e in changed}
    kept = (e for e in plant.effects if e.port != fx.FORCE or e.key in keys or (e.at in places and e.provides))
    return replace(plant, effects=tuple(kept))


class Problem:
    """`free_linear`, `free_shape`: what is searched, as Name; `fixed` linear parameters move to the measured side."""

    def __init__(self, plant: Plant, inverses: Sequence[InverseDynamics]):
        self.plant = plant
        self.present = plant  # whose linear values make the load that forces follow
        self.inverses = tuple(inverses)
        self.free_linear: list[Name] = []
        self.fixed_linear: list[Name] = []
        self.free_shape: list[Name] = []
        for e in sorted(plant.effects, key=lambda e: e.key):  # in whatever order declared, the same last bits
            for n, p in e.parameters.items():
                if n in e.linear and e.port == fx.FORCE:
                    (self.fixed_linear if p.fixed else self.free_linear).append(Name(e.key, n))
                elif not p.fixed:
                    self.free_shape.append(Name(e.key, n))

    def parameter(self, name: Name) -> Parameter:
        return self.plant[name.key].parameters[name.parameter]

    @cached_property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds of the free linear parameters."""
        free = [self.parameter(n) for n in self.free_linear]
        return np.array([p.lower for p in free]), np.array([p.upper for p in free])

    @property
    def lengths(self) -> list[int]:
        """Equations per record: samples that count, times balances. Both balances of a sample stand side by side."""
        return [(p.motion.keep.stop - p.motion.keep.start) * p.rows(self.plant) for p in self.inverses]

    def start(self) -> np.ndarray:
        return np.array([to_search(self.parameter(n)) for n in self.free_shape])

    def with_shape(self, theta: np.ndarray) -> Plant:
        """Return the plant with the free shape parameters set from their search values."""
        values: dict[str, dict[str, float]] = {}
        for n, value in zip(self.free_shape, theta, strict=True):
            values.setdefault(n.key, {})[n.parameter] = from_search(self.parameter(n), value)
        return self.present.with_values(values)

    @property
    def follows_load(self) -> bool:
        """Whether a force follows the load, which the linear parameters make: columns then depend on their values."""
        return any(reads_load(e) for e in self.plant.effects)

    def carry(self, c: np.ndarray) -> None:
        """From now on the load is that of these linear values."""
        self.present = self.with_linear(self.present, c[: len(self.free_linear)])

    def with_linear(self, plant: Plant, c: np.ndarray) -> Plant:
        """Return `plant` with the free linear parameters set."""
        values: dict[str, dict[str, float]] = {}
        for n, value in zip(self.free_linear, c, strict=True):
            p = self.parameter(n)
            values.setdefault(n.key, {})[n.parameter] = float(np.clip(value, p.lower, p.upper))
        return plant.with_values(values)

    def at(self, theta: np.ndarray, c: np.ndarray) -> Plant:
        """Return the plant with all that is free set."""
        return self.with_linear(self.with_shape(theta), c)

    def assemble(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (y (N,), Phi (N, m)): measured less fixed, and the columns of the free linear parameters, filtered."""
        plant = self.with_shape(theta)
        at = {(n.key, n.parameter): i for i, n in enumerate(self.free_linear)}
        y = np.empty(sum(self.lengths))
        phi = np.zeros((y.size, len(at)), order="F")  # a locked load has no balance: its columns stay zero there
        row = 0
        for p, length in zip(self.inverses, self.lengths, strict=True):
            keep, part = p.motion.keep, slice(row, row + length)
            y[part] = stacked(p.filtered_drive(plant), keep, p.counts)
            for e, name, column in p.filtered(plant):
                index = at.get((e.key, name))
                if index is None:
                    value = e.parameters[name].value if name else 1.0
                    if value != 0.0:
                        y[part] -= value * column
                else:
                    phi[part, index] = column
            row += length
        factor = self.command_scale(plant)
        with np.errstate(invalid="ignore"):  # a map that leaves no command: 0 times inf is no number, and its cost none
            return (y, phi) if factor == 1.0 else (y * factor, phi * factor)

    def command_scale(self, plant: Plant) -> float:
        """Return rms of the command over rms of what command maps make of it, both filtered and about each record's mean; 1
        without such maps.

        Residuals are compared as commands: else a map that attenuates everything would explain everything. A mean may be a
        weight's; a map that leaves nothing but that would explain everything still.
        """
        if not command_maps(plant):
            return 1.0
        bare = replace(plant, effects=tuple(e for e in plant.effects if e.at != "command"))
        power = [0.0, 0.0]
        for p in self.inverses:
            for k, q in enumerate((bare, plant)):
                power[k] += p.power_of_drive(q)
        return float(np.sqrt(power[0] / power[1])) if power[1] > 0.0 else np.inf

    def tangents(self, theta: np.ndarray, c: np.ndarray, y: np.ndarray, phi: np.ndarray) -> np.ndarray:
        """Return d(Phi c - y)/d theta (N, k), one directional derivative of the whole pass each."""
        base = phi @ c - y
        plant = self.with_linear(self.with_shape(theta), c[: len(self.free_linear)])
        factor = self.command_scale(plant)
        result = np.empty((y.size, theta.size), order="F")
        for k, name in enumerate(self.free_shape):
            p = self.parameter(name)
            step = STEP if p.scale in LOGARITHMIC else self.step_of(p, theta[k])
            if from_search(p, theta[k] + step) >= p.upper:
                step = -step
            part = _needed_by(plant, name.key)
            other = part.with_values({name.key: {name.parameter: from_search(p, theta[k] + step)}})
            more = np.concatenate([stacked(q.moved(part, other), q.motion.keep, q.counts) for q in self.inverses])
            scale = self.command_scale(other)
            change = (scale / factor - 1.0) * base - scale * more
            result[:, k] = change / step if np.linalg.norm(change) > ROUNDED * np.linalg.norm(y) else 0.0
        return result

    def step_of(self, p: Parameter, value: float) -> float:
        """Step of the directional derivative for a parameter on a linear scale."""
        if p.scale == "time":
            return 0.02 * self.inverses[0].motion.dt
        if p.scale == "order":  # a phase of 0.01 rad at the end of the travel
            travel = max(float(np.ptp(q.motion.q)) for q in self.inverses)
            return 0.01 / max(travel, 1e-12)
        return STEP * max(abs(value), 1e-3)

    def drive_part(self, residual: np.ndarray) -> list[np.ndarray]:
        """Return the drive's balance (samples kept,) of each record out of a stacked vector."""
        edges = np.cumsum([0, *self.lengths])
        return [
            residual[a : b : p.rows(self.plant)] for a, b, p in zip(edges[:-1], edges[1:], self.inverses, strict=True)
        ]

    @property
    def load_rows(self) -> list[slice]:
        """Rows of the load's balance in a stacked vector, of each record; none (an empty slice) where a record has no such balance."""
        edges = np.cumsum([0, *self.lengths])
        return [
            slice(a + 1, b, 2) if p.rows(self.plant) > 1 else slice(0)
            for a, b, p in zip(edges[:-1], edges[1:], self.inverses, strict=True)
        ]

    def blocks(self, seconds: float) -> list[slice]:
        """Return contiguous blocks of about this length, none across records."""
        found, row = [], 0
        for p, length in zip(self.inverses, self.lengths, strict=True):
            rows = p.rows(self.plant)
            count = max(1, round(length // rows * p.motion.dt / seconds))
            edges = row + rows * np.linspace(0, length // rows, count + 1).astype(int)
            found += [slice(a, b) for a, b in zip(edges[:-1], edges[1:], strict=True)]
            row += length
        return found
