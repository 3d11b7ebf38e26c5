"""What no effect of the catalogue explains: whether something is left, where it lives, and whether an effect only dresses it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from workbench.trace.jumps import beside
from workbench.trace.localise import jumped, lives, plainer
from workbench.trace.place import WAYS, Place, Samples, excess_of, local, samples, score, weighed
from workbench.trace.score import Deviations
from workbench.trace.state import State

PLAIN = 2.0  # residual over floor from which something is plainly left
NOISE = 1.1  # residual over floor up to which only noise is left
LEFT = 1.4  # residual over floor up to which effects that were added have explained what there was
EXPLAINED = 0.9  # share of the excess power from which added effects are the answer
DRESSED = 0.5  # share below which they are not
BRIEF = 0.1  # share of the samples below which moments are a place: more of them are a way of moving
ALONE = 4.0  # rms inside a place over rms outside, from which there is little but what lives in the place


@dataclass(frozen=True)
class Unexplained:
    """place: where it lives, None where nowhere in particular. times: residual over floor. instead: what was added dresses it."""

    place: Place | None
    times: float
    instead: bool


def unknown(declared: State, last: State, level: Mapping[str, float], own: Mapping[str, float]) -> Unexplained | None:
    """Return what stays unexplained, or None.

    last: the state with the effects that were added. level, own: record -> floor (rms) of the declared model and of `last`.
    An effect that was added explains what the declared model lacks; where most of the excess lives in one place and the
    effects leave it there, they only spread over the record what belongs to that place.
    """
    known = samples_of(declared, lower(level, own))
    before, after = times(declared, known), times(last, known)
    if last is declared:
        place = living(declared, known) if before > LEFT else None
        if not (before > PLAIN or local(place)):
            return None
        return Unexplained(named(place, declared, known), before, True)
    if after <= LEFT:
        return None
    explained = max((before**2 - after**2) / max(before**2 - 1.0, 1e-12), of_all(declared, last))
    if explained > DRESSED and times(last, samples_of(last, own)) <= PLAIN:
        return None  # it explains the most, and is what makes much of the counts that are left
    place = living(declared, known)
    if explained < DRESSED:
        return Unexplained(named(place, declared, known), before, True)
    stays = say_more(declared, last, known) if explained < EXPLAINED else None
    if stays and not plainer(place, stays):
        return Unexplained(stays, before, True)
    brief = local(place) and (place.coordinate != "time" or place.covered < BRIEF)
    alone = brief and place.inside > ALONE * place.outside
    if explained < EXPLAINED and alone and weighed(place, last.solution.residual, known).inside > LEFT:
        return Unexplained(place, before, True)
    rest = living(last, known)
    return Unexplained(rest, after, False) if local(rest) else None


def lower(level: Mapping[str, float], other: Mapping[str, float]) -> dict[str, float]:
    """Return the lower of two floors of each record: a model that makes much of the counts does not excuse what it leaves."""
    return {name: min(x, other[name]) for name, x in level.items()}


def noise_alone(state: State, level: Mapping[str, float], most: float = NOISE) -> bool:
    """Whether a state leaves no more than the floor, times `most`."""
    return times(state, samples_of(state, level)) < most


def samples_of(state: State, level: Mapping[str, float]) -> Samples:
    return samples(state.passes, state.plant, level)


def times(state: State, known: Samples) -> float:
    """Return the rms of the drive's residual over that of the floor."""
    power = float(np.sum(state.solution.residual[known.drive] ** 2))
    floor = float(np.sum(known.floor[known.drive] ** 2))
    return (power / floor) ** 0.5 if floor > 0 else 0.0


def say_more(declared: State, last: State, known: Samples) -> Place | None:
    """Return the jumps of the level that say more than the added effects do, or None.

    Jumps that are nearly all that the declared model leaves; or nearly all that is left with the effects, if they take away
    more beside the effects than the effects take away beside them.
    """
    alone = living(declared, known, jumped)
    if alone and alone.share > EXPLAINED:
        return alone
    rest = living(last, known, jumped)
    if not rest or rest.share <= EXPLAINED:
        return None
    moments = [(low + high) / 2 for low, high in rest.spans]

    def left(state: State) -> float:
        model = Deviations(state.problem, state.solution)
        return float(excess_of(beside(state.solution.residual, known.t, known.drive, model, moments), known).sum())

    both = left(last)
    by_jumps = float(excess_of(last.solution.residual, known).sum()) - both
    return rest if by_jumps > left(declared) - both else None


def of_all(declared: State, last: State) -> float:
    """Return the share of the residual's power, of the load's balance too, that the added effects take away.

    What is missing at the load need not show in the drive, which feels the joint by its law at the measured deflection.
    """
    left, whole = (float(np.sum(s.solution.residual**2)) for s in (last, declared))
    return 1.0 - left / whole if whole > 0.0 else 0.0


def living(state: State, known: Samples, how: Callable[..., Place | None] = lives) -> Place | None:
    return how(state.solution.residual, known, Deviations(state.problem, state.solution))


def named(place: Place | None, state: State, known: Samples) -> Place | None:
    """Return the place that is named: a window, else the moments, or the jumps of the level, that hold more for their size."""
    if local(place) and place.coordinate != "time":
        return place
    moments = [p for p in (place if local(place) else None, living(state, known, jumped)) if p]
    return max(moments, key=score, default=None)


def described(found: Unexplained | None) -> dict[str, object]:
    """Return what trace.json says of it; empty where nothing is unexplained."""
    if found is None:
        return {}
    if found.place is None:
        return {"coordinate": "none", "times_floor": found.times}
    p = found.place
    return {
        "coordinate": p.coordinate,
        "low": min(low for low, _ in p.spans),
        "high": max(high for _, high in p.spans),
        "spans": [list(s) for s in p.spans],
        "direction": WAYS[p.direction],
        "share": p.share,
        "times_floor": found.times,
        "times_floor_outside": p.outside,
    }
