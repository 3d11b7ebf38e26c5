"""What is cancelled, from which signal, and how: a compensator as data."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite

from workbench.definition import ANGLE, FORCE, SENSOR, Effect
from workbench.effects.play import inverse, play_bank
from workbench.errors import WorkbenchError, nearest
from workbench.plant import Plant, carried, reads_load

READ, REFERENCE, OBSERVED = "measured", "reference", "observer"
SOURCES = (READ, REFERENCE, OBSERVED)
COMMON = "q dq v dt t u tau tau_inertia dir motor_q load_q ratio pole_pairs locked".split()
SIGNALS = {READ: COMMON, REFERENCE: [*COMMON, "a"], OBSERVED: [*COMMON, "a"]}  # what each source can give an effect
SIDES = ("axis", "motor", "load")
MOST = 64  # samples of delay: each is a state of the law


@dataclass(frozen=True)
class Compensator:
    """effects: forces at the axis, the motor or the load, and angle maps. source: of the position that they see, `READ`
    (what the encoder of that side reads, its filtered velocity), `REFERENCE` (what is asked for; adds no feedback path) or
    `OBSERVED` (of a tracking observer). gain: of what is cancelled. delay: samples. low_pass: Hz, 0 for none.

    mass (kg*m^2 or kg) and bandwidth (Hz): of the observer, x' = v + 2 w e, v' = u/mass + w^2 e, e = y - x, u the law's own
    command. ratio, pole_pairs: the plant's. still, inertial: forces of one mass that a contact carries (`plant.carried`), for
    friction that depends on the load, and guides: friction with memory that gives others their direction and is not itself
    cancelled; what inertia carries is left out where the source is `READ`. Angle maps are undone at
    the reference whatever the source.
    WorkbenchError for an effect that no drive cancels, or a signal that the source does not have.
    """

    effects: tuple[Effect, ...]
    source: str = READ
    gain: float = 1.0
    delay: int = 0
    low_pass: float = 0.0
    mass: float = 0.0
    bandwidth: float = 0.0
    ratio: float = 1.0
    pole_pairs: float = 1.0
    still: tuple[Effect, ...] = ()
    inertial: tuple[Effect, ...] = ()
    guides: tuple[Effect, ...] = ()

    def __post_init__(self):
        object.__setattr__(self, "effects", tuple(self.effects))
        if self.source not in SOURCES:
            raise WorkbenchError(f"compensation has no source '{self.source}'; {nearest(self.source, SOURCES)}")
        if not self.effects:
            raise WorkbenchError("a compensator needs an effect to cancel; name one of the plant's.")
        if not (0 <= self.delay <= MOST and self.delay == int(self.delay)):
            raise WorkbenchError(f"the delay of a compensation is {self.delay} samples; it must be whole, 0 to {MOST}.")
        if not (isfinite(self.low_pass) and self.low_pass >= 0.0):
            raise WorkbenchError(f"the low pass of a compensation lies at {self.low_pass:g} Hz; it must be above 0.")
        if self.source == OBSERVED and not (self.mass > 0.0 and self.bandwidth > 0.0):
            raise WorkbenchError("compensation from an observer needs its mass and its bandwidth, both above 0.")
        for e in self.effects:
            wrong = refused(e, self.source)
            if wrong:
                raise WorkbenchError(
                    f"effect '{e.named}' at '{e.at}' cannot be compensated from '{self.source}': {wrong}"
                )

    @property
    def forces(self) -> tuple[Effect, ...]:
        return tuple(e for e in self.effects if e.port == FORCE)

    @property
    def maps(self) -> tuple[Effect, ...]:
        return tuple(e for e in self.effects if e.port in (ANGLE, SENSOR))

    @property
    def both(self) -> bool:
        """Whether a place of two masses is named."""
        return any(e.at in ("motor", "load") for e in self.forces)

    def but(self, **changes) -> "Compensator":
        """Return this compensator with some fields changed."""
        return replace(self, **changes)

    @classmethod
    def of(cls, plant: Plant, names: Sequence[str], **options) -> "Compensator":
        """Return the compensator of effects of a plant, by name or key; WorkbenchError with the nearest names."""
        geometry = plant.geometry
        effects = tuple(plant[n] for n in names)
        if any(reads_load(e) for e in effects):
            still, inertial = carried(plant.kind, "axis", plant.effects)
            options |= {"still": tuple(still), "inertial": tuple(inertial)}
        following = {e.at for e in effects if "dir" in e.reads}
        guides = tuple(e for e in plant.effects if "dir" in e.provides and e.at in following and e not in effects)
        return cls(effects, guides=guides, ratio=geometry.gear_ratio, pole_pairs=geometry.pole_pairs, **options)


def refused(effect: Effect, source: str = REFERENCE) -> str:
    """Return why an effect cannot be compensated, or ""."""
    if effect.port in (ANGLE, SENSOR):
        missing = set(effect.reads) - {"q", "motor_q", "load_q", "ratio", "pole_pairs"}
        if effect.states or missing:
            return "an error of the angle is undone at the reference where it hangs on the position alone."
        return ""
    if effect.port != FORCE:
        return "it is no force and no error of the angle; a delay or a lag can only be known to the tuning."
    if effect.at not in SIDES:
        return "a force between motor and load is not the drive's to cancel: it acts on both."
    if reads_load(effect) and effect.at != "axis":
        return "it reads the joint's torque, which no encoder tells a controller."
    if effect.name == "inertia" or "a" in effect.reads and source == READ:
        return "it reads the acceleration, which an encoder does not give in time; take the reference as its source."
    missing = [n for n in effect.reads if n not in SIGNALS[source]]
    return f"it reads '{missing[0]}', which a controller does not have." if missing else ""


def compensable(plant: Plant, source: str = READ) -> tuple[Effect, ...]:
    """Return the effects of a plant that a compensation from this source can cancel."""
    return tuple(e for e in plant.effects if not refused(e, source))


def undone(effect: Effect) -> Effect:
    """Return the play bank that undoes another, exactly (Kuhnen 2003): increments of its output in, displacement out.

    WorkbenchError for another effect, and for a bank that is not monotone.
    """
    if effect.name != "play_bank":
        raise WorkbenchError(f"effect '{effect.name}' has no exact inverse here; a play bank has one.")
    weights = [effect.parameters[n].value for n in effect.linear]
    return play_bank(*inverse([effect.parameters[n].value for n in effect.knots], weights))
