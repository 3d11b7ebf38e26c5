"""The trace: select effects, prune them, confirm them on whole records, weigh the evidence, decide, describe."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from workbench.definition import Effect
from workbench.errors import WorkbenchError
from workbench.finding import Finding
from workbench.identification.carrying import idle
from workbench.identification.fit import fitted_on, identify
from workbench.identification.passes import Passes
from workbench.identification.result import Estimate, Fit
from workbench.identification.solve import NoValue
from workbench.keeping import kept
from workbench.plant import TWO_MASS, Plant
from workbench.threads import one_thread
from workbench.tracing.calibration import withheld
from workbench.tracing.candidates import Offer
from workbench.tracing.criteria import Criteria
from workbench.tracing.decide import CAUSE, NOT_BORNE_OUT, NOTHING, REFINEMENT, UNKNOWN, Verdict, decide
from workbench.tracing.evidence import CORRECTION, Evidence, Weighed
from workbench.tracing.explainable import explainable
from workbench.tracing.floor import floor as noise_floor
from workbench.tracing.floor import levels
from workbench.tracing.judge import STANDARD, Judgement, Progress, shown
from workbench.tracing.near_law import as_declared
from workbench.tracing.result import Candidate, Cause, Trace
from workbench.tracing.rivals import experiment, rivals
from workbench.tracing.selection import Answer, Selection, select
from workbench.tracing.skew import Skew, skew_of
from workbench.tracing.smallest import named
from workbench.tracing.state import State
from workbench.tracing.thin import thin
from workbench.tracing.unexplained import Unexplained, described, instead, unexplained
from workbench.tracing.verdict import cause, clock, findings_of, refinement, verdict_sentence
from workbench.tracing.weighing import curve_of, weighed
from workbench.tracing.whole import in_turn


@dataclass(frozen=True, eq=False)
class Confirmed:
    """added: what whole records bear out. fits: of the declared plant and with one more of these each. levels: record -> rms
    that noise and counts alone would leave."""

    added: Sequence[Judgement]
    fits: Sequence[Fit]
    levels: Mapping[str, float]


@one_thread
@kept
def trace(
    plant: Plant | Fit,
    passes: Sequence[Passes],
    progress: Progress = lambda _: None,
    most: int | None = None,
    only: Collection[str] | None = None,
    own: Collection[Effect] = (),
    criteria: Criteria = STANDARD,
) -> Trace:
    """Trace the residual of `plant` on the identification records among `passes`.

    plant: as declared, or a fit of it. most: effects added at most, as the criteria say where absent. only: names of the effects
    that are judged, all where absent. own: effects that are judged beside those of the catalogue. criteria: what decides. Returns the verdict with its evidence. Validation records choose no effect; they decide whether what
    was found is borne out.
    """
    plant = plant.plant if isinstance(plant, Fit) else plant
    whole = fitted_on(passes)
    criteria = criteria if most is None else replace(criteria, steps=most)
    progress("fitting the declared model")
    try:
        late = late_encoder(plant, passes, only)
        declared = State(late.plant, thin(whole))
    except NoValue:
        raise WorkbenchError(
            "the declared model has no value on these records: a shape parameter lies far from them; check it and its unit."
        ) from None
    offer = Offer(() if late.idle else only, own, [e.key for e in plant.effects])
    selected = select(declared, whole, offer, criteria, progress)
    progress("fitting the extended model")
    found = as_declared(selected.answer.last.plant, selected.laws)
    added, fits = in_turn(late.plant, selected.answer.added, found, passes)
    confirmed = Confirmed(added, fits, levels(passes, fits[-1].plant))
    progress("weighing the evidence")
    evidence, place = evidence_of(selected, confirmed, passes, criteria)
    evidence = replace(evidence, clock=late.skew is not None, idle=late.idle is not None)
    verdict = decide(evidence, criteria)
    refused: list[Weighed] = []
    while verdict.verdict == CAUSE and (kept := standing(confirmed, verdict)) is not confirmed.added:
        # without what is not borne out, the others are weighed again: one may have been needed by it alone
        refused += [a for a, r in zip(evidence.added, verdict.roles, strict=True) if r == NOT_BORNE_OUT]
        added, fits = in_turn(late.plant, kept, found, passes)
        confirmed = Confirmed(added, fits, confirmed.levels)
        evidence = replace(evidence, added=weighed(selected, added, fits, passes, criteria))
        verdict = decide(evidence, criteria)
    evidence = replace(evidence, refused=tuple(refused))
    return reported(late, passes, selected, confirmed, evidence, verdict, place, criteria, progress)


def standing(confirmed: Confirmed, verdict: Verdict) -> Sequence[Judgement]:
    """Return what of the additions stays in the extended model; the same object where all of it does."""
    roles = dict(zip((j.suspect.key for j in confirmed.added), verdict.roles, strict=True))
    kept = [j for j in confirmed.added if roles[j.suspect.key] == CAUSE or stays(j, roles)]
    return kept if len(kept) < len(confirmed.added) else confirmed.added


@dataclass(frozen=True, eq=False)
class Declared:
    """declared: the plant as declared. plant: with the clock that the angle between two encoders says is late, held. before:
    the fit of the declared plant, where there is such a clock. idle: a finding that the fit lets the joint carry nothing."""

    declared: Plant
    plant: Plant
    skew: Skew | None = None
    before: Fit | None = None
    idle: Finding | None = None


def late_encoder(plant: Plant, passes: Sequence[Passes], only: Collection[str] | None) -> Declared:
    """Ask the angle between two encoders before anything in torque, and whether the joint then carries anything."""
    if plant.kind != TWO_MASS:
        return Declared(plant, plant)
    skew = skew_of(thin(fitted_on(passes)), plant) if only is None or "clock_skew" in only else None
    here = skew.suspect.plant if skew else plant
    before = identify(plant, passes) if skew else None
    return Declared(plant, here, skew, before, idle(passes, identify(here, passes).plant))


def evidence_of(
    selected: Selection, confirmed: Confirmed, passes: Sequence[Passes], criteria: Criteria
) -> tuple[Evidence, Unexplained | None]:
    """Return the numbers that decide, and the place that says more than what was added does, if there is one."""
    answer, base = selected.answer, selected.base
    calm = max(answer.last.steady, min(confirmed.levels.values(), default=0.0))
    even = {p.motion.record.name: calm for p in passes}
    place = instead(base, answer.last, even) if confirmed.added else None
    before = explainable(base, criteria)
    after = explainable(answer.last, criteria) if answer.added else before
    first = confirmed.fits[0]
    steady = {name: min(x, max(base.steady, 1e-300)) for name, x in confirmed.levels.items()}
    evidence = Evidence(
        declared={"identification": first.identification, "validation": first.validation},
        floor=noise_floor(passes, steady),
        before=before,
        after=after,
        added=weighed(selected, confirmed.added, confirmed.fits, passes, criteria),
        place_instead=place is not None,
    )
    return evidence, Unexplained(place, base.solution.cost**0.5) if place else None


def reported(
    late: Declared,
    passes: Sequence[Passes],
    selected: Selection,
    confirmed: Confirmed,
    evidence: Evidence,
    verdict: Verdict,
    place: Unexplained | None,
    criteria: Criteria,
    progress: Progress,
) -> Trace:
    """Return what a decision comes to: causes, refinements, the final fit, and the sentences."""
    plant, added = late.plant, confirmed.added
    roles = dict(zip((j.suspect.key for j in added), verdict.roles, strict=True))
    # with a cause all that was added stands; without one nothing of it does
    kept, fits = (added, list(confirmed.fits)) if verdict.verdict == CAUSE else ([], list(confirmed.fits[:1]))
    after = refined(fits[-1], selected, passes, criteria) if selected.refined else fits[-1]
    known = {j.suspect.key: i for i, j in enumerate(added)}
    causes = [clock(late.skew, late.before, fits[0])] if late.skew else []
    refinements = []
    for i, j in enumerate(kept):
        made = cause(j, evidence.added[known[j.suspect.key]], fits[i], fits[i + 1], after, plant, credited=j.suspect.key in selected.credited)  # fmt: skip
        if roles[j.suspect.key] == CAUSE:
            causes.append(described_rivals(made, j, selected, plant, passes, confirmed, criteria, progress))
        else:
            refinements.append(refinement(made))
    refinements += curve_of(selected, fits[-1], after)
    progress("looking for where the residual lives")
    lives = None
    if verdict.verdict == UNKNOWN:
        calm = {p.motion.record.name: max(selected.declared.steady, 1e-300) for p in passes}
        lives = place or unexplained(selected.declared, calm)
    after = withheld(after, causes, passes)
    if late.skew:
        after = replace(after, estimates=with_clock(after.estimates, late.skew))
    before = late.before or fits[0]
    sentence = verdict_sentence(verdict.verdict, causes, before, after, evidence, lives)
    shows = shown(selected.steps[0].judgements)
    return Trace(
        verdict.verdict, sentence + (named(shows) if verdict.verdict == NOTHING else ""),
        ranked(
            [*([candidate_of(late.skew, fits[0])] if late.skew else []), *(named_as(j) for j in kept if roles[j.suspect.key] == CAUSE)],
            [named_as(j) for j in selected.steps[0].judgements],
        ),
        tuple(tuple(j.candidate for j in s.judgements) for s in selected.steps), tuple(causes), before, after, evidence.floor,
        (*([late.idle] if late.idle else []), *findings_of(verdict, evidence, causes, plant)), described(lives, evidence), shows,
        refinements=tuple(refinements), evidence=evidence, criteria=criteria,
    )  # fmt: skip


def named_as(j: Judgement) -> Candidate:
    """Return a candidate under the name that it bears: of a free form that of its class' nearest formula."""
    return replace(j.candidate, effect=j.suspect.name)


