"""What validation does not carry, asked again: another law of its class that says as much, and there, too.

A formula that is only near bends within the records that were fitted, and goes astray beyond them: -v|v| stands for friction that
levels off, until an axis moves faster. A class has other laws; which one it is shows where the motion is another one.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace
from math import inf

from workbench.definition import catalogue
from workbench.effects.families import FREE_FORMS, family_at
from workbench.identification.result import Fit
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing.candidates import ADDITION
from workbench.tracing.choice import Choice
from workbench.tracing.criteria import Criteria
from workbench.tracing.evidence import Weighed
from workbench.tracing.free_forms import MEMORY, free_forms
from workbench.tracing.judge import ScoredCandidate, judged, refitted_as
from workbench.tracing.ranking import absurd
from workbench.tracing.spellings import bearing, of_class, special_cases, spellings_of
from workbench.tracing.state import State
from workbench.tracing.weighing import Confirmed


def otherwise(choice: Choice) -> Choice:
    """Return the choice with another law in the place of the addition that takes most, where validation does not carry it and the other
    leaves plainly less there; where it does carry that one, in the place of a free form that it does not. Of other lesser ones a free form
    would take what is left of the greatest; a curve over speed goes astray beyond the speeds that were fitted, and a formula goes on.

    A law takes another one's place that leaves no more on identification (in the place of a free form it takes `near` of what that took),
    and less on validation, by what is of practical size; of several the one that leaves least there. Where all is carried and `beside` of the drive
    is left there, a plausible law does that takes `held` of that power: over part of a stroke a weight is a spring. The choice itself where there is none.

    Of 571 campaigns and axes 37 are asked so, and one says something else: a spring is a weight, which takes 0.53 of it. With none of `held` asked,
    a joint of two slopes is two parts in series (0.17); doubled, the weight is a spring. Free forms are not asked there: they would say no other name.
    """
    criteria, best, now = choice.criteria, None, choice.confirmed.fits[-1]
    asked = _that_may_give_way(choice)
    doubted = [j for j, w in asked if _doubted(w, criteria)]
    carried = not doubted and now.validation >= criteria.beside
    j = next(iter(doubted), asked[0][0] if asked and carried else None)
    if j is None or j.candidate.instead:
        return choice
    most = (1.0 - criteria.held) * now.validation**2 if carried else inf
    choice.progress(
        f"asking for another law than {j.candidate.key}, which validation {'may tell' if carried else 'does not carry'}"
    )
    for k in _laws(choice, j, sound=carried):
        kept, fits = choice.fitted_with(k, j)
        before = choice.confirmed.fits[choice.confirmed.added.index(j)] if j.candidate.stands and best is None else None
        enough = len(kept) == len(choice.confirmed.added) and fits[-1].validation ** 2 <= most
        if enough and _better(fits[-1], now, criteria, before):
            now, best = fits[-1], (k, kept, fits)
    return choice if best is None else choice.taking(*best)


def _that_may_give_way(choice: Choice) -> list[tuple[ScoredCandidate, Weighed]]:
    """Return the additions that may give way to another law, as weighed: the one that takes most, then free forms."""
    if choice.largest is None:
        return []
    both = zip(choice.confirmed.added, choice.confirmed.weighed, strict=True)
    return [choice.largest, *(x for x in both if x[0].candidate.stands and x[0] is not choice.largest[0])]


def in_place_of_two(choice: Choice) -> Choice:
    """Return the choice with one law in the place of two of one class at one place, where it leaves no more than these together in either
    role.

    Two formulas of a class make up for a third one: friction that goes with a root of speed is one of its square, reversed, and a peak.
    It bears the name of the one whose spelling it is, or that of the other where that is a special case of it and takes `near` of both:
    friction that goes with speed to the power 0.9 is viscous, with a little of its square, reversed.
    """
    pair = _of_one_class(choice.confirmed)
    if pair is None:
        return choice
    j, lesser = pair
    choice.progress(f"asking for one law in the place of {j.candidate.key} and {lesser.candidate.key}")
    both, small = choice.confirmed.fits[-1], choice.criteria.practical**2
    for k in _laws(choice, j, lesser):
        kept, fits = choice.fitted_with(k, j, lesser)
        if len(kept) == len(choice.confirmed.added) - 1 and all(
            getattr(fits[-1], r) ** 2 <= getattr(both, r) ** 2 + small for r in (IDENTIFICATION, VALIDATION)
        ):
            special = lesser.candidate.name in special_cases(k)
            if special and _takes_most(lesser, j, choice.confirmed, choice.criteria):
                renamed = bearing(lesser, k)
                kept, k = [renamed if a is k else a for a in kept], renamed
            return choice.taking(k, kept, fits)
    return choice


def _takes_most(one: ScoredCandidate, other: ScoredCandidate, confirmed: Confirmed, criteria: Criteria) -> bool:
    """Whether one of two additions takes `near` of what both take of the identification records."""
    power = {
        j.candidate.key: max(w.size(IDENTIFICATION), 0.0) ** 2
        for j, w in zip(confirmed.added, confirmed.weighed, strict=True)
    }
    both = power[one.candidate.key] + power[other.candidate.key]
    return power[one.candidate.key] >= criteria.near * both > 0.0


def as_a_curve(choice: Choice) -> Choice:
    """Return the choice with the free form of its class in the place of the addition that takes most, where it leaves less in either role,
    by `beside` of the drive.

    A formula that takes `near` of what its class can take names the cause, and may leave much of it: of a drive that saturates,
    a tenth; what comes near to that dresses it then.
    """
    criteria, now = choice.criteria, choice.confirmed.fits[-1]
    if choice.largest is None or now.identification < criteria.beside:
        return choice
    j, _ = choice.largest
    if j.candidate.instead:
        return choice
    choice.progress(f"asking what {j.candidate.key} leaves of its law")
    state = choice.less(j)
    for k in _fitted(state, _curves(state, j, choice), j, (), choice) if state else ():
        kept, fits = choice.fitted_with(k, j)
        left = (getattr(now, r) ** 2 - getattr(fits[-1], r) ** 2 for r in (IDENTIFICATION, VALIDATION))
        if len(kept) == len(choice.confirmed.added) and all(x >= criteria.beside**2 for x in left):
            return choice.taking(k, kept, fits)
    return choice


def _of_one_class(confirmed: Confirmed) -> tuple[ScoredCandidate, ScoredCandidate] | None:
    """Return two additions of one class at one place, the one that takes more first, where the class has another law of that one's name."""
    sizes = zip(confirmed.added, (w.size(IDENTIFICATION) for w in confirmed.weighed), strict=True)
    added = [
        j for j, _ in sorted(sizes, key=lambda x: -x[1]) if j.candidate.kind == ADDITION and not j.candidate.instead
    ]
    named = {e.nearest for e in catalogue().values() if not e.traced}
    of = [(j, (j.candidate.family, j.candidate.at)) for j in added]
    pairs = ((j, k) for n, (j, x) in enumerate(of) for k, y in of[n + 1 :] if x == y)
    asked = (p for j, k in pairs for p in ((j, k), (k, j)) if p[0].candidate.name in named)
    return next(asked, None)


