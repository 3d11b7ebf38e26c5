"""A plant: effects composed into one residual per body, 0 = sum of forces(q, v, a) - u'.

Composition is `plant + effect`. What is computed from a plant (columns, simulation, description) lives to its right.
"""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from math import inf
from types import MappingProxyType

from workbench.definition import CHANNELS, FORCE, Effect, catalogue
from workbench.errors import WorkbenchError, nearest

ONE_MASS, TWO_MASS = "one mass", "two mass"
KINDS = (ONE_MASS, TWO_MASS)
MASSES = {ONE_MASS: "one mass", TWO_MASS: "two masses"}  # as a sentence has it: a plant of two masses
PLACES = {ONE_MASS: ("axis",), TWO_MASS: ("motor", "load", "joint")}
SENSORS = ("position", "load_position")
DRIVES = {True: "torque", False: "force"}  # of a rotary axis, or a linear one: the channel that reports the drive


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


def places(kind: str, effect: Effect, rotary: bool = True) -> tuple[str, ...]:
    """Return where `effect` can act on a plant of this kind ("axis"; "motor", "load", "joint"; "command"; "sensor.position").

    An effect whose places have "drive" can be at the drive's own channel, too: "sensor.torque", or "sensor.force".
    """
    sensors = tuple(f"sensor.{s}" for s in SENSORS[: 1 if kind == ONE_MASS else 2])
    bodies = tuple(p for p in PLACES[kind] if p in effect.places)
    drive = (f"sensor.{DRIVES[rotary]}",) if "drive" in effect.places else ()
    # a map that can be at a joint and at a sensor acts in the joint where there is one
    return bodies or (*(p for p in ("command", *sensors) if p.split(".")[0] in effect.places), *drive)


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
            allowed = places(self.kind, e, self.rotary)
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
        effects = tuple(_valued(e, values[e.key]) if e.key in values else e for e in self.effects)
        return _like(self, effects=effects)

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


def _valued(effect: Effect, values: Mapping[str, float]) -> Effect:
    """Return effect(**values)."""
    if not values.keys() <= effect.parameters.keys():
        return effect(**values)  # which says what is not there
    parameters = dict(effect.parameters)
    for name, value in values.items():
        parameters[name] = parameters[name].at(value, where=f"{effect.name}.{name}")
    return _like(effect, parameters=MappingProxyType(parameters))


def _like(known, **changed):
    """Return a plant or an effect with fields changed that no check of the definition depends on: a search sets values ten thousand times."""
    found = object.__new__(type(known))
    found.__dict__.update(known.__dict__, **changed)
    return found


LOAD_SIGNALS = frozenset({"tau", "tau_inertia"})
STILL = ("q", "t", "ratio", "pole_pairs", "locked", *CHANNELS)  # what a force may read that no motion makes


def reads_load(effect: Effect) -> bool:
    """Whether a force follows the torque that its contact carries."""
    return effect.port == FORCE and not LOAD_SIGNALS.isdisjoint(effect.reads)


def _stands_still(effect: Effect) -> bool:
    """Whether a force is there whether or not anything moves: gravity, springs, a constant load."""
    return not effect.states and set(effect.reads) <= set(STILL)


def carried(plant_kind: str, place: str, effects: Iterable[Effect]) -> tuple[list[Effect], list[Effect]]:
    """Return the forces that make up (tau, tau_inertia) at a place: the torque that a contact there carries, by the model.

    Of two masses tau is the joint's torque, at the motor, at the load and in the joint alike, and tau_inertia is zero: what
    is accelerated behind the joint is in its torque. Of one mass tau is what passes a gear at standstill (`_stands_still`), and
    tau_inertia the torque of inertia, of which a share lies behind the contact: only an effect's own parameter can say which.
    Friction is in neither: of one mass nothing tells what of it lies behind the gear, and most lies at the gear's fast side.
    The measured drive never is: a prediction that saw it would be none.
    """
    here = "joint" if plant_kind == TWO_MASS else place
    forces = [e for e in effects if e.port == FORCE and e.at == here and not reads_load(e)]
    if plant_kind == TWO_MASS:
        return forces, []
    return [e for e in forces if _stands_still(e)], [e for e in forces if "a" in e.reads]


def freed(plant: Plant) -> Plant:
    """Return the plant with every parameter free that is a value: one held by definition (an exponent) stays held."""
    known = catalogue()
    for e in plant.effects:
        by_definition = {n for n, p in known[e.name].parameters.items() if p.fixed} if e.name in known else set()
        plant = plant.swap(e.free(*(n for n in e.parameters if n not in by_definition and n not in e.knots)))
    return plant
