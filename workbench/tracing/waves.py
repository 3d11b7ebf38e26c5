"""Waves of several orders, and what is none: what lives in a few places of a stroke is drawn by orders, too, some of which hardly return."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from workbench.effects.families import FREE_FORMS
from workbench.processes import shared
from workbench.tracing.budget import Budget
from workbench.tracing.candidates import ADDITION, AGAIN, Candidate, Offer, periodic
from workbench.tracing.criteria import Criteria
from workbench.tracing.free_forms import free_forms
from workbench.tracing.judge import ScoredCandidate, everything_free, judged
from workbench.tracing.orders import further_orders
from workbench.tracing.spellings import hardly_returns, spellings_in
from workbench.tracing.state import State


def of_more_orders(
    state: State, judgements: Sequence[ScoredCandidate], best: ScoredCandidate, criteria: Criteria, offer: Offer
) -> ScoredCandidate | None:
    """Return a wave that alone takes `near` of what the leading law takes, and with further orders of its own `near` of what that leaves; None
    where there is none. A law is judged whole, a wave of three orders by its first: a gear's was behind an encoder that is late by 11 ms."""
    if periodic(best.candidate.plant[best.candidate.key]):
        return None
    whole, left = state.errors.total, best.errors.total
    waves = [
        j
        for j in judgements
        if j is not best and j.candidate.kind == ADDITION and j.refitted and j.score.earns
        if periodic(j.candidate.plant[j.candidate.key]) and whole - j.errors.total >= criteria.near * (whole - left)
    ]
    found = shared(lambda j: orders_say_it(state, j, (1.0 - criteria.near) * left, criteria, offer), waves)
    return next((j for j, says in zip(waves, found, strict=True) if says), None)


def orders_say_it(state: State, nearest: ScoredCandidate, most: float, criteria: Criteria, offer: Offer) -> bool:
    """Whether a periodic formula and further orders of it, as many as a search would add, leave no more than `most`: a wave of several
    orders, of which none takes much of the whole, and each is seen to return: any curve is drawn by what hardly returns beside what does."""
    if not periodic(nearest.candidate.plant[nearest.candidate.key]) or nearest.theta is None:
        return False
    for _ in AGAIN:
        nearest = nearest if nearest.refitted else everything_free(state, nearest, criteria)
        if nearest.refitted is None or hardly_returns(nearest, state):
            return False
        state = nearest.state or nearest.refitted.state
        again = further_orders(nearest.candidate, state, offer)
        found = [ScoredCandidate(c, **judged(state, c, criteria, offer.budget)) for c in again]
        nearest = min((j for j in found if j.theta is not None), key=lambda j: j.errors.total, default=None)
        if nearest is None or nearest.errors.total <= most:
            return nearest is not None and not hardly_returns(everything_free(state, nearest, criteria), state)
    return False


def lives_in_places(state: State, best: ScoredCandidate, criteria: Criteria, offer: Offer) -> bool:
    """Whether a wave is what lives in places: a curve of its class takes so much that neither the wave takes `resembles` of it, nor its further
    orders say it, nor a law of the class beside it. Of dirt in two places of a rail a wave takes a third of what a curve does, of the joint of
    two rails a quarter."""
    family, at = best.candidate.family, best.candidate.at
    if family not in FREE_FORMS or not periodic(best.candidate.plant[best.candidate.key]):
        return False
    whole = state.errors.total
    taken = whole - best.errors.total
    if taken >= criteria.resembles * whole:
        return False  # whatever a curve takes
    found = judged_forms(state, {(family, at)}, criteria, offer.budget)
    most = max((whole - j.errors.total for j in found), default=0.0)
    if taken >= criteria.resembles * most:
        return False
    least = whole - criteria.near * most
    return not (orders_say_it(state, best, least, criteria, offer) or two_say_it(state, best, least, criteria, offer))


def two_say_it(state: State, best: ScoredCandidate, most: float, criteria: Criteria, offer: Offer) -> bool:
    """Whether a formula with another of its class leaves no more than `most`, one of them periodic and the other not, or one the same in both
    directions and the other a difference between them: a spring and a cogging, Stribeck's friction and an asymmetry are two effects and no
    law of one; so are a data sheet's wrong value and a cogging. Of the other one every spelling is asked."""
    if best.refitted is None:
        return False
    beside, own = best.state or best.refitted.state, _symmetry(best.candidate)
    offered = replace(offer, own=(*offer.own, *spellings_in(best.candidate.family)))
    others = [
        c
        for c in offered.candidates(beside.plant)
        if (c.kind, c.family, c.at) == (ADDITION, best.candidate.family, best.candidate.at)
        and not c.instead
        and _symmetry(c) != own
    ]
    found = shared(lambda c: judged(beside, c, criteria, offer.budget), others)
    return any(one["errors"].total <= most for one in found if one.get("theta") is not None)


def _symmetry(candidate: Candidate) -> tuple[bool, bool]:
    """Return whether a law is periodic, and whether it is even in the motion."""
    effect = candidate.plant[candidate.key]
    return periodic(effect), "even" in effect.holds


def judged_forms(
    state: State, asked: Collection[tuple[str, str]], criteria: Criteria, budget: Budget
) -> list[ScoredCandidate]:
    """Return the free forms that earn their place. asked: (family, place) of those that are judged."""
    families = sorted({family for family, _ in asked})
    forms = [
        f
        for f in free_forms(state.plant, state.inverses, families, state.left_at)
        if (f.family, f.candidate.at) in asked
    ]
    found = shared(lambda f: judged(state, f.candidate, criteria, budget), forms)
    scored = [ScoredCandidate(f.candidate, **one) for f, one in zip(forms, found, strict=True)]
    return [j for j in scored if j.score.earns and j.theta is not None]
