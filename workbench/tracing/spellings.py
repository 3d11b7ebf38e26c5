"""Other spellings of a law: effects that name a traced one as their `nearest`, asked where that one leads, under its name.

Friction goes with a root of speed, a hose comes taut at a place, a joint hardens by another power than the third, a drift settles. Each
is a law of the class with a number more; offered in every round they would dress what is left, so they are asked of what leads.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

from workbench.definition import FORCE, Effect, catalogue
from workbench.effects.families import FREE_FORMS, family_of
from workbench.processes import shared
from workbench.tracing.candidates import ADDITION, Candidate, Offer
from workbench.tracing.criteria import Criteria
from workbench.tracing.judge import ScoredCandidate, judged
from workbench.tracing.plausible import RETURNS, returns
from workbench.tracing.ranking import absurd, alike
from workbench.tracing.state import State

SPRING, BENT, CABLE = "linear_stiffness", "piecewise_stiffness", "cable_spring"
HARDENING = {"hardening_cable": "cubic_stiffness"}  # laws of a cable that are a smooth spring's beside a declared one


def spellings_of(candidate: Candidate) -> list[Effect]:
    """Return the effects that are another spelling of a candidate's law at its place, by the name that it bears."""
    same = [e for e in catalogue().values() if not e.traced and e.nearest == candidate.name]
    return [e for e in same if family_of(e(at=candidate.at)) == candidate.family]


def spellings_in(family: str) -> list[Effect]:
    """Return the effects that are other spellings of traced laws of a class."""
    return [e for e in catalogue().values() if not e.traced and e.nearest and e.family == family]


def with_spelling(j: ScoredCandidate, offer: Offer) -> Offer:
    """Return an offer that holds a candidate's law, too, where that is another spelling: no offer of the catalogue's has it."""
    law = catalogue().get(j.candidate.effect)
    if law is None or law.traced or j.candidate.part != law.nearest:
        return offer
    return replace(offer, only=None if offer.only is None else {*offer.only, law.name}, own=(*offer.own, law))


def called_as(j: ScoredCandidate, known: ScoredCandidate) -> ScoredCandidate:
    """Return a judgement under the name that another one of the same effect bears."""
    same = j.candidate.key == known.candidate.key
    return replace(j, candidate=replace(j.candidate, part=known.candidate.part)) if same else j


def spelled(state: State, laws: Sequence[ScoredCandidate], criteria: Criteria, offer: Offer) -> list[ScoredCandidate]:
    """Return the other spellings of laws at their places (those that name one as their `nearest`) that earn their place, under its name."""
    asked: dict[tuple[str, str], Candidate] = {}
    for j in laws:
        here = [c for c in _offered(spellings_of(j.candidate), state, offer) if c.at == j.candidate.at]
        asked |= {(c.effect, c.at): replace(c, part=j.candidate.name) for c in here}
    return _earning(state, [*asked.values()], criteria, offer)


def of_any_law(
    state: State, known: Collection[tuple[str, str]], criteria: Criteria, offer: Offer
) -> ScoredCandidate | None:
    """Return the other spelling, of a law of whatever class, that takes most of a state beside which nothing earns its place, where that is certain and of
    practical size; None where there is none, or where all that is left is less than `explainable`. known: (family, place) of which none is asked,
    for their laws were asked for in their own round.

    A formula may take nothing of what its other spelling takes: beside a friction that varies with place, -v|v| nothing of a root of speed. Asked of a
    declared model alone it dressed one of 61 axes, which lacks what no law is; where another effect earns its place without leading, one that a weight
    hangs from.
    """
    if state.errors.total <= criteria.explainable**2 * state.power:
        return None
    others = [e for e in catalogue().values() if not e.traced and e.nearest]
    others = [e for e in others if offer.only is None or e.nearest in offer.only]
    offered = (c for c in _offered(others, state, offer) if (c.family, c.at) not in known)
    asked = [replace(c, part=catalogue()[c.effect].nearest) for c in offered]
    found = [as_of_a_spring(j, state) for j in _earning(state, asked, criteria, offer)]
    best = min(found, key=lambda j: (j.errors.total, j.candidate.key), default=None)
    if best is None or state.errors.total - best.errors.total <= criteria.practical**2 * state.power:
        return None
    return best


