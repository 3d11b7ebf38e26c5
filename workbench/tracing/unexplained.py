"""What no effect of the catalogue explains: whether something is left, where it lives, and whether an effect only dresses it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite

from workbench.identification.cross_validation import Deviations
from workbench.residual.change_points import with_change_points
from workbench.residual.localisation import change_windows, localise, plainer
from workbench.residual.samples import Samples, excess_of, left_in, samples, times_floor
from workbench.residual.window import DIRECTIONS, EITHER, Window, local
from workbench.tracing.evidence import Evidence
from workbench.tracing.mending import Mended
from workbench.tracing.state import State

PLAIN = 2.0  # residual over floor from which something is plainly left
NOISE = 1.1  # residual over floor up to which only noise is left
LEFT = 1.4  # residual over floor up to which effects that were added have explained what there was
EXPLAINED = 0.9  # share of the excess power from which added effects are the answer
STAYS = 0.5  # of the rms inside a place, that must stay there with the effects
BRIEF = 0.1  # share of the samples below which moments are a place: more of them are a way of moving
# Residual outside a place with the added effects over the declared model's own there, from which they trade one for the other: effects
# that were right left 0.97 of it or less, those that dressed a window of the stroke 1.10 to 1.64. Halved or doubled in its distance from 1,
# it changes none of 232 axes
TRADED = 1.05
ALONE = 4.0  # rms inside a place over rms outside, from which there is little but what lives in the place


@dataclass(frozen=True)
class Unexplained:
    """place: where it lives, None where nowhere in particular. times: residual over what is calm of it."""

    place: Window | None
    times: float


def instead(declared: State, last: State, level: Mapping[str, float]) -> Window | None:
    """Return the place that says more of the declared model's residual than the added effects do, or None.

    level: record -> rms of what is calm with the effects in place. Where most of the excess lives in one place and the effects
    leave it there, they only spread over the record what belongs to that place.
    """
    known = _samples_of(declared, level)
    before, after = times_floor(declared.solution.residual, known), times_floor(last.solution.residual, known)
    if last is declared or after <= LEFT or (before**2 - after**2) / max(before**2 - 1.0, 1e-12) >= EXPLAINED:
        return None
    place, stays = _living(declared, known), _say_more(declared, last, known)
    if stays and not plainer(place, stays):
        return stays
    brief = local(place) and (place.coordinate != "time" or place.covered < BRIEF)
    alone = brief and place.inside > ALONE * place.outside
    if not alone:
        return None
    left = left_in(place, last.solution.residual, known).inside
    return place if left > max(LEFT, STAYS * left_in(place, declared.solution.residual, known).inside) else None


def traded(declared: State, last: State, level: Mapping[str, float]) -> Window | None:
    """Return the window of the stroke that the added effects leave plainly, and pay for with residual elsewhere, or None.

    Outside of it the declared model, fitted without it, says more than the extended one does: what an effect takes inside is not its own.
    """
    known = _samples_of(declared, level)
    place = _living(declared, known)
    if last is declared or not local(place) or place.coordinate != "position":
        return None
    left = left_in(place, last.solution.residual, known)
    return place if left.inside > LEFT and left.outside > TRADED * place.outside else None


def unexplained(state: State, level: Mapping[str, float]) -> Unexplained:
    """Return where the residual of a state lives. level: record -> rms of what is calm in it."""
    known = _samples_of(state, level)
    return Unexplained(_named(_living(state, known), state, known), times_floor(state.solution.residual, known))


def noise_alone(state: State, level: Mapping[str, float], most: float = NOISE) -> bool:
    """Whether a state leaves no more than the floor, times `most`."""
    return times_floor(state.solution.residual, _samples_of(state, level)) < most


def _samples_of(state: State, level: Mapping[str, float]) -> Samples:
    return samples(state.inverses, state.plant, level)


def _say_more(declared: State, last: State, known: Samples) -> Window | None:
    """Return the jumps of the level that say more than the added effects do, or None.

    Jumps that are nearly all that the declared model leaves; or nearly all that is left with the effects, if they take away
    more beside the effects than the effects take away beside them.
    """
    alone = _living(declared, known, change_windows)
    if alone and alone.share > EXPLAINED:
        return alone
    rest = _living(last, known, change_windows)
    if not rest or rest.share <= EXPLAINED:
        return None
    moments = [(low + high) / 2 for low, high in rest.spans]

    def left(state: State) -> float:
        model = Deviations(state.problem, state.solution)
        return float(
            excess_of(with_change_points(state.solution.residual, known.t, known.drive, model, moments), known).sum()
        )

    both = left(last)
    by_jumps = float(excess_of(last.solution.residual, known).sum()) - both
    return rest if by_jumps > left(declared) - both else None


def _living(state: State, known: Samples, how: Callable[..., Window | None] = localise) -> Window | None:
    return how(state.solution.residual, known, Deviations(state.problem, state.solution))


def _named(place: Window | None, state: State, known: Samples) -> Window | None:
    """Return the place that is named: a window, else the moments, or the jumps of the level, that hold more for their size."""
    if local(place) and place.coordinate != "time":
        return place
    moments = [p for p in (place if local(place) else None, _living(state, known, change_windows)) if p]
    return max(moments, key=lambda w: w.contrast, default=None)


def described(found: Unexplained | None, evidence: Evidence, lost: Mended | None = None) -> dict[str, object]:
    """Return what trace.json says of where an unexplained residual lives; empty where nothing is unexplained."""
    if lost is not None:
        return _of_lost(lost)
    if found is None:
        return {}
    size = evidence.before
    if size.kind == "line" and not local(found.place):
        return {"coordinate": "frequency", "low": size.frequency, "high": size.frequency, "size": size.line}
    if found.place is None:
        return {"coordinate": "none", "size": size.size}
    p = found.place
    return {
        "coordinate": p.coordinate,
        "low": min(low for low, _ in p.spans),
        "high": max(high for _, high in p.spans),
        "spans": [list(s) for s in p.spans],
        "direction": DIRECTIONS[p.direction],
        "share": p.share,
        "size": size.size,
    } | ({"times_calm": found.times, "times_calm_outside": p.outside} if isfinite(p.outside) else {})


def _of_lost(found: Mended) -> dict[str, object]:
    """Return what trace.json says of counts that an encoder lost: the moments, each by record, and what they take of the drive."""
    step = max(p.motion.dt for p in found.inverses)
    times = sorted(s.time for s in found.lost.all)
    return {
        "coordinate": "time",
        "low": times[0],
        "high": times[-1],
        "spans": [[t - step, t] for t in times],
        "direction": DIRECTIONS[EITHER],
        "share": (found.size / found.before.identification) ** 2,
        "size": found.size,
        "channel": found.lost.channel,
        "shifts": {name: [[s.time, s.size] for s in shifts] for name, shifts in found.lost.shifts.items()},
    }
