"""Declared Coulomb friction that turns over a speed, and not at once: that a declared law is only nearly right is no missing effect.

Where an axis creeps to its rest on an oil film, friction goes through zero with speed, as T = TL tanh(v/vL) does with a vL of a few per
mille of the fastest motion. Coulomb friction says its full size there, and the residual lives where the axis hardly moves: it would lead
as nonlinear viscous friction, and hide what is missing. So before any effect is tried it is asked whether the declared friction is that,
and in which shape, and where it is, all else is searched beside it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.definition import Effect, catalogue
from workbench.finding import title
from workbench.identification.fit import fitted_on, identify
from workbench.identification.intervals import on_bound
from workbench.identification.result import Fit
from workbench.identification.solve import NoValue
from workbench.inverse.bodies import VELOCITY
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.tracing.answer import Answer
from workbench.tracing.candidates import without
from workbench.tracing.criteria import Criteria
from workbench.tracing.decimation import decimate
from workbench.tracing.near_law import laws
from workbench.tracing.result import Refinement
from workbench.tracing.selection import curved, size
from workbench.tracing.state import State
from workbench.tracing.sticking import sticking

FILM = "film_friction"
OTHERWISE = "regularised_coulomb_friction"  # comes to its level sooner or later than a film
DRY = "coulomb_friction"
POWER = "power_law_friction"
STARTS = (0.001, 0.003, 0.01)  # of the fastest speed at its place, from which the speed of the turn is searched
# Of that speed, up to which a turn is one: beyond, it is friction over speed, a law of its own that the trace names. Seven axes of 366 of other
# authors and machines turn so, over 0.0027 to 0.0044 of it. Halved or doubled, they are the same
SLOW = 0.02


@dataclass(frozen=True, eq=False)
class SmoothTurn:
    """declared: the Coulomb frictions, as declared, by the key of what stands in their place. films: these, of either shape. before: the
    fit of whole records with the frictions as declared."""

    declared: dict[str, Effect]
    films: tuple[Effect, ...]
    before: Fit

    def of(self, plant: Plant) -> Plant:
        """Return the plant with each of these frictions as one that turns over a speed."""
        for film in self.films:
            plant = plant.without(self.declared[film.key].key) + film
        return plant

    def back(self, plant: Plant) -> Plant:
        """Return a plant with each of these frictions as it is declared."""
        for key, dry in self.declared.items():
            plant = plant.without(key) + dry
        return plant

    def stands(self, answer: Answer, inverses: Sequence[InverseDynamics], criteria: Criteria) -> bool:
        """Whether beside what a search found a turn still takes what is of practical size beyond the free virgin curve, where the axis moves and
        without what was added that has a memory there.

        Of friction that builds up over a distance a turn takes much while something larger hides how it does so; the memory is then found
        beside it, as if one contact were two. And where an axis sticks a turn dresses rest. inverses: of all records, with which it was found.
        """
        places = {e.at for e in self.declared.values()}
        plant = answer.last.plant
        for j in answer.added:
            if j.candidate.at in places and "dir" in plant[j.candidate.key].provides:
                plant = without(plant, j.candidate, answer.declared.plant)
        straight = self.back(plant)
        sticks = sticking(straight, inverses)
        thin = decimate(fitted_on(sticks.inverses if sticks else inverses), straight, criteria.rate)
        turned, dry = _state(plant, thin), _state(straight, thin)
        if turned is None or dry is None:
            return True
        known = [w for w in laws(dry.plant, thin) if w.declared.key in {e.key for e in self.declared.values()}]
        return size(curved(dry, known, criteria), turned) >= criteria.practical

    def taken(self, after: Fit) -> float:
        """Return what a fit takes away of what the plant as it is declared leaves, over the drive's rms, on identification."""
        return max(self.before.identification**2 - after.identification**2, 0.0) ** 0.5

    @property
    def beside(self) -> str:
        """What is added to a verdict's sentence."""
        return (
            f" All this is beside {title(DRY)} that turns over a speed and not at once, a refinement of the declared law: with that as it is "
            f"declared, {100 * self.before.identification:.2f} % would be left on identification."
        )

    def refinements(self, after: Fit) -> list[Refinement]:
        """Return one a place. after: the fit of the plant in which friction turns so."""
        return [self._refinement(key, e, after) for key, e in self.declared.items()]

    def _refinement(self, key: str, dry: Effect, after: Fit) -> Refinement:
        told = tuple(e for e in after.estimates if f"{e.effect}@{e.at}" == key)
        sharp = next(
            (f" (sharpness {e.value:.2g})" for e in told if e.parameter == "sharpness"), ", as friction of a film does"
        )
        speed = next(e for e in told if e.parameter == "speed")
        beside = "that" if len(self.declared) == 1 else f"all {len(self.declared)} that do so"
        return Refinement(
            effect=dry.named,
            at=dry.at,
            kind="law",
            sentence=(
                f"The declared law of {title(dry.name)} at the {dry.at} is only nearly right: it does not turn at once, but over a speed "
                f"of {speed.value:.2g} {speed.unit}{sharp}. With {beside} the identification error goes from "
                f"{100 * self.before.identification:.2f} % to {100 * after.identification:.2f} %, and all else is held against it."
            ),
            parameters=told,
            size=self.taken(after),
        )