def of_a_curve(state: State, free: ScoredCandidate, criteria: Criteria, offer: Offer) -> ScoredCandidate | None:
    """Return the other spelling of a law of a free form's class at its place that takes `near` of what the curve takes, under the name that it
    bears; None where there is none. A skin that is stretched near both ends of a nod is two springs of four numbers."""
    own = [e for e in spellings_in(free.candidate.family) if offer.only is None or e.nearest in offer.only]
    here = [c for c in _offered(own, state, offer) if c.at == free.candidate.at]
    asked = [replace(c, part=catalogue()[c.effect].nearest) for c in here]
    found = [as_of_a_spring(j, state) for j in _earning(state, asked, criteria, offer)]
    best = min(found, key=lambda j: (j.errors.total, j.candidate.key), default=None)
    whole = state.errors.total
    says = best is not None and whole - best.errors.total >= criteria.near * (whole - free.errors.total)
    return best if says else None


def _offered(others: Sequence[Effect], state: State, offer: Offer) -> list[Candidate]:
    """Return candidates of laws that are other spellings."""
    names = {e.name for e in others}
    offered = replace(offer, only=names, own=(*offer.own, *others)).candidates(state.plant) if others else []
    return [c for c in offered if c.kind == ADDITION and c.effect in names]


def _earning(state: State, asked: Sequence[Candidate], criteria: Criteria, offer: Offer) -> list[ScoredCandidate]:
    """Return those of candidates that earn their place."""
    found = shared(lambda c: judged(state, c, criteria, offer.budget), [*asked])
    scored = [ScoredCandidate(c, **one) for c, one in zip(asked, found, strict=True)]
    return [k for k in scored if k.score.earns and k.theta is not None]


def better_spelled(
    state: State,
    best: ScoredCandidate,
    criteria: Criteria,
    offer: Offer,
    judgements: Sequence[ScoredCandidate] = (),
) -> ScoredCandidate | None:
    """Return another spelling of the leading law, of another one of its class, or of one of the `judgements` that takes `resembles` of what it
    takes, that takes plainly more; None where there is none.

    Plainly is what tells any two effects apart (`ranking.alike`): a spelling is a law with a number more, no curve that bends to everything.
    A flexure that stiffens to many times its stiffness at rest is a spring's law by another spelling, and friction behind a gap by what
    leads: of straight springs none comes near to it. It bears the leading law's name where that is a special case of it and takes `near` of
    what it takes. A hose that pulls at one end alone is far from a spring, and a spring with a play about zero is nearer to it.
    A cable's other spelling beside a declared spring is that one's stiffness, which changes.
    """
    least_taken = criteria.resembles * (state.errors.total - best.errors.total)
    others = [j for j in judgements if j is not best and j.theta is not None]
    laws = [best, *(j for j in others if of_class(j, best) or state.errors.total - j.errors.total >= least_taken)]
    found = spelled(state, [j for j in laws if j.candidate.kind == ADDITION], criteria, offer)
    least = min(found, key=lambda j: (j.errors.total, j.candidate.key), default=None)
    if least is None or least.errors.total >= best.errors.total:
        return None
    if alike(least, best, criteria, state.power):
        return None
    near = criteria.near * (state.errors.total - least.errors.total)
    special = best.candidate.at == least.candidate.at and best.candidate.name in special_cases(least)
    if special and state.errors.total - best.errors.total >= near:
        return bearing(best, least)
    return as_of_a_spring(least, state)


def as_of_a_spring(j: ScoredCandidate, state: State) -> ScoredCandidate:
    """Return another spelling of a cable beside a declared spring under the name of that one's stiffness, which changes; a judgement as it is else."""
    of_a_spring = j.candidate.name == CABLE and sprung(j.candidate.at, state)
    return _called(HARDENING.get(j.candidate.effect, BENT), j) if of_a_spring else j


