"""What a trace says: causes, refinements, the final fit and the sentences of a decision that was taken."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from workbench.definition import catalogue
from workbench.finding import Finding
from workbench.identification.result import Estimate, Fit
from workbench.inverse.dynamics import InverseDynamics
from workbench.record import VALIDATION
from workbench.tracing.calibration import Calibration
from workbench.tracing.candidates import ADDITION, Candidate, missing_part, without
from workbench.tracing.criteria import Criteria
from workbench.tracing.decide import CAUSE, NOTHING, REFINEMENT, UNKNOWN, Verdict
from workbench.tracing.discs import SEATED, count_of, of_the_gear, on_the_shaft
from workbench.tracing.evidence import Evidence, Weighed
from workbench.tracing.full_rate import settled
from workbench.tracing.headline import verdict_sentence
from workbench.tracing.judge import Progress, ScoredCandidate, shown
from workbench.tracing.power_up import calibrations, withheld
from workbench.tracing.preparing import Declared
from workbench.tracing.result import CandidateScore, Cause, Refinement, Trace
from workbench.tracing.rivals import experiment, rivals
from workbench.tracing.selection import Selection
from workbench.tracing.skew import Skew, clock
from workbench.tracing.state import State
from workbench.tracing.unexplained import Unexplained, described, unexplained
from workbench.tracing.weighing import Confirmed, curve_of, refuted_by, with_curves
from workbench.tracing.wording import belongs_to_one_power_up, cause, findings_of, gave_way, least_shown, refinement


@dataclass(frozen=True, eq=False)
class Outcome:
    """What a trace came to. place: that says more of the residual than what was added does, if there is one. after: the final fit, where it is
    known. values: key of an effect -> its data-sheet value that would fit otherwise, and stays as declared."""

    late: Declared
    inverses: Sequence[InverseDynamics]
    selected: Selection
    confirmed: Confirmed
    evidence: Evidence
    verdict: Verdict
    place: Unexplained | None
    criteria: Criteria
    after: Fit | None = None
    values: Mapping[str, Refinement] = field(default_factory=dict)

    def role(self, j: ScoredCandidate) -> str:
        """What the decision makes of an addition."""
        return dict(zip((k.candidate.key for k in self.confirmed.added), self.verdict.roles, strict=True))[
            j.candidate.key
        ]

    @property
    def standing(self) -> list[tuple[ScoredCandidate, Weighed]]:
        """What was added, with its evidence: with a cause all of it stands; where nothing is missing refinements do that take what is of
        practical size of the validation records, of the drive or behind the joint, and else nothing does."""
        every = list(zip(self.confirmed.added, self.confirmed.weighed, strict=True))
        refines = self.verdict.verdict == NOTHING and {*self.verdict.roles} == {REFINEMENT}
        first, last = self.confirmed.fits[0].validation, self.confirmed.fits[-1].validation
        small = self.criteria.practical
        less = refines and (
            first**2 - last**2 >= small**2 or any(w.behind and w.size(VALIDATION) >= small for _, w in every)
        )
        return every if self.verdict.verdict == CAUSE or less else []

    @property
    def fits(self) -> list[Fit]:
        """Of the declared plant, and with one more of what stands each."""
        return list(self.confirmed.fits[: 1 + len(self.standing)])

    @property
    def by_size(self) -> list[ScoredCandidate]:
        """The causes, the one that takes most of the identification records first, in the order of the verdict."""
        found = [(j, w) for j, w in self.standing if self.role(j) == CAUSE]
        return [j for j, w in sorted(found, key=lambda x: x[1].order(self.criteria.practical), reverse=True)]


def reported(o: Outcome, progress: Progress) -> Trace:
    """Return what a decision comes to: causes, refinements, the final fit, and the sentences."""
    late, selected = o.late, o.selected
    after = o.after or with_curves(o.fits[-1], selected, o.inverses)
    # a free curve may leave less than the additions did by which the floor was told
    evidence = replace(o.evidence, floor=refuted_by(o.evidence.floor, after, o.inverses))
    o = replace(o, evidence=evidence)
    causes, refinements = _said_of_each(o, after, progress)
    refinements += curve_of(selected, o.fits[-1], after)
    refinements += late.turn.refinements(o.fits[0]) if late.turn else []
    stays = o.values.keys() - {c.key for c in causes} if o.verdict.verdict != UNKNOWN else ()
    refinements += [o.values[key] for key in o.values if key in stays]
    progress("looking for where the residual lives")
    lives = _residual_place(o) if o.verdict.verdict == UNKNOWN and not late.lost else None
    first = [clock(late.skew, late.before, o.fits[0])] if late.skew else []
    after = replace(after, estimates=_with_clock(after.estimates, late.skew)) if late.skew else after
    phases = calibrations(after.plant, causes, o.inverses, o.criteria)
    after, causes = withheld(after, causes, o.inverses), [*first, *causes]
    before = late.lost.before if late.lost else late.before or o.fits[0]
    shows = shown(selected.steps[0].judgements)
    alone = _of_causes(o)
    refined = after if after.rms != alone.rms else None
    sentence = verdict_sentence(o.verdict.verdict, causes, before, alone, evidence, lives, late.lost, refined)
    sentence += late.turn.beside if late.turn else ""
    named = {j.candidate.key: j.candidate.name for j, _ in o.standing}
    return Trace(
        o.verdict.verdict,
        sentence + (least_shown(shows) if o.verdict.verdict == NOTHING else ""),
        _ranked(o),
        tuple(tuple(_of_step(j, named) for j in s.judgements) for s in selected.steps),
        tuple(causes),
        before,
        after,
        evidence.floor,
        _findings_of(o, causes, phases),
        described(lives, evidence, late.lost),
        shows,
        refinements=tuple(refinements),
        evidence=evidence,
        criteria=o.criteria,
        calibrations=phases,
    )


def _findings_of(o: Outcome, causes: Sequence[Cause], phases: Sequence[Calibration]) -> tuple[Finding, ...]:
    """Return what was found of the records before any effect was tried, what stands beside the verdict, and the calibrations."""
    late = o.late
    lost = late.lost.finding if late.lost and o.verdict.verdict != UNKNOWN else None
    first = [f for f in (late.idle, lost, late.slow and late.slow.finding, late.sticks and late.sticks.finding) if f]
    beside = findings_of(o.verdict, o.evidence, causes, late.plant, o.criteria)
    gone = map(gave_way, o.confirmed.given_up) if o.standing else ()
    return (*first, *beside, *gone, *map(belongs_to_one_power_up, phases))


def _said_of_each(o: Outcome, after: Fit, progress: Progress) -> tuple[list[Cause], list[Refinement]]:
    """Return the causes, the one that takes most first, and the refinements among what stands."""
    made = {
        j.candidate.key: cause(
            j,
            w,
            o.fits[i],
            o.fits[i + 1],
            after,
            o.late.plant,
            provisional=j.candidate.key in o.selected.provisional,
            chosen=w.chosen,
            also=_also(j.candidate, after, o),
        )
        for i, (j, w) in enumerate(o.standing)
    }
    refinements = [refinement(made[j.candidate.key]) for j, _ in o.standing if o.role(j) != CAUSE]
    return [_described_rivals(made[j.candidate.key], j, o, progress) for j in o.by_size], refinements


def _also(candidate: Candidate, after: Fit, o: Outcome) -> tuple[str, ...]:
    """Return the parts of a composite that are missing beside the one that it bears the name of: the friction that gives way, where nothing
    declared at its place has memory, and its own length is above two encoder steps for certain.

    Halved or doubled, the two steps change no answer of c, d or the measured axes: the one composite among them gives way over some 500.
    """
    here = [e for e in o.late.plant.effects if e.at == candidate.at]
    if not candidate.part or any("dir" in e.provides for e in here):
        return ()
    name = candidate.effect.partition(" ")[0]
    if missing_part(catalogue()[name], [e for e in here if e.key in candidate.instead]) != candidate.part:
        return ()  # a part is named, and the memory beside it is what declared dry friction is only nearly right in
    low = {e.parameter: e.low for e in after.estimates if (e.effect, e.at) == (candidate.effect, candidate.at)}
    least = 2.0 * max(p.motion.counts for p in o.inverses)
    giving = [e for e in (catalogue()[n] for n in catalogue()[name].parts) if "dir" in e.provides]
    return tuple(
        e.name for e in giving if any(low.get(n, 0.0) > least for n, p in e.parameters.items() if p.unit == "x")
    )


def _residual_place(o: Outcome) -> Unexplained | None:
    """Return where the residual lives that no effect explains. At rest, too: a slip or a knock need not wait for motion."""
    if o.place:
        return o.place
    declared = State(o.late.plant, o.late.decimated)
    return unexplained(declared, {p.motion.record.name: max(declared.steady, 1e-300) for p in o.inverses})


def _named_as(j: ScoredCandidate) -> CandidateScore:
    """Return a candidate under the name that it bears: of a free form that of its class' nearest formula."""
    return replace(j.score, effect=j.candidate.name)


