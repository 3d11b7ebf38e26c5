"""The class of a cause by its free-form law, where no formula of the class comes near.

Nature keeps to no formula: viscous friction grows with some power of speed, a warm-up decays. The free-form law of the leading
families bounds what any of their formulas could take. Where the best formula takes plainly less than that, and yet enough to say
which class it is, the free form is added in its stead and bears the formula's name.

Where the best formula takes much, and from block to block another share, it bends within what was fitted and goes astray beyond: -v|v|
stands for friction that levels off. Another spelling of its law, or the free form, may say the same of every block.
"""

from collections.abc import Sequence
from dataclasses import replace

from workbench.effects.families import FREE_FORMS
from workbench.tracing import spellings
from workbench.tracing.candidates import ADDITION, WHOLE, Offer, periodic
from workbench.tracing.criteria import Criteria
from workbench.tracing.free_forms import MEMORY
from workbench.tracing.judge import ScoredCandidate, refitted_as
from workbench.tracing.one_sided import asked_freely
from workbench.tracing.plausible import BESIDE, RETURNS
from workbench.tracing.ranking import absurd
from workbench.tracing.reducing import reduced_to
from workbench.tracing.state import State
from workbench.tracing.waves import judged_forms, orders_say_it, two_say_it


def free_law(
    state: State,
    judgements: Sequence[ScoredCandidate],
    best: ScoredCandidate,
    added: Sequence[ScoredCandidate],
    criteria: Criteria,
    offer: Offer = WHOLE,
) -> ScoredCandidate | None:
    """Return the law that is added in the place of `best`: another spelling of it, or its class' free form; None where `best` says it as well.

    offer: what is judged. added: before it; a formula of the class among them names the free form, which then says it all. A wave that
    hardly returns gives way to a law that may be any curve.
    judgements: of the step, best first. A formula says it as well that takes `near` of what another law takes, or leaves no
    more than what is of practical size beside it, or so does with another formula of its class; it names the class from `resembles` of it on,
    or what the free form is by its values (waves of one turn of the axis are its encoder's).
    """
    other = spellings.commoner(state, judgements, best, criteria, offer)
    other = other or spellings.better_spelled(state, best, criteria, offer, judgements)
    judgements = spellings.no_wave(state, judgements, best, criteria)
    if other is None and best not in judgements:
        other = min(
            (j for j in judgements if spellings.of_class(j, best)), key=lambda j: (j.errors.total, j.candidate.key)
        )
    leads = other or best
    if spellings.hardly_returns(leads, state, BESIDE if _beside_curve(leads, added) else RETURNS):
        free = _curve_of(state, leads, added, criteria, offer)
    else:
        free = _freed(state, judgements, leads, added, criteria, offer)
    return free or (refitted_as(state, other, criteria) if other else None)


def _beside_curve(wave: ScoredCandidate, added: Sequence[ScoredCandidate]) -> bool:
    """Whether a curve of a wave's class, which is no wave itself, was added before at its place."""
    return any(spellings.of_class(wave, j) and not periodic(j.candidate.plant[j.candidate.key]) for j in added)


def _as_well(state: State, j: ScoredCandidate, than: ScoredCandidate, criteria: Criteria) -> bool:
    """Whether a law takes `near` of what another one takes, or leaves no more than what is of practical size beside it."""
    taken, most = (state.errors.total - k.errors.total for k in (j, than))
    return taken >= criteria.near * most or most - taken <= criteria.practical**2 * state.power


def _freed(
    state: State,
    judgements: Sequence[ScoredCandidate],
    best: ScoredCandidate,
    added: Sequence[ScoredCandidate],
    criteria: Criteria,
    offer: Offer,
) -> ScoredCandidate | None:
    """Return the free-form law that is added in the place of `best`, None where `best` says it as well. Arguments as of `free_law`."""
    formulas = [
        j
        for j in asked_freely(best, judgements)
        if j.candidate.kind == ADDITION and j.score.gain > criteria.share and not j.candidate.bare
    ]
    asked: dict[tuple[str, str], ScoredCandidate] = {}
    for j in formulas:
        asked.setdefault((j.candidate.family, j.candidate.at), j)
    asked = {k: j for k, j in list(asked.items())[: offer.budget.families] if k[0] in FREE_FORMS and k[0] != MEMORY}
    forms = judged_forms(state, asked, criteria, offer.budget)
    if not forms:
        return None
    free = min(forms, key=lambda j: (j.errors.total, j.candidate.key))
    if _as_well(state, best, free, criteria):
        return None
    whole = state.errors.total
    most = whole - free.errors.total
    own = spellings.of_class(free, best)
    if own and two_say_it(state, best, whole - criteria.near * most, criteria, offer):
        return None
    nearest = asked[(free.candidate.family, free.candidate.at)]
    if earlier := _named_before(free, added):
        return _bearing(earlier, free, state, criteria)
    named = whole - nearest.errors.total >= criteria.resembles * most
    if named and not own:
        # a drive that fades was before an asymmetry, which with a square of speed is the whole curve
        nearest = nearest if nearest.refitted else refitted_as(state, nearest, criteria)
        if two_say_it(state, nearest, whole - criteria.near * most, criteria, offer):
            return nearest if nearest.state else refitted_as(state, nearest, criteria)
    if not named and not orders_say_it(state, nearest, whole - criteria.near * most, criteria, offer):
        return None
    fitted = refitted_as(state, free, criteria)
    name = reduced_to(fitted, state, criteria) or nearest.candidate.effect
    return replace(fitted, candidate=replace(fitted.candidate, stands=name))


