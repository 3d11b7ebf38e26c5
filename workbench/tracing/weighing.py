"""What was added, weighed on whole records: its sizes, whether its values may be a machine's, whether a nearer law says it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

from workbench.definition import TWO_COUNTS
from workbench.identification.by_record import held
from workbench.identification.fit import identify
from workbench.identification.result import Fit
from workbench.inverse.carrying import load_errors
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import TWO_MASS, Plant
from workbench.record import ROLES, VALIDATION
from workbench.residual.noise_floor import fitted, noise_rms, refuted
from workbench.tracing.criteria import Criteria
from workbench.tracing.evidence import ADDITION, CORRECTION, FORMULA, FREE, Weighed
from workbench.tracing.full_rate import nested_fits
from workbench.tracing.judge import ScoredCandidate, freedom
from workbench.tracing.near_law import NAME, gives_way
from workbench.tracing.outside import multiplier
from workbench.tracing.plausible import implausible
from workbench.tracing.power_up import calibrate, periodic
from workbench.tracing.preparing import Declared
from workbench.tracing.reducing import by_values
from workbench.tracing.result import Refinement
from workbench.tracing.selection import Selection, size
from workbench.tracing.smooth_turn import turns
from workbench.tracing.state import State
from workbench.tracing.wording_search import nearly_right


@dataclass(frozen=True, eq=False)
class Confirmed:
    """added: what whole records bear out. fits: of the declared plant and with one more of these each. levels: record -> rms
    that noise and counts alone would leave. weighed: what whole records say of each addition. given_up: what led, and gave way to one of
    these."""

    added: Sequence[ScoredCandidate]
    fits: Sequence[Fit]
    levels: Mapping[str, float]
    weighed: tuple[Weighed, ...]
    given_up: tuple[Weighed, ...] = ()


def confirm(
    late: Declared,
    order: Sequence[ScoredCandidate],
    selected: Selection,
    criteria: Criteria,
    levels: Mapping[str, float] | None = None,
) -> Confirmed:
    """Return what whole records bear out of additions, asked in this order, and weighed: by what they come to beside each other. levels: as
    found before."""
    seen = selected.answer.last.inverses
    added, fits = nested_fits(late, order, selected.found, seen)
    stay = as_they_end(added, fits[-1].plant, selected.answer.last, criteria)
    if len(stay) < len(added):
        stay, fits = nested_fits(late, stay, selected.found, seen)
    added = stay
    found = weighed(selected, added, fits, late.inverses, criteria)
    return Confirmed(added, fits, noise_rms(late.inverses, fits[-1].plant) if levels is None else levels, found)


def as_they_end(
    added: Sequence[ScoredCandidate], found: Plant, state: State, criteria: Criteria
) -> list[ScoredCandidate]:
    """Return additions but for those that are nothing at all by the values that they have in `found`, beside all others (a delay of no time beside a lag), and
    spellings under the name of the law that they then are (a cable that hangs slack to one side is a bumper). A length that is short beside a
    count is another law's doing (a gap's, beside the one that bends its flanks): that is no value of nothing."""
    stay = []
    for j in added:
        effect = next((e for e in found.effects if e.key == j.candidate.key and j.candidate.kind == ADDITION), None)
        name = by_values(effect, state, criteria) if effect else None
        if name and effect.nearest and not effect.traced and not j.candidate.stands:
            j = replace(j, candidate=replace(j.candidate, part=name))
        if name != "" or TWO_COUNTS in (neutral for neutral, _ in effect.reduces.values()):
            stay.append(j)
    return stay


def weighed(
    selected: Selection,
    added: Sequence[ScoredCandidate],
    fits: Sequence[Fit],
    inverses: Sequence[InverseDynamics],
    criteria: Criteria,
) -> tuple[Weighed, ...]:
    """Return each addition with what whole records say of it. fits: of the declared plant and with one more of these each."""
    declared, last = fits[0].plant, fits[-1].plant
    load = [load_errors(inverses, f.plant) if declared.kind == TWO_MASS else {} for f in fits]
    found = []
    for i, j in enumerate(added):
        key = j.candidate.key
        present = key in {e.key for e in last.effects}
        before, after = ({r: getattr(fits[k], r) for r in ROLES} for k in (i, i + 1))
        own = gives_way(j.candidate, declared) or (present and turns(last[key], declared, inverses))
        w = Weighed(
            effect=j.candidate.name,
            at=j.score.at,
            kind=j.candidate.kind,
            before=before,
            after=after,
            changed=_change(declared, fits[-1], key) if j.candidate.kind == CORRECTION and present else 0.0,
            tolerance=criteria.tolerance,
            law=FREE if j.candidate.stands else FORMULA,
            of_declared=own,
            implausible=implausible(last[key], last, declared, selected.declared.inverses) if present else "",
            load_before=load[i],
            load_after=load[i + 1],
            beside_others=_beside_others(j, selected) if j.candidate.kind == CORRECTION and j is not added[-1] else inf,
            **_outside(fits[i].plant, fits[i + 1].plant, selected.declared.inverses),
        )
        found.append(_phased(w, fits[i + 1], key, inverses) if present else w)
    return tuple(found)


def _beside_others(j: ScoredCandidate, selected: Selection) -> float:
    """Return what a correction takes beside all that was added, on held-out blocks, over the drive's rms, of what its value within the tolerance
    leaves; infinite where that has no value. What came first took for itself what was not there yet: of a drive that saturates a mass is
    wrong, too."""
    less = selected.less(j)
    return inf if less is None else size(less, selected.answer.last)


def _outside(before: Plant, after: Plant, inverses: Sequence[InverseDynamics]) -> dict[str, float]:
    """Return what the instruments say of what `after` has more."""
    m, error = multiplier(before, after, inverses)
    return {"outside": m, "outside_error": error}


def _phased(w: Weighed, fit: Fit, key: str, inverses: Sequence[InverseDynamics]) -> Weighed:
    """Return a wave that makes validation worse with the error that its own phase there leaves, if that is another one.

    A motor's ripple has the phase of the power-up in which its encoder was zeroed; it is no less there in another.
    """
    effect = fit.plant[key]
    if w.share(VALIDATION) >= 0.0 or not periodic(effect):
        return w
    found = calibrate(fit.plant, key, inverses, fit.validation)
    if not (found.differs and found.same and found.calibrated < w.before[VALIDATION]):
        return w
    return replace(w, after={**w.after, VALIDATION: found.calibrated}, power_up=True)


def _change(declared: Plant, fit: Fit, key: str) -> float:
    """Return by how much a fixed value is off for certain: the largest relative distance from it to its new 95 % interval.

    Of one that was declared as zero, 1.
    """
    found = {(e.effect, e.at, e.parameter): e for e in fit.estimates}
    effect = declared[key]
    changes = [0.0]
    for n, p in held(effect).items():
        new = found.get((effect.named, effect.at, n))
        if new is None:
            continue
        off = max(new.low - p.value, p.value - new.high, 0.0) if new.low <= new.high else abs(new.value - p.value)
        changes.append(off / abs(p.value) if p.value != 0.0 else float(off > 0.0))
    return max(changes)


def curve_of(selected: Selection, before: Fit, after: Fit) -> list[Refinement]:
    """Return the refinements that the free virgin curves of the final fit are."""
    if before is after:
        return []
    return [
        Refinement(
            effect=law.declared.named,
            at=law.declared.at,
            kind="law",
            sentence=nearly_right(law.declared.named, law.declared.at, before.identification, after.identification),
            parameters=tuple(e for e in after.estimates if (e.effect, e.at) == (NAME, law.declared.at)),
            size=max(before.identification**2 - after.identification**2, 0.0) ** 0.5,
        )
        for law in selected.refined
    ]


def refuted_by(floor: Mapping[str, float], fit: Fit, inverses: Sequence[InverseDynamics]) -> dict[str, float]:
    """Return role -> nrmse of a noise floor that is no higher than what a fit leaves of what it was not fitted to (`noise_floor.refuted`)."""
    return refuted(floor, {r: getattr(fit, r) for r in ROLES}, fitted(freedom(fit.plant), inverses))


def with_curves(fit: Fit, selected: Selection, inverses: Sequence[InverseDynamics]) -> Fit:
    """Return the fit with the free virgin curves of declared laws that are only nearly right; `fit` where that is no better."""
    if not selected.refined:
        return fit
    plant = fit.plant
    for law in selected.refined:
        if law.declared.key in {e.key for e in plant.effects}:
            plant = plant.without(law.declared.key) + selected.answer.last.plant[law.key]
    better = identify(plant, inverses)
    return better if better.identification < fit.identification and better.validation < fit.validation else fit
