"""The trace: what a search adds, what a later effect made needless, what whole records bear out, what no effect explains."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from workbench.effect import Effect
from workbench.errors import WorkbenchError
from workbench.identify.fit import fitted_on, identify
from workbench.identify.passes import Passes
from workbench.identify.result import Fit
from workbench.identify.solve import NoValue
from workbench.plant import Plant
from workbench.record import IDENTIFICATION
from workbench.threads import one_thread
from workbench.trace.calibration import withheld
from workbench.trace.candidates import Offer, without
from workbench.trace.floor import floor as noise_floor
from workbench.trace.floor import levels
from workbench.trace.greedy import extended, leading
from workbench.trace.judge import Judgement, Progress, lighter, shown, step
from workbench.trace.result import CAUSE, NOTHING, UNKNOWN, Candidate, Trace
from workbench.trace.rivals import experiment, rivals
from workbench.trace.smallest import named
from workbench.trace.state import State
from workbench.trace.thin import thin
from workbench.trace.unexplained import LEFT, Unexplained, described, lower, unknown
from workbench.trace.verdict import cause, left_over, not_carried, verdict_sentence
from workbench.trace.whole import in_turn, on_whole

STEPS = 4  # effects added at most
PROMISE = 0.05  # of the residual's power, from which a candidate is asked again when others are taken out


@dataclass(frozen=True)
class Answer:
    """What is added to the declared model, and the state with all of it: that of the last addition, unless it is given."""

    added: Sequence[Judgement]
    declared: State
    revised: State | None = None

    @property
    def last(self) -> State:
        return self.revised or (self.added[-1].state if self.added else self.declared)

    @property
    def standing(self) -> "Answer":
        """The answer without effects that a later one took the place of."""
        held = {e.key for e in self.last.plant.effects}
        return replace(self, added=[j for j in self.added if j.suspect.key in held])


def revised(answer: Answer, declared: Plant, looked: list[list[Judgement]], progress: Progress, offer: Offer) -> Answer:
    """Ask of each effect but the last whether the later ones made it needless, or made another one the better answer.

    Greedy selection cannot take back a choice made while something else was missing. Each effect is taken out in turn and
    the search repeated with the others in place, among all that ever promised something; what leads then stands in its
    stead. looked: every step's judgements, to which these are added. Returns `answer` itself where every effect stands.
    """
    for i in range(len(answer.added) - 1):
        present = answer.added[i]
        progress(f"asking again for {present.suspect.key}")
        rest = [j for k, j in enumerate(answer.added) if k != i]
        try:
            reduced = State(without(answer.last.plant, present.suspect, declared), answer.last.passes)
        except NoValue:
            continue
        judgements = step(reduced, progress, replace(offer, only=promising(looked)))
        best = leading(judgements)
        looked.append(lighter(judgements, best))
        if best is not None and best.suspect.key == present.suspect.key and present.candidate.earns:
            continue  # else what it comes to now is its evidence
        if best is None:
            fewer = Answer(rest, answer.declared, reduced)
            return revised(fewer, declared, looked, progress, offer) if len(rest) > 1 else fewer
        answer = Answer([*rest[:i], best, *rest[i:]], answer.declared, best.state).standing
        if len(answer.added) <= len(rest):
            return revised(answer, declared, looked, progress, offer)
    return answer


def promising(looked: Sequence[Sequence[Judgement]]) -> set[str]:
    """Return the names of the candidates that explained something in one of these steps."""
    return {j.candidate.effect for judgements in looked for j in judgements if j.candidate.gain > PROMISE}


@one_thread
def trace(
    plant: Plant,
    passes: Sequence[Passes],
    progress: Progress = lambda _: None,
    most: int = STEPS,
    only: Collection[str] | None = None,
    own: Collection[Effect] = (),
) -> Trace:
    """Trace the residual of `plant` on the identification records among `passes`.

    most: effects added at most. only: names of the effects that are judged, all where absent. own: effects that are judged
    beside those of the catalogue. Returns the verdict with its evidence. Validation records are evaluated, never used for a choice.
    """
    whole = fitted_on(passes)
    identification = thin(whole)
    progress("fitting the declared model")
    try:
        declared = State(plant, identification)
    except NoValue:
        raise WorkbenchError(
            "the declared model has no value on these records: a shape parameter lies far from them; check it and its unit."
        ) from None
    offer = Offer(only, own, [e.key for e in plant.effects])
    steps = extended(declared, whole, progress, most, offer)
    looked = [s.judgements for s in steps]
    progress("looking for where the residual lives")
    greedy = Answer([s.added for s in steps if s.added is not None], declared).standing
    least = levels(passes, plant, declared.steady)
    answer, fits, level = Answer([], declared), [], least
    unexplained = unknown(declared, greedy.last, least, levels(passes, greedy.last.plant, greedy.last.steady))
    if not dressed(unexplained, greedy, lambda: on_whole(greedy.last, whole), least, passes):
        asked, fits = settled(declared, greedy, passes, looked, progress, offer)
        own = levels(passes, asked.last.plant, asked.last.steady)
        unexplained = unknown(declared, asked.last, least, own)
        if not dressed(unexplained, asked, lambda: fits[-1].identification, lower(least, own), passes):
            answer, level = asked, own
    fits = fits[: len(answer.added) + 1] or [identify(plant, passes)]
    added, last, after = answer.added, answer.last, fits[-1]
    floor = noise_floor(passes, level)
    if after.identification < LEFT * floor[IDENTIFICATION]:
        unexplained = None  # nothing is left on whole records, see `dressed`
    credited = {s.added.suspect.key for s in steps if s.credit}
    causes = []
    for i, j in enumerate(added):
        others = rivals(j, added, looked)
        progress("looking for the motion that would tell rivals apart")
        apart = experiment(last.plant, plant, j, others[0], whole, min(level.values())) if others else ""
        made = cause(j.candidate, fits[i], fits[i + 1], after, credited=j.suspect.key in credited and j.candidate.earns)
        causes.append(replace(made, rivals=tuple(o.candidate.effect for o in others), experiment=apart))
    verdict = CAUSE if causes else UNKNOWN if unexplained else NOTHING
    after = withheld(after, causes, passes)
    findings = [*not_carried(causes), *(left_over(unexplained, plant.displacement) if causes else ())]
    sentence = verdict_sentence(verdict, causes, fits[0], after, floor, unexplained)
    shows = shown(steps[0].judgements)
    return Trace(
        verdict, sentence + (named(shows) if verdict == NOTHING else ""),
        ranked([j.candidate for j in added], [j.candidate for j in steps[0].judgements]), tuple(tuple(j.candidate for j in s.judgements) for s in steps),
        tuple(causes), fits[0], after, floor, tuple(findings), described(unexplained), shows,
    )  # fmt: skip


def settled(
    declared: State,
    greedy: Answer,
    passes: Sequence[Passes],
    looked: list[list[Judgement]],
    progress: Progress,
    offer: Offer,
) -> tuple[Answer, list[Fit]]:
    """Return what is added after all, and the fits with one effect more each: as revised, or as found, as far as whole
    records bear it out."""
    answer = greedy
    if len(greedy.added) > 1:
        answer = revised(greedy, declared.plant, looked, progress, offer)
    progress("fitting the extended model")
    fits = in_turn(declared.problem.plant, answer.added, answer.last.plant, passes)
    if len(fits) <= len(answer.added) and answer is not greedy:
        answer, fits = greedy, in_turn(declared.problem.plant, greedy.added, greedy.last.plant, passes, fits[0])
    if len(fits) <= len(greedy.added) and answer is greedy:
        answer = Answer(greedy.added[: len(fits) - 1], declared)
    return answer, fits


def dressed(
    unexplained: Unexplained | None,
    answer: Answer,
    error: Callable[[], float],
    level: Mapping[str, float],
    passes: Sequence[Passes],
) -> bool:
    """Whether what was added only dresses what no effect explains.

    Not where whole records leave no more than the floor with all of it: thinned ones see coarsely what passes fast (a short
    wave at speed, friction that turns at a high rate). error: nrmse with it on whole identification records.
    """
    if unexplained is None or not unexplained.instead:
        return False
    return not answer.added or error() >= LEFT * noise_floor(passes, level)[IDENTIFICATION]


def ranked(added: Sequence[Candidate], first: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Return the candidates of the first step as they were judged there, those that were added in the end ahead of the others."""
    judged = {(c.effect, c.at): c for c in first}
    ahead = {(c.effect, c.at): judged.get((c.effect, c.at), c) for c in added}
    return (*ahead.values(), *(c for key, c in judged.items() if key not in ahead))