def _curve_of(
    state: State, wave: ScoredCandidate, added: Sequence[ScoredCandidate], criteria: Criteria, offer: Offer
) -> ScoredCandidate | None:
    """Return what stands for a wave that hardly returns within the travel, where the free form of its class takes `near` of what the wave
    takes; None where it does not. A formula of few numbers that says nearly as much as that curve; else the curve itself, which bears the name
    of what was found of the class before, else of the law that it is nearest to."""
    family, at = wave.candidate.family, wave.candidate.at
    asked = {(family, at)} if family in FREE_FORMS else set()
    forms = judged_forms(state, asked, criteria, offer.budget)
    free = min(forms, key=lambda j: (j.errors.total, j.candidate.key), default=None)
    whole = state.errors.total
    if free is None or whole - free.errors.total < criteria.near * (whole - wave.errors.total):
        return None
    earlier = _named_before(free, added)
    if not earlier and (formula := spellings.of_a_curve(state, free, criteria, offer)):
        return refitted_as(state, formula, criteria)
    return _bearing(earlier or _nearest(family, at, state) or wave.candidate.effect, free, state, criteria)


def _nearest(family: str, at: str, state: State) -> str:
    """Return the name that a curve of a class bears: what pulls beside a spring that is declared is that one's stiffness, which changes."""
    nearest = FREE_FORMS[family].nearest
    return spellings.BENT if nearest and spellings.sprung(at, state) else nearest


def _named_before(free: ScoredCandidate, added: Sequence[ScoredCandidate]) -> str:
    """Return the name of what was added of a free form's class at its place, "" where nothing was."""
    return next((j.candidate.name for j in added if spellings.of_class(free, j)), "")


def _bearing(name: str, free: ScoredCandidate, state: State, criteria: Criteria) -> ScoredCandidate:
    """Return a free form under a name, fitted with everything free."""
    return refitted_as(state, replace(free, candidate=replace(free.candidate, stands=name)), criteria)


def steadier(
    state: State, judgements: Sequence[ScoredCandidate], criteria: Criteria, offer: Offer = WHOLE
) -> ScoredCandidate | None:
    """Return another law of the class of what leads without earning its place, which earns it and takes no less; None where there is none.

    judgements: of the step, best first. What takes less than `plain` asks for none. Other spellings of the leading law and of the others of its
    class (those that name one as their `nearest`) are judged, and the free form of its class; a spelling that takes `near` of what the free form
    takes comes first. A free form bears the leading law's name where a formula takes `resembles` of what it takes, else there is none.
    """
    first = next((j for j in judgements if not j.candidate.bare), None)
    if first is None or first.score.earns or first.candidate.kind != ADDITION or first.score.gain <= criteria.plain:
        return None
    family, at, name = first.candidate.family, first.candidate.at, first.candidate.name
    laws = [first, *(j for j in judgements if j is not first and spellings.of_class(j, first))]
    formulas = [
        spellings.as_of_a_spring(j, state)
        for j in spellings.spelled(state, laws, criteria, offer)
        if j.errors.total <= first.errors.total
    ]
    free = {(family, at)} if family in FREE_FORMS and family != MEMORY else set()
    forms = [j for j in judged_forms(state, free, criteria, offer.budget) if j.errors.total <= first.errors.total]
    best, form = (min(x, key=lambda j: (j.errors.total, j.candidate.key), default=None) for x in (formulas, forms))
    whole = state.errors.total
    most = whole - form.errors.total if form else 0.0
    if best is not None and whole - best.errors.total >= criteria.near * most:
        return refitted_as(state, best, criteria)
    nearest = best or first
    if form is None or whole - nearest.errors.total < criteria.resembles * most:
        return None
    return refitted_as(state, replace(form, candidate=replace(form.candidate, stands=name)), criteria)


def otherwise_spelled(
    state: State, added: Sequence[ScoredCandidate], criteria: Criteria, offer: Offer = WHOLE
) -> ScoredCandidate | None:
    """Return the spelling of a law of any class but those of what was added that says plainly what no traced formula does
    (`spellings.of_any_law`), fitted with everything free; None where there is none, or its values are no machine's."""
    best = spellings.of_any_law(state, {(j.candidate.family, j.candidate.at) for j in added}, criteria, offer)
    one = refitted_as(state, best, criteria) if best else None
    return one if one and one.state is not None and one.score.earns and not absurd(one, state) else None
