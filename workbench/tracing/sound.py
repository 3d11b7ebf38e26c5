"""What leads with values that no machine has, on whole records, gives way to a plausible effect that takes nearly as much of them; and so
does what leaves a drive on validation that is farther from the measured one than none at all.

The search holds effects against each other on decimated records, with everything else at what it was there. A law with enough shape
comes to values within their interval there, and to their end on whole records: creep whose slow part is the spring of a pendulum's weight
and whose fast part is the lag of its drive. And a spring that copies the lag of a fast cycle's friction, beside a preload, goes astray on a slow
one, where the preload alone does not.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isfinite

from workbench.identification.result import Fit
from workbench.record import ROLES, VALIDATION
from workbench.tracing.choice import Choice
from workbench.tracing.criteria import Criteria
from workbench.tracing.evidence import Weighed
from workbench.tracing.judge import ScoredCandidate, refitted_as


def soundly(choice: Choice) -> Choice:
    """Return the choice with a plausible effect in the place of the addition that takes most, where that has values that no machine has or
    goes astray on validation.

    A free form keeps its place: a point of a curve may stand on its bound (a drive that gives no more). What stands in another's place
    takes `near` of what that takes, in either role, and has itself values that a machine may have, and does not go astray; of several the
    one that leaves least on validation. The choice itself where there is none.
    """
    if choice.largest is None:
        return choice
    j, w = choice.largest
    if _sound(w) or j.candidate.stands:
        return choice
    choice.progress(f"asking for another effect than {j.candidate.key}, which no machine has or validation refutes")
    i, best = choice.confirmed.added.index(j), None
    for k in _others(choice, j):
        kept, fits = choice.fitted_with(k, j)
        if k not in kept or not _nearly(fits[i : i + 2], choice.confirmed.fits[i : i + 2], choice.criteria):
            continue
        found = choice.taking(k, kept, fits)
        if _sound(found.confirmed.weighed[i]) and (best is None or _left(found) < _left(best)):
            best = found
    return replace(best, confirmed=replace(best.confirmed, given_up=(w,))) if best else choice


def _sound(w: Weighed) -> bool:
    return not (w.implausible or w.after[VALIDATION] >= 1.0)  # NaN, without such a record, is not


def _left(choice: Choice) -> float:
    """Return the error by which choices are held against each other: on validation, where there is such a record."""
    last = choice.confirmed.fits[-1]
    return last.validation if isfinite(last.validation) else last.identification


def _others(choice: Choice, j: ScoredCandidate) -> Iterator[ScoredCandidate]:
    """Yield what else takes `near` of what an addition does on blocks that were not seen, fitted with everything free beside all else
    that was added."""
    state = choice.less(j)
    if state is None:
        return
    asked = choice.judged(state, choice.offer)
    others = [k for k in asked if k.candidate.effect != j.candidate.effect and k.score.earns]
    # a law that stands in a declared one's place is not asked again: then what the best of the others takes is the measure
    taken = [k.score.gain for k in asked if k.candidate.key == j.candidate.key] or [k.score.gain for k in others]
    for k in (k for k in others if k.score.gain >= choice.criteria.near * max(taken)):
        fitted = k if k.state else refitted_as(state, k, choice.criteria)
        if fitted.state:
            yield fitted


def _nearly(fits: Sequence[Fit], others: Sequence[Fit], criteria: Criteria) -> bool:
    """Whether from one fit to the next `near` of the power goes that goes between two others, in each role that there is."""

    def taken(two, role: str) -> float:
        return getattr(two[0], role) ** 2 - getattr(two[1], role) ** 2

    # where there is no validation record both are NaN, and say nothing
    return not any(taken(fits, r) < criteria.near * taken(others, r) for r in ROLES)