def _of_step(j: ScoredCandidate, named: Mapping[str, str]) -> CandidateScore:
    """Return a candidate as it was judged in its step, where no free form had been asked. named: of what was added, key -> the name that it bears."""
    return replace(j.score, effect=named.get(j.candidate.key) or j.candidate.part or j.score.effect)


def _candidate_of(skew: Skew, fit: Fit) -> CandidateScore:
    """Return the late clock as the first of the candidates: what the angle says of it is its gain."""
    s = skew.late.measured
    return CandidateScore(skew.candidate.name, skew.candidate.at, skew.candidate.kind, s.share, 0.0, fit.identification, fit.identification, True, skew.sentence)  # fmt: skip


def _with_clock(estimates: Sequence[Estimate], skew: Skew) -> tuple[Estimate, ...]:
    """Return estimates with the clock's as the angle gives them."""
    key = (skew.candidate.effect, skew.candidate.at)
    return (*(e for e in estimates if (e.effect, e.at) != key), *skew.parameters)


def _described_rivals(made: Cause, j: ScoredCandidate, o: Outcome, progress: Progress) -> Cause:
    """Return a cause with the candidates that these records cannot tell from it, and the motion that would."""
    answer = o.selected.answer
    wave = answer.last.plant[j.candidate.key]
    if j.candidate.name == on_the_shaft(wave, answer.last.plant, count_of(answer.last.inverses)):
        return replace(made, rivals=of_the_gear(made.effect), experiment=SEATED)
    others = rivals(j, answer.added, o.selected.looked, o.criteria, answer.last.power)
    progress("looking for the motion that would tell rivals apart")
    level = min(o.confirmed.levels.values())
    apart = experiment(answer.last.plant, o.late.plant, j, others[0], o.late.whole, level) if others else ""
    return replace(made, rivals=tuple(k.score.effect for k in others), experiment=apart)


