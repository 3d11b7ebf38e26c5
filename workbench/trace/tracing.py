"""The trace: one effect after another, then what a later one made needless, then what no effect explains."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from workbench.effect import Effect
from workbench.errors import WorkbenchError
from workbench.identify.fit import fitted_on, identify
from workbench.identify.passes import Passes
from workbench.identify.result import Fit
from workbench.identify.solve import NoValue
from workbench.plant import TWO_MASS, Plant
from workbench.record import IDENTIFICATION
from workbench.threads import one_thread
from workbench.trace.calibration import withheld
from workbench.trace.candidates import Offer, brought, without
from workbench.trace.counted import of_counts
from workbench.trace.floor import floor as noise_floor
from workbench.trace.floor import levels, steadied
from workbench.trace.judge import SHARE, Judgement, Progress, State, lighter, shown, step
from workbench.trace.result import CAUSE, NOTHING, UNKNOWN, Candidate, Trace
from workbench.trace.rivals import experiment, rivals
from workbench.trace.smallest import named
from workbench.trace.thin import thin
from workbench.trace.unexplained import LEFT, PLAIN, Unexplained, described, lower, noise_alone, unknown
from workbench.trace.verdict import cause, left_over, not_carried, verdict_sentence

STEPS = 4  # effects added at most
PLAIN_SHARE = 0.15  # of the residual's power that a further effect must take away near the floor
RISEN = 1.05  # of the drive's error, from which it has plainly risen
HINT = 2.0  # standard errors by which a gain must differ from zero to be taken on credit
PROMISE = 0.01  # of the residual's power, from which a candidate is asked again when others are taken out


@dataclass(frozen=True)
class Step:
    """One round of the search: every judgement, best first, and the one whose effect was added; None where it ended.

    credit: whether it was added on credit.
    """

    judgements: Sequence[Judgement]
    added: Judgement | None
    credit: bool = False


def extended(state: State, whole: Sequence[Passes], progress: Progress, most: int, offer: Offer) -> list[Step]:
    """Add effects one after another while one earns its place. Only the last step may have added nothing.

    whole: passes of the identification records as they are. Where the declared model leaves no more than the floor nothing is
    added, and the search ends where only the noise of drive and encoders is left: an effect could only be fitted to that. Near
    the floor an effect must take away a plain share, and of more than what counts alone would leave. One effect may be added
    on credit (see `promised`): it stays where a later one earns its place, and `revised` asks whether it earns its own.
    """
    found: list[Step] = []
    quiet = levels(whole, state.plant)
    credit: Judgement | None = None
    for _ in range(most):
        level = steadied(quiet, whole, state.steady)
        judgements = step(state, progress, offer)
        least = least_share(state, level, not found)
        best = leading(judgements, least)
        if best is not None and least > 0.0:
            spurious = of_counts(best.suspect, state, whole)
            if best.candidate.gain - spurious <= least:
                judgements[0], best = replace(best, candidate=by_counts(best.candidate, spurious)), None
        if best is None and credit is None and not noise_alone(state, level, PLAIN):
            best = credit = promised(judgements)
        found.append(Step(lighter(judgements, best), best, best is not None and best is credit))
        if best is None:
            break
        state = best.state
        quiet = levels(whole, state.plant)
        if quieted(state, whole, quiet):
            break
    return earned(found)


def quieted(state: State, whole: Sequence[Passes], level: Mapping[str, float]) -> bool:
    """Whether a state leaves the noise alone: on the thinned records or, where these leave little more, on whole ones."""
    if noise_alone(state, level) or not noise_alone(state, level, PLAIN):
        return noise_alone(state, level)
    return noise_alone(State(state.problem.plant, whole, state.solution.theta, solved=True), level)


def by_counts(c: Candidate, spurious: float) -> Candidate:
    """Return a candidate that does not earn its place, because of what it would take away of the counts alone."""
    more = (
        f" Of what counts alone would leave of a machine that lacks nothing it would take away {100 * spurious:.1f} %."
    )
    return replace(c, earns=False, sentence=c.sentence + more)


def earned(steps: list[Step]) -> list[Step]:
    """Return the steps without what was added on credit, and what came of it, where no effect was added after it."""
    added = [s for s in steps if s.added is not None]
    if not added or not added[-1].credit:
        return steps
    until = steps.index(added[-1])
    return [*steps[:until], Step(steps[until].judgements, None)]


def promised(judgements: Sequence[Judgement]) -> Judgement | None:
    """Return the leading judgement where its gain is plain though not certain, or None.

    Where two effects are missing each explains the blocks in which it acts and leaves the other's as they are, so that the
    gain of either scatters from block to block.
    """
    best = judgements[0] if judgements else None
    c = best.candidate if best else None
    plain = best is not None and best.state is not None and c.gain > max(PLAIN_SHARE, HINT * c.scatter)
    return best if plain else None


def least_share(state: State, level: Mapping[str, float], first: bool) -> float:
    """Return the share of the residual's power that an effect must take away to be added to a state."""
    if first and noise_alone(state, level, 1.0):
        return 1.0
    return PLAIN_SHARE if noise_alone(state, level, PLAIN) else 0.0


