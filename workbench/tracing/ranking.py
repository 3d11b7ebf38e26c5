"""A round of the search: every candidate judged, and the order in which they come.

By gain; of those that explain practically the same the simplest leads, and no effect leads that by its values is another one.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from workbench.definition import CHANNELS, FORCE, Effect, catalogue
from workbench.effects.free_bank import NAME as FREE_CURVE
from workbench.identification.cross_validation import gain
from workbench.processes import shared
from workbench.tracing import foreseen
from workbench.tracing.candidates import WHOLE, Candidate, Offer
from workbench.tracing.criteria import Criteria
from workbench.tracing.judge import (
    STANDARD,
    Progress,
    ScoredCandidate,
    ahead,
    everything_free,
    judged,
    refit_of,
    refitted,
)
from workbench.tracing.one_sided import one_sided
from workbench.tracing.orders import any_curve, of_no_mechanism
from workbench.tracing.plausible import implausible
from workbench.tracing.reducing import reduced_to
from workbench.tracing.state import State

BEHIND = 0.4  # of the best one's gain, below which a candidate is not
EQUAL = 0.1  # standard errors of a gain within which two effects as simple explain the same


def step(
    state: State,
    progress: Progress,
    offer: Offer = WHOLE,
    criteria: Criteria = STANDARD,
    asks: Callable[[Candidate], bool] = lambda _: True,
) -> list[ScoredCandidate]:
    """Judge every candidate that is offered and that `asks` says to ask; return them best first, those that lead fitted with everything free."""
    candidates = [c for c in offer.candidates(state.plant) if asks(c)]
    # made here, else by every process for itself
    _ = state.power, state.residuals, state.of_loads, state.absorbed, state.solution.columns, state.solution.gram
    judgements = []
    for candidate, found in zip(
        candidates, shared(lambda s: judged(state, s, criteria, offer.budget), candidates, foreseen.loaded), strict=True
    ):
        progress(f"trying {candidate.key}")
        judgements.append(ScoredCandidate(candidate, **found))
    judgements = _by_gain(judgements)
    least = max(criteria.share / 2, BEHIND * judgements[0].score.gain) if judgements else 0.0
    leaders = [j for j in ahead(judgements, offer.budget.leading) if j.score.gain > least and j.theta is not None]
    for i, more in enumerate(shared(lambda j: refitted(state, j, criteria), leaders)):
        progress(f"fitting {leaders[i].candidate.key} with everything free")
        if more:
            fit = refit_of(state, leaders[i], *more.pop("fit"))
            judgements[judgements.index(leaders[i])] = replace(leaders[i], refitted=fit, **more)
    judgements = _plainest_first(simplest_first(judgements, criteria, state), criteria, state, offer)
    if judgements and (first := judgements[0]).refitted:
        judgements[0] = replace(first, state=first.refitted.state)
    return judgements


def _by_gain(judgements: Sequence[ScoredCandidate]) -> list[ScoredCandidate]:
    """Order by gain, those that earn their place ahead of those that do not."""
    return sorted(
        judgements,
        key=lambda j: (not j.score.earns, -j.score.gain, j.score.effect, j.score.at),
    )


def simplest_first(judgements: Sequence[ScoredCandidate], criteria: Criteria, state: State) -> list[ScoredCandidate]:
    """Order by gain; of those that explain practically the same as the best, the one with the fewest free parameters leads.

    Of several as simple one that reads less, or the one with the largest gain, and a rare effect behind another one whose gain is as large. Of a class a law of
    a channel that was logged (a temperature) leads over those of time, which stands in for it until an axis cools down. A value that
    no machine has does not lead where a plausible effect explains nearly as much.
    """
    judgements = _by_gain(judgements)
    if not judgements:
        return judgements
    leader = _sound(judgements, criteria, state)
    level = [j for j in judgements if j is leader or (j.refitted and alike(leader, j, criteria, state.power))]
    firm = {j.candidate.family for j in level if not j.candidate.yields}
    level = [j for j in level if not (j.candidate.yields and j.candidate.family in firm)]
    logged = {(j.candidate.family, j.candidate.at) for j in level if _logged(j)}
    level = [j for j in level if not logged or _logged(j) or (j.candidate.family, j.candidate.at) not in logged]
    sound = [j for j in level if not j.refitted or not absurd(j, state)]
    level = sorted(sound or level, key=lambda j: (j.freedom, -j.score.gain, j.score.effect, j.score.at))
    first = _of_less(level)
    least = first.score.gain - EQUAL * first.score.scatter
    equal = [j for j in level if j.freedom == first.freedom and j.score.gain >= least]
    simplest = one_sided(next((j for j in [first, *equal] if not _effect(j).rare), first), level)
    return [simplest, *(j for j in judgements if j is not simplest)]


def _logged(j: ScoredCandidate) -> bool:
    return bool({*CHANNELS} & {*_effect(j).reads})


def _of_less(level: Sequence[ScoredCandidate]) -> ScoredCandidate:
    """Return the first of what explains the same, or another one as simple that reads part of its signals alone.

    The first is then what the other is where the rest of its signals hardly changes: while a motion goes one way, a force that varies
    with place (cogging) and friction that does are one; over two seconds a constant offset and one that drifts.
    """
    first = level[0]
    reads = set(_effect(first).reads)
    same = (j for j in level if j.freedom == first.freedom and (_effect(j).reads or _effect(j).port == FORCE))
    return next((j for j in same if set(_effect(j).reads) < reads), first)


def _effect(j: ScoredCandidate) -> Effect:
    return j.candidate.plant[j.candidate.key]


def _sound(judgements: Sequence[ScoredCandidate], criteria: Criteria, state: State) -> ScoredCandidate:
    """Return the first judgement, or where it has values that no machine has the best other one that takes `near` of what it does."""
    first = judgements[0]
    if not (first.refitted and absurd(first, state)):
        return first
    least = criteria.near * first.score.gain
    others = (j for j in judgements[1:] if j.refitted and j.score.earns and j.score.gain >= least)
    return next((j for j in others if not absurd(j, state)), first)


def _plainest_first(
    judgements: Sequence[ScoredCandidate], criteria: Criteria, state: State, offer: Offer
) -> list[ScoredCandidate]:
    """Let a simpler effect lead in the place of one that it then is: a parameter stands where the law is another one's.

    LuGre without presliding is Stribeck's friction, a kinematic error of order 1 an eccentricity. The simpler one leads where it
    takes `near` of what the other takes; where it does not, what the other takes more is a matter of counts. What is nothing of its own does not lead (LuGre without presliding and without Stribeck's
    peak is Coulomb friction), nor what is nothing but a virgin curve where a free curve stands in the present model, nor, before anything
    was added, a wave that may be any curve.
    """
    curved = {e.at for e in state.plant.effects if e.name == FREE_CURVE}
    present = {e.key for e in state.plant.effects}
    first_of_all = not offer.declared or not {e.key for e in state.plant.effects if e.name != FREE_CURVE} - {
        *offer.declared
    }
    for _ in range(min(offer.budget.leading, len(judgements))):
        first = judgements[0]
        if of_no_mechanism(first, state) or (first_of_all and any_curve(first, state, criteria, offer)):
            judgements = _pushed_back(judgements, criteria, state)
            continue
        name = reduced_to(first, state, criteria)
        if name is None:
            break
        said = name == "" or f"{name}@{first.candidate.at}" in {
            *present,
            *first.candidate.instead,
            *first.candidate.restored,
        }
        if said or (first.candidate.at in curved and "masing" in catalogue()[name].holds):
            judgements = _pushed_back(judgements, criteria, state)
            continue
        other = next((j for j in judgements if j.candidate.effect == name and j.theta is not None), None)
        if other is None:
            break
        whole = state.errors.total
        if other.score.earns and whole - other.errors.total >= criteria.near * (whole - first.errors.total):
            other = other if other.refitted else everything_free(state, other, criteria)
            judgements = [other, *(j for j in judgements if j.candidate is not other.candidate)]
            break
        judgements = _pushed_back(judgements, criteria, state)
    return judgements


def _pushed_back(judgements: Sequence[ScoredCandidate], criteria: Criteria, state: State) -> list[ScoredCandidate]:
    """Return judgements with the first behind all others, as one that does not earn its place."""
    first, *rest = judgements
    return [*simplest_first(rest, criteria, state), replace(first, score=replace(first.score, earns=False))]


def absurd(j: ScoredCandidate, state: State) -> bool:
    """Whether a fitted candidate has values that no machine has."""
    plant = j.refitted.plant
    return bool(implausible(plant[j.candidate.key], plant, state.problem.plant, state.inverses))


def alike(best: ScoredCandidate, other: ScoredCandidate, criteria: Criteria, power: float) -> bool:
    """Whether `best` takes away no more of what `other` leaves on held-out blocks than its scatter, than what is of
    practical size, twice that of a rare one, or than `lesser` of what `other` takes and `unaccounted` of the drive, in rms. power: of that.

    A ratio over blocks, as every gain: a few blocks in which much is left would drown a plain difference in scatter.
    """
    further, scatter = gain(other.errors, best.errors)
    plainly = criteria.practical * (2.0 if best.candidate.plant[best.candidate.key].rare else 1.0)
    more = other.errors.total - best.errors.total
    # what the other takes of the present residual, by its gain and what it leaves
    taken = other.errors.total * other.score.gain / max(1.0 - other.score.gain, 1e-300)
    small = more <= max(plainly**2 * power, min(criteria.lesser**2 * taken, criteria.unaccounted**2 * power))
    level = further <= max(criteria.alike * scatter, criteria.share) or small
    return level and best.score.gain > criteria.share