def _doubted(w: Weighed, criteria: Criteria) -> bool:
    """Whether validation hardly carries an addition, by the error of the drive alone; without a validation record nothing says so."""
    identification, validation = (
        1.0 - (w.after[r] / max(w.before[r], 1e-300)) ** 2 for r in (IDENTIFICATION, VALIDATION)
    )
    return validation < criteria.doubted * identification


def _better(fit: Fit, than: Fit, criteria: Criteria, before: Fit | None = None) -> bool:
    """Whether a fit leaves no more than another one on identification, and less on validation, by what is of practical size.

    before: the fit without a free form that `than` has; its curve bends to everything, so `near` of what it takes will do.
    """
    small = criteria.practical**2
    left = than.identification**2 + small
    if before is not None:
        left = max(left, before.identification**2 - criteria.near * (before.identification**2 - than.identification**2))
    return fit.identification**2 <= left and fit.validation**2 < than.validation**2 - small


def _laws(choice: Choice, j: ScoredCandidate, *beside: ScoredCandidate, sound: bool = False) -> list[ScoredCandidate]:
    """Return the other laws of an addition's class at its place, fitted beside all else that was added, best first. beside: another
    addition, in whose place they would be as well, when those of another spelling alone are asked, and stand if a machine may have their values.
    sound: whether formulas alone are asked, which stand if a machine may have their values."""
    state, offer = choice.less(j, *beside), choice.offer
    if state is None:
        return []
    own = choice.selected.answer.last.plant[j.candidate.key]
    here = (e for e in catalogue().values() if family_at(e, j.candidate.at) == j.candidate.family)
    same = [e for e in here if e.name != own.name]
    asked = [e for e in same if e.traced and not beside and (offer.only is None or e.name in offer.only)]
    near = [e for e in spellings_of(j.candidate) if e.name != own.name]
    found: list[ScoredCandidate] = []
    if asked or near:
        found += choice.judged(state, replace(offer, only={e.name for e in (*asked, *near)}, own=(*offer.own, *near)))
    # one curve takes what two of a class are, and validation may carry the second alone
    if not (beside or sound or any(k is not j and of_class(j, k) for k in choice.confirmed.added)):
        found += _curves(state, j, choice)
    fitted = _fitted(state, found, j, {e.name for e in asked}, choice)
    return [k for k in fitted if not ((beside or sound) and absurd(k, state))]


def _curves(state: State, j: ScoredCandidate, choice: Choice) -> list[ScoredCandidate]:
    """Return the free form of an addition's class, judged; none where it stands for it already, or there is none."""
    family = j.candidate.family
    if family not in FREE_FORMS or family == MEMORY or j.candidate.stands:
        return []
    forms = free_forms(state.plant, state.inverses, [family], state.left_at)
    return [
        ScoredCandidate(f.candidate, **judged(state, f.candidate, choice.criteria, choice.offer.budget)) for f in forms
    ]


def _fitted(
    state: State, found: Sequence[ScoredCandidate], j: ScoredCandidate, named: Collection[str], choice: Choice
) -> list[ScoredCandidate]:
    """Return what of judged laws earns its place where an addition is, with everything free, best first. named: as `_called` takes them."""
    here = [k for k in found if k.candidate.at == j.candidate.at and k.score.earns and k.theta is not None]
    best = sorted(here, key=lambda k: (k.errors.total, k.candidate.key))[: choice.offer.budget.laws]
    fitted = (k if k.state else refitted_as(state, k, choice.criteria) for k in best)
    return [_called(k, j, named) for k in fitted if k.state]


def _called(k: ScoredCandidate, j: ScoredCandidate, named: Collection[str]) -> ScoredCandidate:
    """Return a law under the name that it bears: its own, if that is one that causes have; else that of the law it is in place of."""
    if k.candidate.effect in named:
        return k
    bears = {"part": j.candidate.name} if k.candidate.plant[k.candidate.key].nearest else {"stands": j.candidate.name}
    return replace(k, candidate=replace(k.candidate, **bears))