def leading(judgements: Sequence[Judgement], least: float = 0.0) -> Judgement | None:
    """Return the judgement whose effect is to be added, or None. least: share that it must take away."""
    best = judgements[0] if judgements else None
    worth = best is not None and best.state is not None and best.candidate.earns and best.candidate.gain > least
    return best if worth else None


@dataclass(frozen=True)
class Answer:
    """What is added to the declared model, and the state with all of it: that of the last addition, unless it is given."""

    added: Sequence[Judgement]
    declared: State
    revised: State | None = None

    @property
    def last(self) -> State:
        return self.revised or (self.added[-1].state if self.added else self.declared)


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
        answer = Answer([*rest[:i], best, *rest[i:]], answer.declared, best.state)
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
    greedy = Answer([s.added for s in steps if s.added is not None], declared)
    least = levels(passes, plant, declared.steady)
    start = identify(plant, passes)
    answer, fits, level = greedy, [start], least
    unexplained = unknown(declared, greedy.last, least, levels(passes, greedy.last.plant, greedy.last.steady))
    if not dressed(unexplained, greedy, lambda: on_whole(greedy.last, whole), least, passes):
        answer, fits = settled(declared, greedy, start, passes, looked, progress, offer)
        level = levels(passes, answer.last.plant, answer.last.steady)
        unexplained = unknown(declared, answer.last, least, level)
    if dressed(unexplained, answer, lambda: fits[-1].identification, lower(least, level), passes):
        answer, fits, level = Answer([], declared), [start], least
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
        made = cause(j.candidate, fits[i], fits[i + 1], after, credited=j.suspect.key in credited)
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
    start: Fit,
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
    fits = in_turn(start, answer, passes)
    if len(fits) <= len(answer.added) and answer is not greedy:
        answer, fits = greedy, in_turn(start, greedy, passes)
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


def on_whole(state: State, whole: Sequence[Passes]) -> float:
    """Return the nrmse of the drive that a state's model comes to on whole identification records, refined there."""
    found = State(state.problem.plant, whole, state.solution.theta)
    left = sum(float(part @ part) for part in found.problem.drive_part(found.solution.residual))
    return (left / found.power) ** 0.5 if found.power > 0.0 else 0.0


def in_turn(start: Fit, answer: Answer, passes: Sequence[Passes]) -> list[Fit]:
    """Return `start` and the fits with one more effect each, up to the first that explains nothing on whole records.

    The search looks at thinned records and compares commands; a fit of the drive itself has the last word. It starts from the
    values that the search ended with, because a declared model that lacks much is fitted to values far from the machine's;
    and from the fit before it where that comes to nothing.
    """
    fits = [start]
    for j in answer.added:
        plant = brought(fits[-1].plant, j.suspect, answer.last.plant)
        tried = (identify(p, passes) for p in (valued(plant, answer.last.plant), plant))
        better = next((fit for fit in tried if borne_out(fits[-1], fit)), None)
        if better is None:
            break
        fits.append(better)
    return fits


def borne_out(before: Fit, after: Fit) -> bool:
    """Whether whole records bear out what a fit has and the one before has not: the error of the drive falls.

    Of two masses it may be the load's balance alone in which it shows: then what both leave falls plainly, and the drive's
    error does not rise plainly.
    """
    if after.identification < before.identification:
        return True
    falls = before.plant.kind == TWO_MASS and after.details["cost"] < (1.0 - SHARE) * before.details["cost"]
    return falls and after.identification < RISEN * before.identification


def valued(plant: Plant, other: Plant) -> Plant:
    """Return `plant` with the values that the same effects have in `other`."""
    known = {e.key: {n: p.value for n, p in e.parameters.items()} for e in other.effects}
    return plant.with_values({e.key: known[e.key] for e in plant.effects if e.key in known})


def ranked(added: Sequence[Candidate], first: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Return the candidates of the first step as they were judged there, those that were added in the end ahead of the others."""
    judged = {(c.effect, c.at): c for c in first}
    ahead = {(c.effect, c.at): judged.get((c.effect, c.at), c) for c in added}
    return (*ahead.values(), *(c for key, c in judged.items() if key not in ahead))
