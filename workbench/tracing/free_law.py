"""The class of a cause by its free-form law, where no formula of the class comes near.

Nature keeps to no formula: viscous friction grows with some power of speed, a warm-up decays. The free-form law of the leading
families bounds what any of their formulas could take. Where the best formula takes plainly less than that, and yet enough to say
which class it is, the free form is added in its stead and bears the formula's name.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

from workbench.effects.families import FREE_FORMS
from workbench.processes import shared
from workbench.tracing.budget import Budget
from workbench.tracing.candidates import ADDITION, WHOLE, Offer, periodic
from workbench.tracing.criteria import Criteria
from workbench.tracing.free_forms import MEMORY, free_forms
from workbench.tracing.judge import ScoredCandidate, judged, refitted_as
from workbench.tracing.state import State


def free_law(
    state: State,
    judgements: Sequence[ScoredCandidate],
    best: ScoredCandidate,
    added: Sequence[ScoredCandidate],
    criteria: Criteria,
    offer: Offer = WHOLE,
) -> ScoredCandidate | None:
    """Return the free-form law that is added in the place of `best`, or None where that formula says it as well.

    offer: what is judged. added: before it; a formula of the class among them names the free form, which then says it all.
    judgements: of the step, best first. A formula says it as well that takes `near` of what the free form takes, or leaves no
    more than what is of practical size beside it, or so does with another formula of its class; it names the class from `resembles` of it on.
    """
    formulas = [j for j in judgements if j.candidate.kind == ADDITION and j.score.gain > criteria.share]
    asked: dict[tuple[str, str], ScoredCandidate] = {}
    for j in formulas:
        asked.setdefault((j.candidate.family, j.candidate.at), j)
    asked = {k: j for k, j in list(asked.items())[: offer.budget.families] if k[0] in FREE_FORMS and k[0] != MEMORY}
    forms = _judged_forms(state, asked, criteria, offer.budget)
    if not forms:
        return None
    free = min(forms, key=lambda j: (j.errors.total, j.candidate.key))
    whole = state.errors.total
    most, own = whole - free.errors.total, whole - best.errors.total
    if own >= criteria.near * most or best.errors.total - free.errors.total <= criteria.practical**2 * state.power:
        return None
    family = free.candidate.family
    if (best.candidate.family, best.candidate.at) == (family, free.candidate.at):
        if _two_say_it(state, best, whole - criteria.near * most, criteria, offer):
            return None
    nearest = asked[(family, free.candidate.at)]
    earlier = [j for j in added if j.candidate.at == free.candidate.at and j.candidate.family == family]
    if earlier:
        return refitted_as(
            state, replace(free, candidate=replace(free.candidate, stands=earlier[0].candidate.name)), criteria
        )
    if whole - nearest.errors.total < criteria.resembles * most:
        return None
    named = replace(free.candidate, stands=nearest.candidate.effect)
    return refitted_as(state, replace(free, candidate=named), criteria)


def _two_say_it(state: State, best: ScoredCandidate, most: float, criteria: Criteria, offer: Offer) -> bool:
    """Whether a formula with another of its class, one of them periodic and the other not, leaves no more than `most`: a spring and a
    cogging, which are two effects and no law of one."""
    if best.candidate.kind != ADDITION or best.refitted is None:
        return False
    beside, own = best.state or best.refitted.state, periodic(best.candidate.plant[best.candidate.key])
    others = [
        c
        for c in offer.candidates(beside.plant)
        if (c.kind, c.family, c.at) == (ADDITION, best.candidate.family, best.candidate.at)
        and not c.instead
        and periodic(c.plant[c.key]) != own
    ]
    found = shared(lambda c: judged(beside, c, criteria, offer.budget), others)
    return any(one["errors"].total <= most for one in found if one.get("theta") is not None)


def _judged_forms(
    state: State, asked: Collection[tuple[str, str]], criteria: Criteria, budget: Budget
) -> list[ScoredCandidate]:
    """Return the free forms that earn their place. asked: (family, place) of those that are judged."""
    families = sorted({family for family, _ in asked})
    forms = [
        f
        for f in free_forms(state.plant, state.inverses, families, state.residuals)
        if (f.family, f.candidate.at) in asked
    ]
    found = shared(lambda f: judged(state, f.candidate, criteria, budget), forms)
    scored = [ScoredCandidate(f.candidate, **one) for f, one in zip(forms, found, strict=True)]
    return [j for j in scored if j.score.earns and j.theta is not None]
