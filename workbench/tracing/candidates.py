"""What a declared model may lack: undeclared effects of the catalogue where they can act, and fixed values that are wrong."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

from workbench.definition import CHANNELS, FORCE, SIGNALS, Effect, catalogue
from workbench.effects.families import family_of
from workbench.effects.free_bank import NAME as FREE_CURVE
from workbench.plant import Plant, places
from workbench.tracing.budget import BUDGET, Budget
from workbench.tracing.data_sheet import from_data_sheet
from workbench.tracing.discs import of_the_disc, on_the_motor
from workbench.tracing.evidence import ADDITION, CORRECTION
from workbench.tracing.offered_as import as_offered, bare, counted_from

__all__ = ["ADDITION", "CORRECTION"]
# labels of a periodic effect's further orders; more of them would dress anything that lives in position
AGAIN = ("2", "3")
OF_MOTION = tuple(s for s in SIGNALS if s not in CHANNELS)  # what every record has


@dataclass(frozen=True)
class Candidate:
    """effect, at: what would be added, or whose fixed parameters would be set free. plant: the plant with it.

    instead: keys of declared effects that an addition takes the place of. restored: keys of declared laws that it brings back in the
    place of their free virgin curve. stands: name of the nearest formula, of a free form. part: name that it bears else: of a
    composite of which the rest is declared, the part that is missing; of another law of a class, that class' traced effect. yields: whether
    it leads only where no other of its class explains as much, simpler or not: a motor's encoder and its gear err alike once a turn, a
    bumper that is met at once is a spring.
    """

    effect: str
    at: str
    kind: str
    plant: Plant
    instead: tuple[str, ...] = ()
    stands: str = ""
    restored: tuple[str, ...] = ()
    part: str = ""
    yields: bool = False

    @property
    def name(self) -> str:
        """What it is called: of a free form its class' nearest formula, of a composite the part that is missing."""
        return self.stands or self.part or self.effect

    @property
    def key(self) -> str:
        return f"{self.effect}@{self.at}"

    @property
    def bare(self) -> bool:
        """Whether it is offered without what it bends, which is not declared: a bumper is one thing, and no curve is named after it."""
        return bare(self.plant[self.key])

    @property
    def family(self) -> str:
        return family_of(self.plant[self.key])


@dataclass(frozen=True)
class Offer:
    """only: names of the effects that are judged, all where None. own: effects offered beside those of the catalogue, and judged as they are: one that
    it has and does not trace, or one with a parameter that the rig makes known (a ripple once a motor revolution).

    declared: keys of the declared effects; a periodic one of them is offered once more, at another order. stands_for: key of a
    free virgin curve, or of an effect whose values are free within their tolerance -> what was declared. budget: of the search.
    logged: signals that every record has beside the motion and the drive: without a temperature no law of it is asked. hinted: keys of
    effects that a search of the same records found, rest among them: where the axis moves they may be too few blocks' to be certain of.
    zeroed: whether each record's encoders have a zero of their own, that was found. begin: bench clock where the first record begins, s.
    """

    only: Collection[str] | None = None
    own: Collection[Effect] = ()
    declared: Collection[str] = ()
    stands_for: Mapping[str, Effect] = field(default_factory=dict)
    budget: Budget = BUDGET
    logged: Collection[str] = ()
    hinted: Collection[str] = ()
    zeroed: bool = False
    begin: float = 0.0

    def candidates(self, plant: Plant) -> list[Candidate]:
        """Return the candidates of a plant that are judged: maps, which take longest, ahead of forces, each in the order of their names,
        whatever the order of declaration."""
        found = []
        motion = "rotary" if plant.rotary else "linear"
        traced = [e for e in catalogue().values() if e.traced]
        for effect in (*traced, *self.own):
            if motion in effect.motions and {*effect.reads} <= {*OF_MOTION, *self.logged}:
                for place in places(plant.kind, effect, plant.rotary):
                    found += _additions(effect, place, plant, self)
                    if (there := on_the_motor(effect, place, plant)) is not None:
                        found += [replace(c, yields=True) for c in _additions(there, place, plant, self)]
        found += _corrections(plant, self)
        judged = (c for c in found if self.only is None or {c.effect, c.effect.partition(" ")[0]} & {*self.only})
        return sorted(judged, key=lambda s: (s.plant[s.key].port == FORCE, s.effect, s.at, s.kind, not s.instead))


WHOLE = Offer()  # all of the catalogue, and nothing else


