"""What later additions made needless, or made another effect the better answer of.

Greedy selection cannot take back a choice made while something else was missing.
"""

from collections.abc import Sequence
from dataclasses import replace

from workbench.identification.solve import NoValue
from workbench.plant import Plant
from workbench.tracing.answer import Answer
from workbench.tracing.candidates import Offer, without
from workbench.tracing.criteria import Criteria
from workbench.tracing.greedy import leading
from workbench.tracing.judge import Progress, ScoredCandidate, freedom, lighter, still_earns
from workbench.tracing.near_law import gives_way
from workbench.tracing.ranking import alike, step
from workbench.tracing.slack import bent_gap
from workbench.tracing.spellings import bearing, called_as, of_class, special_cases, with_spelling
from workbench.tracing.starting import COMPARED, FURTHER
from workbench.tracing.state import State

PROMISE = 0.05  # of the residual's power, from which a candidate is asked again when others are taken out
# Of what an effect takes, that another one must have taken in some step to be asked in its stead: what took the place of one, or stayed, had taken
# 0.82 and more on 17 campaigns that lack two. Neither halved nor doubled it changes a cause of twelve of these
INSTEAD = 0.25


def pruned(
    answer: Answer,
    declared: Plant,
    looked: list[Sequence[ScoredCandidate]],
    progress: Progress,
    offer: Offer,
    criteria: Criteria,
) -> Answer:
    """Ask of each effect but the last whether the later ones made it needless, or made another one the better answer.

    Each effect is taken out in turn and the search repeated
    with the others in place, among all that ever promised something; what leads then stands in its stead. looked: every step's judgements,
    to which these are added. What took another one's stead with less left may make those before it needless: they are
    asked once more. Returns `answer` itself where every effect stands.
    """
    begun = answer
    instead = 0  # how many stand before the last that took another one's stead
    for i in range(len(answer.added) - 1):
        present = answer.added[i]
        rest = [j for k, j in enumerate(answer.added) if k != i]
        if present.candidate.stands or bent_gap(present, rest, answer.last):
            continue  # no formula comes near to a free form: that was asked
        progress(f"asking again for {present.candidate.key}")
        try:
            bare = without(answer.last.plant, present.candidate, declared)
            reduced = State(bare, answer.last.inverses, most=FURTHER, tolerance=COMPARED)
        except NoValue:
            continue
        asked = _promising(looked, reduced.errors.total - answer.last.errors.total) | {present.score.effect}
        judgements = step(reduced, progress, with_spelling(present, replace(offer, only=asked)), criteria)
        judgements = [called_as(j, present) for j in judgements]
        best = leading(judgements)
        looked.append(lighter(judgements, best))
        again = [j for j in judgements if j.candidate.key == present.candidate.key]
        if best is not None and best in again and present.score.earns:
            continue  # else what it comes to now is its evidence
        stays = present.score.earns and still_earns(present, reduced, answer.last, criteria)
        if best is None and (stays or any(j.score.earns for j in again)):
            continue  # what earns its place is not needless, though nothing leads where the simplest of equals earns none
        another = best is not None and best not in again
        if another and present.score.earns and not _better(best, reduced, answer.last, criteria):
            if stays:
                continue
            best = None  # it takes nothing now, and what leads in its stead leaves more: neither stays
        if best is None and (alone := _alone(answer, present, reduced, declared, criteria)) is not None:
            return pruned(alone, declared, looked, progress, offer, criteria) if len(alone.added) > 1 else alone
        if best is None:
            left = [_named_after(k, present, criteria) for k in rest]
            fewer = Answer(left, answer.declared, reduced)
            return pruned(fewer, declared, looked, progress, offer, criteria) if len(left) > 1 else fewer
        # what the declared friction is only nearly right in is weighed beside all else, of which it would take a part where it came first
        last = another and gives_way(best.candidate, declared)
        answer = Answer([*rest, best] if last else [*rest[:i], best, *rest[i:]], answer.declared, best.state).standing
        instead = i if another else instead
        if last or len(answer.added) <= len(rest):
            return pruned(answer, declared, looked, progress, offer, criteria)
    if instead and answer.last.errors.total < begun.last.errors.total:
        return pruned(answer, declared, looked, progress, offer, criteria)
    return answer


def _alone(
    answer: Answer, needless: ScoredCandidate, reduced: State, declared: Plant, criteria: Criteria
) -> Answer | None:
    """Return the answer with an addition that later ones made needless, without one of its class at its place that did, where it is the simpler of
    the two and explains the same alone; None where it is not.

    Either makes the other needless, and whichever came later would stay: a joint of two slopes with a round corner is one of two parts in series,
    which has a number more. What would bear that one's name (`_named_after`) says more of the same law, and stays. reduced: the state without the addition.
    """
    for k in answer.added:
        if (
            k is needless
            or not of_class(k, needless)
            or k.candidate.instead
            or _named_after(k, needless, criteria) is not k
        ):
            continue
        try:
            plant = without(answer.last.plant, k.candidate, declared)
            state = State(plant, answer.last.inverses, most=FURTHER, tolerance=COMPARED)
        except NoValue:
            continue
        one = replace(needless, errors=state.errors)
        other = replace(k, errors=reduced.errors, score=needless.score)  # its own is of what it takes beside that one
        if freedom(state.plant) < freedom(reduced.plant) and alike(other, one, criteria, state.power):
            return Answer([j for j in answer.added if j is not k], answer.declared, state)
    return None


def _named_after(j: ScoredCandidate, needless: ScoredCandidate, criteria: Criteria) -> ScoredCandidate:
    """Return an addition, which made an earlier one needless, under that one's name where it is the free form of its class: what was near to
    it beside the formula is not what the whole curve is near to. So too where it is another spelling of which the earlier one is a special
    case that took `near` of all that was left: friction that goes with speed to the power 0.9 is viscous."""
    free, formula = j.candidate, needless.candidate
    if (
        free.part
        and free.at == formula.at
        and formula.name in special_cases(j)
        and needless.score.gain >= criteria.near
    ):
        return bearing(needless, j)
    if not free.stands or (free.family, free.at) != (formula.family, formula.at):
        return j
    return replace(j, candidate=replace(free, stands=formula.name))


def _better(other: ScoredCandidate, reduced: State, last: State, criteria: Criteria) -> bool:
    """Whether another effect is the better answer than the one in its place: it leaves less by more than is of practical size; or no more, is simpler
    beside all that was added later, and takes what is of practical size: beside a free curve of a class two of its formulas are next to nothing, and
    alike. reduced, last: the states without and with the present one."""
    less = last.errors.total - other.errors.total
    small = criteria.practical**2 * last.power
    # no more: an asymmetry of friction took 98.6 % where a constant force took 98.3 with a value less, 0.3 % of the drive apart
    simpler = other.freedom < freedom(last.plant) and less >= 0.0
    return less > small or (simpler and reduced.errors.total - other.errors.total > small)


def _promising(looked: Sequence[Sequence[ScoredCandidate]], taken: float) -> set[str]:
    """Return the names of the candidates that explained something in one of these steps, and of what an effect takes, held-out power, a share
    that is worth asking them in its stead."""
    return {
        j.score.effect
        for judgements in looked
        for j in judgements
        if j.score.gain > PROMISE and _took(j) >= INSTEAD * taken
    }


def _took(j: ScoredCandidate) -> float:
    """Return the held-out power that a candidate took of the state that it was judged beside."""
    return j.errors.total * j.score.gain / max(1.0 - j.score.gain, 1e-300)