def _of_causes(o: Outcome) -> Fit:
    """Return the fit with the causes alone, without what is a refinement beside them; the last fit where there is none, or no cause."""
    fit = o.fits[-1]
    keys = {e.key for e in fit.plant.effects}
    every = [j.candidate for j, _ in o.standing if o.role(j) != CAUSE and j.candidate.kind == ADDITION]
    lesser = [s for s in every if s.key in keys]
    plant = fit.plant
    for candidate in lesser:
        plant = without(plant, candidate, o.selected.base.plant)
    return settled(plant, o.inverses) if lesser else fit


def _ranked(o: Outcome) -> tuple[CandidateScore, ...]:
    """Return the candidates of the first step as they were judged there, the causes ahead of the others."""
    clock = [_candidate_of(o.late.skew, o.fits[0])] if o.late.skew else []
    first = [_named_as(j) for j in o.selected.steps[0].judgements]
    judged: dict[tuple[str, str], CandidateScore] = {}
    for c in first:  # a free form stands before the formula whose name it bears: what was added is what counts
        judged.setdefault((c.effect, c.at), c)
    ahead = {(c.effect, c.at): judged.get((c.effect, c.at), c) for c in clock}
    ahead |= {(j.candidate.name, j.candidate.at): _as_first_judged(j, o, judged) for j in o.by_size}
    return (*ahead.values(), *(c for key, c in judged.items() if key not in ahead))


def _as_first_judged(
    j: ScoredCandidate, o: Outcome, judged: Mapping[tuple[str, str], CandidateScore]
) -> CandidateScore:
    """Return an addition as it was judged in the first step, under the name that it bears since; as it was added where it was not. judged: by name
    and place."""
    c, last = _named_as(j), o.selected.answer.last
    own = (k.score for k in o.selected.steps[0].judgements if k.candidate.key == j.candidate.key)
    disc = on_the_shaft(last.plant[j.candidate.key], last.plant, count_of(last.inverses))
    names = of_the_gear(c.effect) if c.effect == disc else (c.effect,)
    alike = (judged[n, c.at] for n in names if (n, c.at) in judged)
    return replace(next(iter((*own, *alike, c))), effect=c.effect)
