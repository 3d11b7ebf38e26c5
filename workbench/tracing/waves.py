"""What a free form would say in the place of: waves of several orders, and two formulas of one class."""

from collections.abc import Collection
from dataclasses import replace

from workbench.processes import shared
from workbench.tracing.budget import Budget
from workbench.tracing.candidates import ADDITION, AGAIN, Candidate, Offer, periodic
from workbench.tracing.criteria import Criteria
from workbench.tracing.free_forms import free_forms
from workbench.tracing.judge import ScoredCandidate, everything_free, judged
from workbench.tracing.orders import further_orders
from workbench.tracing.spellings import hardly_returns, spellings_in
from workbench.tracing.state import State


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