def _additions(effect: Effect, place: str, plant: Plant, offer: Offer) -> list[Candidate]:
    """Return what an effect would be as an addition at a place: none, one, or one beside what it may take the place of."""
    stands_for = offer.stands_for
    if place in effect.stated or not _offered(effect, place, plant):
        return []
    if effect.counted_in and not _held_by_data_sheet(f"{effect.counted_in}@{place}", plant, stands_for):
        return []
    another = counted_from(effect(at=place), offer.begin)
    known = {e.key for e in (*plant.effects, *stands_for.values())}
    if another.key in known and periodic(effect):
        another = next((o for o in (_again(effect, place, n) for n in AGAIN) if o.key not in known), another)
    if another.key in known:
        return []
    if (another := as_offered(another, plant, offer.zeroed)) is None:
        return []
    same = needless(another, plant)
    rest = plant
    for key in same:
        rest = rest.without(key)
    instead, restored = (*same, *(stands_for[k].key for k in same if k in stands_for)), ()
    if not another.linear:  # a length of its own, by which the declared law builds up
        instead, restored = same, tuple(stands_for[key].key for key in same)
        for key in same:
            rest = rest + stands_for[key]
    called = (another.nearest or of_the_disc(another, place, plant)) if another.traced else ""
    part = called or missing_part(another, [stands_for.get(key) or plant[key] for key in same])
    found = [
        Candidate(another.named, place, ADDITION, rest + another, instead, "", restored, part, yields=bare(another))
    ]
    if same and FREE_CURVE not in {k.partition("@")[0] for k in same}:
        # the same beside what it may take the place of: two contacts
        found.append(Candidate(another.named, place, ADDITION, plant + another))
    return found


def _held_by_data_sheet(key: str, plant: Plant, stands_for: Mapping[str, Effect]) -> bool:
    """Whether an effect of this key is declared with values from a data sheet. stands_for: as of `Offer`."""
    return key in {e.key for e in plant.effects} and bool(from_data_sheet(stands_for.get(key, plant[key])))


def _corrections(plant: Plant, offer: Offer) -> list[Candidate]:
    """Return a candidate for each effect with values from a data sheet, which would be set free."""
    found = []
    for e in plant.effects:
        told = offer.stands_for.get(e.key, e)  # a value within its tolerance stands for the value
        held = from_data_sheet(told)
        # what an instrument told (a clock, by the angle between encoders) was measured, and is no value from a data sheet either
        if held and (not offer.declared or e.key in offer.declared):
            found.append(Candidate(e.named, e.at, CORRECTION, plant.swap(told.free(*held))))
    return found


def needless(effect: Effect, plant: Plant) -> tuple[str, ...]:
    """Return the keys of declared effects that an effect takes the place of.

    A force that provides the direction of motion is a friction with memory, and goes with that direction; what
    reads nothing but the direction at its place (Coulomb friction) would be the same force once more.
    """
    if "dir" not in effect.provides:
        return ()
    return tuple(
        e.key
        for e in plant.effects
        if e.at == effect.at and (e.name == FREE_CURVE or (effect.linear and tuple(e.reads) == ("dir",)))
    )


def missing_part(effect: Effect, replaced: Collection[Effect]) -> str:
    """Return the one part of a composite that is missing where the rest of it is declared, "" where that is not one.

    What gives the direction stands for whatever friction is replaced; a part of the class of what is replaced may be what that was
    taken for: LuGre in the place of Coulomb friction is both, in that of a presliding hysteresis it is Stribeck's peak.
    """
    classes = {e.family for e in replaced}
    left = [c for c in (catalogue()[n] for n in effect.parts) if "dir" not in c.provides and c.family not in classes]
    return left[0].name if replaced and len(left) == 1 else ""


def _again(effect: Effect, place: str, label: str) -> Effect:
    """Return an effect of another label, of harmonics the one of that number."""
    if not effect.harmonic:
        return effect(at=place, label=label)
    return effect(at=place, label=label, **{effect.harmonic: int(label) * effect.parameters[effect.harmonic].value})


def periodic(effect: Effect) -> bool:
    """Whether an effect has an order, or harmonics, so that an axis may have it once more at another one."""
    return bool(effect.harmonic) or any(p.scale == "order" and not p.fixed for p in effect.parameters.values())


def _offered(effect: Effect, place: str, plant: Plant) -> bool:
    """Whether an effect is a candidate at a place: not a second source of the direction of motion there.

    Two effects that provide `dir` are two descriptions of one contact; and the second would change what others read. In place
    of a free virgin curve one may be offered, unless it is a formula for such a curve; and no composite beside a part of it, which would
    be there twice.
    """
    here = {e.name for e in plant.effects if e.at == place}
    if any(n in here and "dir" not in catalogue()[n].provides for n in effect.parts):
        return False
    given = {s for e in plant.effects if e.at == place and e.name != FREE_CURVE for s in e.provides}
    curved = any(e.at == place and e.name == FREE_CURVE for e in plant.effects)
    return not given & set(effect.provides) and not (curved and effect.virgin is not None and "masing" in effect.holds)


def without(plant: Plant, candidate: Candidate, declared: Plant) -> Plant:
    """Return `plant` without what a candidate brought to the declared one."""
    if candidate.kind != ADDITION:
        return plant.swap(declared[candidate.key])
    plant = plant.without(candidate.key)
    for key in {e.key for e in plant.effects} & ({*candidate.restored} - {e.key for e in declared.effects}):
        plant = plant.without(key)
    for e in declared.effects:  # what it took the place of may itself have been added
        if e.key in candidate.instead:
            plant = plant + e
    return plant


def brought(plant: Plant, candidate: Candidate, last: Plant) -> Plant:
    """Return `plant` with what a candidate brings, as it came out in `last`."""
    effect = last[candidate.key]
    if candidate.kind != ADDITION:
        return plant.swap(effect)
    for key in {e.key for e in plant.effects} & {*candidate.instead}:
        plant = plant.without(key)
    return plant + effect