def turns(effect: Effect, declared: Plant, inverses: Sequence[InverseDynamics]) -> bool:
    """Whether a fitted effect is Coulomb friction, declared at its place, that turns over a speed. Behind a joint it may be found by the search:
    of the drive it takes less than what is asked before, and of the load's small balance most."""
    dry = any(e.named == DRY and e.at == effect.at for e in declared.effects)
    if effect.name not in (FILM, OTHERWISE) or not dry:
        return False
    return effect.parameters["speed"].value <= SLOW * _top(declared, effect.at, inverses)


def smooth_turn(plant: Plant, inverses: Sequence[InverseDynamics], criteria: Criteria) -> SmoothTurn | None:
    """Return the declared Coulomb frictions that turn over a speed, None where none does.

    It must take what is of practical size beyond the declared law, and beyond the free virgin curve: presliding builds up over a distance;
    and whole records must bear it out in the drive: what a load does near standstill is much of its own small balance, and a matter of counts.
    """
    whole = fitted_on(inverses)
    # where a law over speed is declared beside it, that says how friction goes with speed; a labelled one is a further contact
    over_speed = {e.at for e in plant.effects if e.name in (FILM, OTHERWISE, POWER)}
    known = [w for w in laws(plant, whole) if w.declared.named == DRY and w.declared.at not in over_speed]
    if not known or (state := _state(plant, decimate(whole, plant, criteria.rate))) is None:
        return None
    declared: dict[str, Effect] = {}
    for law in known:
        turned = _turned(state, law.declared, criteria)
        if turned is not None and size(curved(state, [law], criteria), turned) >= criteria.practical:
            state = turned
            declared[f"{FILM}@{law.declared.at}"] = law.declared
    if not declared:
        return None
    turn = SmoothTurn(declared, tuple(state.plant[key] for key in declared), identify(plant, inverses))
    after = identify(turn.of(plant), inverses)
    if (shaped := _shaped(turn, state, criteria)) is not None:
        better = identify(shaped.of(plant), inverses)
        if not better.validation > after.validation:
            turn, after = shaped, better
    refuted = after.validation > turn.before.validation  # without a validation record NaN says nothing
    return None if refuted or turn.taken(after) < criteria.practical else turn


def _shaped(turn: SmoothTurn, state: State, criteria: Criteria) -> SmoothTurn | None:
    """Return the turns, of those that a film's shape leaves what is of practical size, in the shape that takes it; None where none does.

    state: with the films. What tanh leaves of an arctangent's long way to its level, 9 % of the friction, would be nonlinear viscous friction.
    """
    declared: dict[str, Effect] = {}
    for film in turn.films:
        values = {n: p.value for n, p in film.parameters.items()}
        other = catalogue()[OTHERWISE](at=film.at, coulomb=values["limit"], speed=values["speed"])
        found = _state(state.plant.without(film.key) + other, state.inverses)
        better = found is not None and size(state, found) >= criteria.practical and _inside(found.plant[other.key])
        state = found if better else state
        declared[other.key if better else film.key] = turn.declared[film.key]
    if declared.keys() == turn.declared.keys():
        return None
    return replace(turn, declared=declared, films=tuple(state.plant[key] for key in declared))


def _inside(effect: Effect) -> bool:
    """Whether an effect's sharpness lies inside its bounds: on one of them it is no shape that was found."""
    sharpness = effect.parameters["sharpness"]
    return not on_bound(sharpness.value, sharpness.lower, sharpness.upper)


def _turned(state: State, dry: Effect, criteria: Criteria) -> State | None:
    """Return the state with friction that turns over a speed in the place of `dry`; None where that speed is none, it takes too little, or
    friction that goes with a power of speed leaves less: that is no turn, though near zero it is as steep."""
    top = _top(state.plant, dry.at, state.inverses)
    rest = state.plant.without(dry.key)
    level = state.plant[dry.key].parameters["coulomb"].value
    films = [catalogue()[FILM](at=dry.at, limit=level, speed=start * top) for start in STARTS]
    begun = [s for s in (_state(rest + film, state.inverses, solved=True) for film in films) if s]
    best = min(begun, key=lambda s: s.errors.total, default=state)
    found = _state(best.plant, state.inverses) if size(state, best) >= criteria.practical else None
    if found is None or size(state, found) < criteria.practical:
        return None
    power = _state(rest + catalogue()[POWER](at=dry.at, speed=top), state.inverses)
    steeper = power is not None and power.errors.total < found.errors.total
    speed = found.plant[f"{FILM}@{dry.at}"].parameters["speed"].value
    return None if steeper or speed > SLOW * top else found


def _top(plant: Plant, at: str, inverses: Sequence[InverseDynamics]) -> float:
    """Return the fastest speed of the body at a place, in rad/s or m/s."""
    return max(float(np.abs(p.bodies.body(plant, at, 1)[1][VELOCITY]).max()) for p in inverses)


def _state(plant: Plant, inverses: Sequence[InverseDynamics], *, solved: bool = False) -> State | None:
    """Return the state of a plant, None where it has no value on these records."""
    try:
        return State(plant, inverses, solved=solved)
    except NoValue:
        return None
