"""A plant: effects composed into one residual per body, 0 = sum of forces(q, v, a) - u'.

Composition is `plant + effect`. What is computed from a plant (columns, simulation, description) lives to its right.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import inf

from workbench.effect import Effect, catalogue
from workbench.errors import WorkbenchError, nearest

ONE_MASS, TWO_MASS = "one mass", "two mass"
KINDS = (ONE_MASS, TWO_MASS)
MASSES = {ONE_MASS: "one mass", TWO_MASS: "two masses"}  # as a sentence has it: a plant of two masses
PLACES = {ONE_MASS: ("axis",), TWO_MASS: ("motor", "load", "joint")}
SENSORS = ("position", "load_position")


@dataclass(frozen=True)
class Geometry:
    """gear_ratio: motor turns per output turn (positions are output-side). pole_pairs: of the motor."""

    gear_ratio: float = 1.0
    pole_pairs: float = 1.0


@dataclass(frozen=True)
class Limits:
    """drive: largest torque or force, N*m or N. speed: largest speed, rad/s or m/s. inf: not stated."""

    drive: float = inf
    speed: float = inf


def places(kind: str, effect: Effect) -> tuple[str, ...]:
    """Return where `effect` can act on a plant of this kind ("axis"; "motor", "load", "joint"; "command"; "sensor.position")."""
    sensors = tuple(f"sensor.{s}" for s in SENSORS[: 1 if kind == ONE_MASS else 2])
    bodies = tuple(p for p in PLACES[kind] if p in effect.places)
    # a map that can be at a joint and at a sensor acts in the joint where there is one
    return bodies or tuple(p for p in ("command", *sensors) if p.split(".")[0] in effect.places)


@dataclass(frozen=True)
class Plant:
    """kind: "one mass" or "two mass". rotary: torque in N*m over rad, else force in N over m."""

    kind: str
    effects: tuple[Effect, ...] = ()
    rotary: bool = True
    geometry: Geometry = field(default_factory=Geometry)
    limits: Limits = field(default_factory=Limits)

    def __post_init__(self):
        if self.kind not in KINDS:
            raise WorkbenchError(f"unknown plant '{self.kind}'; {nearest(self.kind, KINDS)}")
        seen = set()
        for e in self.effects:
            allowed = places(self.kind, e)
            motion = "rotary" if self.rotary else "linear"
            if motion not in e.motions:
                raise WorkbenchError(
                    f"effect '{e.name}' exists on a {' or '.join(e.motions)} axis only; this one is {motion}."
                )
            if e.at not in allowed:
                raise WorkbenchError(
                    f"effect '{e.name}' cannot act at '{e.at}' on a plant of {MASSES[self.kind]}; {nearest(e.at, allowed)}"
                )
            if e.key in seen:
                raise WorkbenchError(
                    f"effect '{e.named}' acts twice at '{e.at}'; declare it once, or give each of them a label of its own."
                )
            seen.add(e.key)

    def __add__(self, effect: Effect) -> "Plant":
        return replace(self, effects=(*self.effects, effect))

    def __contains__(self, key: str) -> bool:
        return any(e.key == key or e.name == key for e in self.effects)

    def __getitem__(self, key: str) -> Effect:
        """The effect of this key ("inertia@axis") or, where it is there once, of this name."""
        found = [e for e in self.effects if key in (e.key, e.name)]
        if len(found) != 1:
            raise WorkbenchError(
                f"the plant has {len(found)} effects '{key}'; {nearest(key, (e.key for e in self.effects))}"
            )
        return found[0]

    def without(self, key: str) -> "Plant":
        """Return this plant without one effect."""
        gone = self[key].key
        return replace(self, effects=tuple(e for e in self.effects if e.key != gone))

    def swap(self, effect: Effect) -> "Plant":
        """Return this plant with the effect of the same key replaced."""
        return replace(self, effects=tuple(effect if e.key == effect.key else e for e in self.effects))

    def with_values(self, values: Mapping[str, Mapping[str, float]]) -> "Plant":
        """Return this plant with inside parameter values set: {effect key: {parameter: value}}."""
        return replace(self, effects=tuple(e(**values[e.key]) if e.key in values else e for e in self.effects))

    @property
    def effort(self) -> str:
        """SI unit of the drive: "N*m" or "N"."""
        return "N*m" if self.rotary else "N"

    @property
    def displacement(self) -> str:
        """SI unit of the position: "rad" or "m"."""
        return "rad" if self.rotary else "m"

    def digest_lines(self) -> tuple[str, ...]:
        """One line a fact that behaviour depends on, values rounded to 9 digits; two digests differ where these do."""
        head = (
            f"kind {self.kind}",
            f"rotary {self.rotary}",
            f"geometry.gear_ratio {self.geometry.gear_ratio:.9g}",
            f"geometry.pole_pairs {self.geometry.pole_pairs:.9g}",
            f"limits.drive {self.limits.drive:.9g}",
            f"limits.speed {self.limits.speed:.9g}",
        )
        body = (f"{e.key}.{n} {p.value:.9g}" for e in self.effects for n, p in e.parameters.items())
        return (*head, *sorted(body))

    @property
    def digest(self) -> str:
        """sha256 over digest_lines, on which tuning runs and which gain tables carry."""
        return hashlib.sha256("\n".join(self.digest_lines()).encode()).hexdigest()


def freed(plant: Plant) -> Plant:
    """Return the plant with every parameter free that is a value: one held by definition (an exponent) stays held."""
    known = catalogue()
    for e in plant.effects:
        by_definition = {n for n, p in known[e.name].parameters.items() if p.fixed} if e.name in known else set()
        plant = plant.swap(e.free(*(n for n in e.parameters if n not in by_definition and n not in e.knots)))
    return plant
