"""What leads with values that no machine has, on whole records, gives way to a plausible effect that takes nearly as much of them.

The search holds effects against each other on decimated records, with everything else at what it was there. A law with enough shape
comes to values within their interval there, and to their end on whole records: creep whose slow part is the spring of a pendulum's weight
and whose fast part is the lag of its drive.
"""

from collections.abc import Iterator, Sequence
from math import isfinite

from workbench.identification.result import Fit
from workbench.record import IDENTIFICATION, ROLES
from workbench.tracing.candidates import ADDITION, Offer
from workbench.tracing.criteria import Criteria
from workbench.tracing.full_rate import nested_fits
from workbench.tracing.judge import Progress, ScoredCandidate, refitted_as
from workbench.tracing.near_law import as_declared
from workbench.tracing.otherwise import exchanged, lessened
from workbench.tracing.preparing import Declared
from workbench.tracing.ranking import step
from workbench.tracing.selection import Selection
from workbench.tracing.weighing import Confirmed


def soundly(
    selected: Selection,
    confirmed: Confirmed,
    late: Declared,
    offer: Offer,
    criteria: Criteria,
    progress: Progress,
) -> tuple[Selection, Confirmed]:
    """Return both with a plausible effect in the place of the addition that takes most, where that has values that no machine has.

    A free form keeps its place: a point of a curve may stand on its bound (a drive that gives no more). What stands in another's place
    takes `near` of what that takes, in either role, and has itself values that a machine may have; of several the one that leaves
    least on validation. Both are returned as they are where there is none.
    """
    if not confirmed.added:
        return selected, confirmed
    i, w = max(enumerate(confirmed.weighed), key=lambda x: x[1].size(IDENTIFICATION))
    j = confirmed.added[i]
    if not w.implausible or j.candidate.kind != ADDITION or j.candidate.stands:
        return selected, confirmed
    progress(f"asking for another effect than {j.candidate.key}, whose values no machine has")
    best = selected, confirmed
    for k in _others(selected, j, offer, criteria, progress):
        added = [*confirmed.added[:i], k, *confirmed.added[i + 1 :]]
        kept, fits = nested_fits(late, added, as_declared(k.state.plant, selected.laws))
        if k not in kept or not _nearly(fits[i : i + 2], confirmed.fits[i : i + 2], criteria):
            continue
        found = exchanged(selected, confirmed, k, kept, fits, late, criteria)
        first = best[1] is confirmed
        if not found[1].weighed[i].implausible and (first or _judged(fits) < _judged(best[1].fits)):
            best = found
    return best


def _judged(fits: Sequence[Fit]) -> float:
    """Return the error by which fits are held against each other: on validation, where there is such a record."""
    last = fits[-1]
    return last.validation if isfinite(last.validation) else last.identification


def _others(
    selected: Selection, j: ScoredCandidate, offer: Offer, criteria: Criteria, progress: Progress
) -> Iterator[ScoredCandidate]:
    """Yield what else takes `near` of what an addition does on blocks that were not seen, fitted with everything free beside all else
    that was added."""
    state = lessened(selected, j)
    if state is None:
        return
    asked = step(state, progress, offer, criteria)
    least = criteria.near * max((k.score.gain for k in asked if k.candidate.key == j.candidate.key), default=0.0)
    for k in asked:
        if k.candidate.effect == j.candidate.effect or not k.score.earns or k.score.gain < least:
            continue
        fitted = k if k.state else refitted_as(state, k, criteria)
        if fitted.state:
            yield fitted


def _nearly(fits: Sequence[Fit], others: Sequence[Fit], criteria: Criteria) -> bool:
    """Whether from one fit to the next `near` of the power goes that goes between two others, in each role that there is."""

    def taken(two, role: str) -> float:
        return getattr(two[0], role) ** 2 - getattr(two[1], role) ** 2

    # where there is no validation record both are NaN, and say nothing
    return not any(taken(fits, r) < criteria.near * taken(others, r) for r in ROLES)
