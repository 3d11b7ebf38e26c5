"""What validation does not carry, asked again: another law of its class that says as much, and there, too.

A formula that is only near bends within the records that were fitted, and goes astray beyond them: -v|v| stands for friction that
levels off, until an axis moves faster. A class has other laws; which one it is shows where the motion is another one.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace

from workbench.definition import catalogue
from workbench.effects.families import FREE_FORMS
from workbench.identification.result import Fit
from workbench.identification.solve import NoValue
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing.answer import Answer
from workbench.tracing.candidates import ADDITION, Offer, without
from workbench.tracing.criteria import Criteria
from workbench.tracing.evidence import Weighed
from workbench.tracing.free_forms import MEMORY, free_forms
from workbench.tracing.full_rate import nested_fits
from workbench.tracing.judge import Progress, ScoredCandidate, judged, refitted_as
from workbench.tracing.near_law import as_declared
from workbench.tracing.preparing import Declared
from workbench.tracing.ranking import step
from workbench.tracing.selection import Selection
from workbench.tracing.spellings import spellings_of
from workbench.tracing.state import State
from workbench.tracing.weighing import Confirmed, weighed


def otherwise(
    selected: Selection,
    confirmed: Confirmed,
    late: Declared,
    offer: Offer,
    criteria: Criteria,
    progress: Progress,
) -> tuple[Selection, Confirmed]:
    """Return both with another law in the place of the addition that takes most, where validation does not carry it and the other leaves
    plainly less there. Of lesser ones a free form would take what is left of the greatest.

    A law takes another one's place that leaves no more on identification (in the place of a free form it takes `near` of what that took),
    and less on validation, by what is of practical size; of several the one that leaves least there. Both are returned as they are where
    there is none.
    """
    if not confirmed.added:
        return selected, confirmed
    i, w = max(enumerate(confirmed.weighed), key=lambda x: x[1].size(IDENTIFICATION))
    j = confirmed.added[i]
    if not _doubted(w, criteria) or j.candidate.kind != ADDITION or j.candidate.instead:
        return selected, confirmed
    progress(f"asking for another law than {j.candidate.key}, which validation does not carry")
    best, now = None, confirmed.fits[-1]
    for k in _laws(selected, j, offer, criteria, progress):
        added = [*confirmed.added[:i], k, *confirmed.added[i + 1 :]]
        kept, fits = nested_fits(late, added, as_declared(k.state.plant, selected.laws))
        before = confirmed.fits[0] if j.candidate.stands and best is None else None
        if len(kept) == len(added) and _better(fits[-1], now, criteria, before):
            now, best = fits[-1], (k, kept, fits)
    if best is None:
        return selected, confirmed
    return exchanged(selected, confirmed, *best, late, criteria)


def in_place_of_two(
    selected: Selection,
    confirmed: Confirmed,
    late: Declared,
    offer: Offer,
    criteria: Criteria,
    progress: Progress,
) -> tuple[Selection, Confirmed]:
    """Return both with one law in the place of two of one class at one place, where it leaves no more than these together in either role.

    Two formulas of a class make up for a third one: friction that goes with a root of speed is one of its square, reversed, and a peak.
    It bears the name of the larger of the two.
    """
    pair = _of_one_class(confirmed)
    if pair is None:
        return selected, confirmed
    j, lesser = pair
    progress(f"asking for one law in the place of {j.candidate.key} and {lesser.candidate.key}")
    both = confirmed.fits[-1]
    for k in _laws(selected, j, offer, criteria, progress, beside=lesser):
        added = [k if a is j else a for a in confirmed.added if a is not lesser]
        kept, fits = nested_fits(late, added, as_declared(k.state.plant, selected.laws))
        small = criteria.practical**2
        if len(kept) == len(added) and all(
            getattr(fits[-1], r) ** 2 <= getattr(both, r) ** 2 + small for r in (IDENTIFICATION, VALIDATION)
        ):
            return exchanged(selected, confirmed, k, kept, fits, late, criteria)
    return selected, confirmed


def as_a_curve(
    selected: Selection,
    confirmed: Confirmed,
    late: Declared,
    offer: Offer,
    criteria: Criteria,
    progress: Progress,
) -> tuple[Selection, Confirmed]:
    """Return both with the free form of its class in the place of the addition that takes most, where it leaves less in either role, by
    `beside` of the drive.

    A formula that takes `near` of what its class can take names the cause, and may leave much of it: of a drive that saturates,
    a tenth; what comes near to that dresses it then.
    """
    if not confirmed.added or confirmed.fits[-1].identification < criteria.beside:
        return selected, confirmed
    j = max(zip(confirmed.added, confirmed.weighed, strict=True), key=lambda x: x[1].size(IDENTIFICATION))[0]
    if j.candidate.kind != ADDITION or j.candidate.instead:
        return selected, confirmed
    progress(f"asking what {j.candidate.key} leaves of its law")
    now, state = confirmed.fits[-1], lessened(selected, j)
    if state is None:
        return selected, confirmed
    for k in _fitted(state, _curves(state, j, offer, criteria), j, (), offer, criteria):
        added = [k if a is j else a for a in confirmed.added]
        kept, fits = nested_fits(late, added, as_declared(k.state.plant, selected.laws))
        left = (getattr(now, r) ** 2 - getattr(fits[-1], r) ** 2 for r in (IDENTIFICATION, VALIDATION))
        if len(kept) == len(added) and all(x >= criteria.beside**2 for x in left):
            return exchanged(selected, confirmed, k, kept, fits, late, criteria)
    return selected, confirmed


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


def exchanged(
    selected: Selection,
    confirmed: Confirmed,
    best: ScoredCandidate,
    kept: Sequence[ScoredCandidate],
    fits: Sequence[Fit],
    late: Declared,
    criteria: Criteria,
) -> tuple[Selection, Confirmed]:
    """Return both with the additions `kept`, of which `best` is new, and weighed anew. fits: of the declared plant and with one more of these each."""
    answer = Answer(kept, selected.answer.declared, best.state)
    again = weighed(selected, kept, fits, late.inverses, criteria)
    return replace(selected, answer=answer), replace(confirmed, added=kept, fits=fits, weighed=again)


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


def _laws(
    selected: Selection,
    j: ScoredCandidate,
    offer: Offer,
    criteria: Criteria,
    progress: Progress,
    beside: ScoredCandidate | None = None,
) -> list[ScoredCandidate]:
    """Return the other laws of an addition's class at its place, fitted beside all else that was added, best first. beside: another
    addition, in whose place they would be as well, when those of another spelling alone are asked."""
    state = lessened(selected, j, beside)
    if state is None:
        return []
    own = selected.answer.last.plant[j.candidate.key]
    same = [e for e in catalogue().values() if e.name != own.name and e.family == own.family]
    asked = [e for e in same if e.traced and beside is None and (offer.only is None or e.name in offer.only)]
    near = [e for e in spellings_of(j.candidate) if e.name != own.name]
    found: list[ScoredCandidate] = []
    if asked or near:
        known = {**offer.stands_for, **{law.key: law.declared for law in selected.laws}}
        offered = replace(offer, only={e.name for e in (*asked, *near)}, own=(*offer.own, *near), stands_for=known)
        found += step(state, progress, offered, criteria)
    if beside is None:
        found += _curves(state, j, offer, criteria)
    return _fitted(state, found, j, {e.name for e in asked}, offer, criteria)


def lessened(selected: Selection, j: ScoredCandidate, beside: ScoredCandidate | None = None) -> State | None:
    """Return the state without an addition, and without another one `beside` it; None where it has no value."""
    last = selected.answer.last
    plant = without(last.plant, j.candidate, selected.base.plant)
    try:
        return State(without(plant, beside.candidate, selected.base.plant) if beside else plant, last.inverses)
    except NoValue:
        return None


def _curves(state: State, j: ScoredCandidate, offer: Offer, criteria: Criteria) -> list[ScoredCandidate]:
    """Return the free form of an addition's class, judged; none where it stands for it already, or there is none."""
    family = j.candidate.family
    if family not in FREE_FORMS or family == MEMORY or j.candidate.stands:
        return []
    forms = free_forms(state.plant, state.inverses, [family], state.residuals)
    return [ScoredCandidate(f.candidate, **judged(state, f.candidate, criteria, offer.budget)) for f in forms]


def _fitted(
    state: State,
    found: Sequence[ScoredCandidate],
    j: ScoredCandidate,
    named: Collection[str],
    offer: Offer,
    criteria: Criteria,
) -> list[ScoredCandidate]:
    """Return what of judged laws earns its place where an addition is, with everything free, best first. named: as `_called` takes them."""
    here = [k for k in found if k.candidate.at == j.candidate.at and k.score.earns and k.theta is not None]
    best = sorted(here, key=lambda k: (k.errors.total, k.candidate.key))[: offer.budget.laws]
    fitted = (k if k.state else refitted_as(state, k, criteria) for k in best)
    return [_called(k, j, named) for k in fitted if k.state]


def _called(k: ScoredCandidate, j: ScoredCandidate, named: Collection[str]) -> ScoredCandidate:
    """Return a law under the name that it bears: its own, if that is one that causes have; else that of the law it is in place of."""
    if k.candidate.effect in named:
        return k
    bears = {"part": j.candidate.name} if k.candidate.plant[k.candidate.key].nearest else {"stands": j.candidate.name}
    return replace(k, candidate=replace(k.candidate, **bears))
