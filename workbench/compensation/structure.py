"""How a compensation is laid out in a law: which effects in what order, and the names of its parameters and states."""

from dataclasses import dataclass

from workbench.compensation.compensator import OBSERVED, Compensator
from workbench.definition import Effect
from workbench.simulation.dynamics import directed, ordered

PREFIX = "comp"  # before the names of its parameters and states


@dataclass(frozen=True)
class Structure:
    """What two compensators share that differ in values alone. order: effects as they are evaluated."""

    keys: tuple
    order: tuple[Effect, ...]
    maps: tuple[Effect, ...]
    still: tuple[Effect, ...]
    inertial: tuple[Effect, ...]
    silent: tuple[str, ...]  # keys of effects whose force is not added
    source: str
    delay: int
    smooth: bool

    def __eq__(self, other):
        return self.keys == other.keys

    def __hash__(self):
        return hash(self.keys)

    @property
    def every(self) -> tuple[Effect, ...]:
        """Effects in the order in which their parameters are named."""
        return (*self.order, *self.maps, *self.still, *self.inertial)

    @property
    def sides(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(e.at for e in self.order))


def structure(c: Compensator) -> Structure:
    """Return the structure of a compensator: friction that reads the direction gets one as in a simulation."""
    forces = directed((*c.forces, *c.guides))
    order = tuple(
        e for side in dict.fromkeys(e.at for e in forces) for e in ordered([e for e in forces if e.at == side])
    )
    # keyed by what was declared: directions are made anew each time
    keys = tuple(
        (e.key, e.step, e.derive, e.port, tuple(e.states.items())) for e in (*c.effects, *c.still, *c.inertial)
    )
    smooth = c.low_pass > 0.0
    counts = (len(c.effects), len(c.guides), len(c.still))
    silent = tuple(e.key for e in c.guides)
    return Structure(
        (keys, counts, c.source, c.delay, smooth), order, c.maps, c.still, c.inertial, silent, c.source, c.delay, smooth
    )


def names(i: int, e: Effect) -> tuple[str, ...]:
    """Names of the parameters of effect i in the law."""
    return tuple(f"{PREFIX}_{i}_{n}" for n in e.parameters)


def states_of(s: Structure) -> tuple[str, ...]:
    """Names of the states: of the effects, of each side's signals, of the low pass and the delay."""
    own = (f"{PREFIX}_{i}_{n}_{k}" for i, e in enumerate(s.order) for n, size in e.states.items() for k in range(size))
    side = (f"{PREFIX}_{n}_{at}" for at in s.sides for n in ("at", "speed"))
    late = (f"{PREFIX}_late_{k}" for k in range(s.delay))
    watched = (f"{PREFIX}_speed_seen",) if s.source == OBSERVED else ()
    return (
        *own,
        *side,
        *watched,
        f"{PREFIX}_clock",
        f"{PREFIX}_whole",
        *((f"{PREFIX}_smooth",) if s.smooth else ()),
        *late,
    )


def values_of(c: Compensator, s: Structure) -> dict[str, float]:
    """Return the law's parameters."""
    found = {f"{PREFIX}_gain": c.gain, f"{PREFIX}_ratio": c.ratio, f"{PREFIX}_pole_pairs": c.pole_pairs}
    for i, e in enumerate(s.every):
        found |= {n: p.value for n, p in zip(names(i, e), e.parameters.values(), strict=True)}
    if s.smooth:
        found[f"{PREFIX}_cut"] = c.low_pass
    if s.source == OBSERVED:
        found |= {f"{PREFIX}_mass": c.mass, f"{PREFIX}_bandwidth": c.bandwidth}
    return found


def values_names(s: Structure) -> tuple[str, ...]:
    more = (f"{PREFIX}_cut",) if s.smooth else ()
    more += (f"{PREFIX}_mass", f"{PREFIX}_bandwidth") if s.source == OBSERVED else ()
    of_effects = (n for i, e in enumerate(s.every) for n in names(i, e))
    return (f"{PREFIX}_gain", f"{PREFIX}_ratio", f"{PREFIX}_pole_pairs", *of_effects, *more)
