"""Candidates judged: each fitted beside the present model, scored on data that its fold did not see."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.effects.free_bank import NAME as FREE_CURVE
from workbench.identification.cross_validation import HeldOut, gain, held_out
from workbench.identification.problem import Problem
from workbench.identification.solve import NoValue
from workbench.inverse.prehistory import begun_at
from workbench.plant import Plant
from workbench.tracing.budget import BUDGET, Budget
from workbench.tracing.candidates import ADDITION, Candidate
from workbench.tracing.criteria import Criteria
from workbench.tracing.result import CandidateScore
from workbench.tracing.scale_of_joint import beside
from workbench.tracing.search import fitted, problem_with
from workbench.tracing.smallest import Smallest, smallest
from workbench.tracing.starting import at_own_starts, freely
from workbench.tracing.state import Refitted, State
from workbench.tracing.wording_search import gained, no_value

LOST = 0.4  # of a first fit's gain, lost on held-out blocks, from which its folds are followed

Progress = Callable[[str], None]
Starts = Sequence[float | None]  # of each record: displacement before it, m or rad, as `Record.found`
STANDARD = Criteria()


@dataclass(frozen=True, eq=False)
class ScoredCandidate:
    """A candidate and what it came to beside the present model.

    theta: where a search with everything free starts, on the search scale; None where the candidate has no value on these
    records. refitted: that fit, of those that lead. state: the state that it ended in, of the one that is chosen.
    """

    candidate: Candidate
    score: CandidateScore
    errors: HeldOut
    freedom: int
    theta: np.ndarray | None = None
    shows: Smallest | None = None
    refitted: Refitted | None = None
    state: State | None = None


def judged(state: State, candidate: Candidate, criteria: Criteria, budget: Budget = BUDGET) -> dict:
    """Fit one candidate beside the present model and score it against the present state: all but the candidate of a ScoredCandidate.

    Plain data, because it may come from another process.
    """
    try:
        problem, solution = fitted(candidate, state.problem, state.solution, state.left_at(candidate.at), budget)
    except NoValue:
        whole = float(np.sqrt(state.errors.total / state.power))
        hopeless = CandidateScore(
            candidate.effect, candidate.at, candidate.kind, 0.0, 0.0, whole, whole, False, no_value(candidate.effect)
        )
        return {"score": hopeless, "errors": state.errors, "freedom": freedom(candidate.plant)}
    errors = held_out(problem, solution, state.solution.cost, LOST)
    errors, cost = beside((state.problem, state.solution), problem, solution, errors)
    return {
        "score": _scored(state, candidate, errors, cost, criteria),
        "errors": errors,
        "freedom": freedom(candidate.plant),
        "theta": problem.free_start(solution),
        "shows": smallest(candidate.key, candidate.kind != ADDITION, problem, solution, state.absorbed, criteria.share),
    }


def freedom(plant: Plant) -> int:
    """Return the free parameters of a plant; a free virgin curve counts as the one law that it stands for."""
    return sum(1 if e.name == FREE_CURVE else sum(not p.fixed for p in e.parameters.values()) for e in plant.effects)


def refitted(state: State, j: ScoredCandidate, criteria: Criteria) -> dict:
    """Fit a candidate with everything free: what changes of its judgement, as plain data; nothing where that has no value."""
    plant = _free_of(state, j).plant
    try:
        after = at_own_starts(freely(plant, state.inverses, j.theta, state), state)
    except NoValue:
        return {}
    score, errors = scored_as(state, j.candidate, after, criteria)
    starts = tuple(p.motion.record.found for p in after.inverses)
    return {"score": score, "errors": errors, "fit": (after.solution.theta, after.solution.c, starts)}


def refit_of(state: State, j: ScoredCandidate, theta: np.ndarray, c: np.ndarray, starts: Starts) -> Refitted:
    """Return a candidate's fit with everything free, on the records as they begin with it."""
    return Refitted(Problem(_free_of(state, j).plant, begun_at(state.inverses, starts)), theta, c)


def everything_free(state: State, j: ScoredCandidate, criteria: Criteria) -> ScoredCandidate:
    """Return a judgement fitted with everything free, as it is where that has no value."""
    more = refitted(state, j, criteria)
    return replace(j, refitted=refit_of(state, j, *more.pop("fit")), **more) if more else j


def refitted_as(state: State, j: ScoredCandidate, criteria: Criteria) -> ScoredCandidate:
    """Return a judgement fitted with everything free, with the state that it ended in; as it is where that has no value."""
    fitted = everything_free(state, j, criteria)
    return fitted if fitted is j else replace(fitted, state=fitted.refitted.state)


def _free_of(state: State, j: ScoredCandidate) -> Problem:
    """Return the problem of a candidate beside the present model with everything free."""
    return problem_with(j.candidate, state.problem, state.solution).free


def _scored(state: State, candidate: Candidate, errors: HeldOut, cost: float, criteria: Criteria) -> CandidateScore:
    """Return the score of a candidate, by its held-out errors against those of the present state."""
    g, scatter = gain(state.errors, errors)
    return CandidateScore(
        candidate.effect, candidate.at, candidate.kind, g, scatter,
        float(np.sqrt(errors.total / state.power)), float(np.sqrt(cost / state.power)),
        g > criteria.share and g > criteria.certain * scatter,
        gained(candidate.effect, candidate.kind != ADDITION, g, scatter),
    )  # fmt: skip


def scored_as(state: State, candidate: Candidate, after: State, criteria: Criteria) -> tuple[CandidateScore, HeldOut]:
    """Return the score of a candidate that ended in a state of its own, and its held-out errors, beside the present state."""
    errors, cost = beside((state.problem, state.solution), after.problem, after.solution, after.errors)
    return _scored(state, candidate, errors, cost, criteria), errors


def still_earns(present: ScoredCandidate, reduced: State, last: State, criteria: Criteria) -> bool:
    """Whether an addition earns its place by the state that has it. Asked again without it, its fit may begin where the others made up for
    it (a wave in an angle with a zero of its own), and come to nothing."""
    return scored_as(reduced, present.candidate, last, criteria)[0].earns


def ahead(judgements: Sequence[ScoredCandidate], count: int) -> Sequence[ScoredCandidate]:
    """Return the first of these judgements among which `count` are of laws that are offered whole: a bumper of which no spring is declared is
    asked beside them and takes no other's place, or what explains as much and is simpler would not be asked."""
    whole = [i for i, j in enumerate(judgements) if not j.candidate.bare][:count]
    return judgements[: whole[-1] + 1 if len(whole) == count else len(judgements)]


def lighter(judgements: Sequence[ScoredCandidate], chosen: ScoredCandidate | None) -> list[ScoredCandidate]:
    """Return judgements without the state of one that leads and was not chosen: it is hundreds of megabytes."""
    return [j if j is chosen or j.state is None else replace(j, state=None) for j in judgements]


def shown(judgements: Sequence[ScoredCandidate]) -> tuple[Smallest, ...]:
    """Return the smallest effect of each kind that a step could have shown, by name and place; a law that bears another's name is not one more."""
    found = [j.shows for j in judgements if j.shows is not None and not j.candidate.plant[j.candidate.key].nearest]
    return tuple(sorted(found, key=lambda s: (s.effect, s.at, s.change)))