def candidate_of(skew: Skew, fit: Fit) -> Candidate:
    """Return the late clock as the first of the candidates: what the angle says of it is its gain."""
    s = skew.late.measured
    return Candidate(skew.suspect.effect, skew.suspect.at, skew.suspect.kind, s.share, 0.0, fit.identification, fit.identification, True, skew.sentence)  # fmt: skip


def with_clock(estimates: Sequence[Estimate], skew: Skew) -> tuple[Estimate, ...]:
    """Return estimates with the clock's as the angle gives them."""
    key = (skew.suspect.effect, skew.suspect.at)
    return (*(e for e in estimates if (e.effect, e.at) != key), *skew.parameters)


def stays(j: Judgement, roles: Mapping[str, str]) -> bool:
    """Whether a refinement stays in the extended model: a fixed value that is right within its tolerance does not move."""
    return roles[j.suspect.key] == REFINEMENT and j.suspect.kind != CORRECTION


def described_rivals(
    made: Cause,
    j: Judgement,
    selected: Selection,
    plant: Plant,
    passes: Sequence[Passes],
    confirmed: Confirmed,
    criteria: Criteria,
    progress: Progress,
) -> Cause:
    """Return a cause with the candidates that these records cannot tell from it, and the motion that would."""
    answer: Answer = selected.answer
    others = rivals(j, answer.added, selected.looked, criteria, answer.last.power)
    progress("looking for the motion that would tell rivals apart")
    level = min(confirmed.levels.values())
    apart = experiment(answer.last.plant, plant, j, others[0], fitted_on(passes), level) if others else ""
    return replace(made, rivals=tuple(o.candidate.effect for o in others), experiment=apart)


def refined(fit: Fit, selected: Selection, passes: Sequence[Passes], criteria: Criteria) -> Fit:
    """Return the fit with the free virgin curves of declared laws that are only nearly right; `fit` where that is no better."""
    plant = fit.plant
    for law in selected.refined:
        if law.declared.key in {e.key for e in plant.effects}:
            plant = plant.without(law.declared.key) + selected.answer.last.plant[law.key]
    better = identify(plant, passes)
    return better if better.identification < fit.identification and better.validation < fit.validation else fit


def ranked(added: Sequence[Candidate], first: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Return the candidates of the first step as they were judged there, the causes ahead of the others."""
    judged = {(c.effect, c.at): c for c in first}
    ahead = {(c.effect, c.at): judged.get((c.effect, c.at), c) for c in added}
    return (*ahead.values(), *(c for key, c in judged.items() if key not in ahead))