def special_cases(j: ScoredCandidate) -> set[str]:
    """Return the names of the laws that a candidate's is at special values, and of what these are: three slopes are two, and two are a gap."""
    found: set[str] = set()
    laws = [_law(j)]
    while laws:
        left = {name for _, name in laws.pop().reduces.values()} - found
        found |= left
        laws += [law for name in left if (law := catalogue().get(name))]
    return found


def bearing(known: ScoredCandidate, j: ScoredCandidate) -> ScoredCandidate:
    """Return a judgement under another one's name."""
    return _called(known.candidate.name, j)


def _called(name: str, j: ScoredCandidate) -> ScoredCandidate:
    return replace(j, candidate=replace(j.candidate, part=name))


def sprung(at: str, state: State) -> bool:
    """Whether a spring is declared at a place: what pulls beside it from somewhere on is that one's stiffness, which changes, and no cable."""
    return any((e.name, e.at) == (SPRING, at) for e in state.plant.effects)


def commoner(
    state: State, judgements: Sequence[ScoredCandidate], best: ScoredCandidate, criteria: Criteria, offer: Offer
) -> ScoredCandidate | None:
    """Return another spelling of a common law that takes as much as a rare one that leads, None where there is none: the law of the
    common one's formula alone leaves more, and takes `near` of what the rare one takes.

    In the place of values that no machine has any law's other spelling stands, however little its formula takes: a bumper that is met at one
    end, of which one that is met at both takes a third, drew friction that hardly slips along the travel.
    """
    rare, odd = _rare(best), best.refitted is not None and absurd(best, state)
    if not (rare or odd):
        return None
    taken = criteria.near * (state.errors.total - best.errors.total)
    same = [
        j
        for j in judgements
        if j.candidate.kind == ADDITION
        and j is not best
        and not _rare(j)
        and j.theta is not None
        and (odd or (of_class(j, best) and state.errors.total - j.errors.total >= taken))
    ]
    found = [k for k in spelled(state, same, criteria, offer) if alike(best, k, criteria, state.power)]
    return min(found, key=lambda j: (j.errors.total, j.candidate.key), default=None)


def no_wave(
    state: State, judgements: Sequence[ScoredCandidate], best: ScoredCandidate, criteria: Criteria
) -> list[ScoredCandidate]:
    """Return judgements without the waves of the leading law's class that hardly return within the travel, where another law of that
    class takes `resembles` of what leads; all of them else. What is not seen to return may be any curve."""
    here = [j for j in judgements if of_class(j, best)]
    waves = {j.candidate.key for j in here if hardly_returns(j, state)}
    taken = criteria.resembles * (state.errors.total - best.errors.total)
    if best.candidate.key not in waves or not any(
        j.candidate.key not in waves and state.errors.total - j.errors.total >= taken for j in here
    ):
        return [*judgements]
    return [j for j in judgements if j.candidate.key not in waves]


def of_class(j: ScoredCandidate, best: ScoredCandidate) -> bool:
    """Whether a judgement is an addition of another one's class at its place."""
    a, b = j.candidate, best.candidate
    return (a.kind, a.family, a.at) == (ADDITION, b.family, b.at)


def hardly_returns(j: ScoredCandidate, state: State, periods: float = RETURNS) -> bool:
    """Whether a fitted force in position is a wave that the travel does not show to return: it holds fewer of its periods. A turn of a rotary
    axis shows that friction returns; what pulls may be a cable, which winds on from turn to turn."""
    effect = j.refitted.plant[j.candidate.key] if j.refitted else None
    if effect is None or effect.port != FORCE or "order" not in effect.parameters:
        return False
    form = FREE_FORMS.get(j.candidate.family)
    winds = form is None or bool(form.nearest)
    return not returns(effect, state.inverses, periods, rotary=state.plant.rotary and periods == RETURNS and not winds)


def _law(j: ScoredCandidate) -> Effect:
    return j.candidate.plant[j.candidate.key]


def _rare(j: ScoredCandidate) -> bool:
    return _law(j).rare
