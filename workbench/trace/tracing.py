"""The trace: one effect after another, then what a later one made needless, then what no effect explains."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from workbench.effect import Effect
from workbench.errors import WorkbenchError
from workbench.identify.fit import fitted_on, identify
from workbench.identify.passes import Passes
from workbench.identify.result import Fit
from workbench.identify.solve import NoValue
from workbench.plant import Plant
from workbench.record import IDENTIFICATION
from workbench.threads import one_thread
from workbench.trace.candidates import Offer, brought, without
from workbench.trace.floor import floor as noise_floor
from workbench.trace.floor import levels
from workbench.trace.judge import Judgement, Progress, State, shown, step
from workbench.trace.result import CAUSE, NOTHING, UNKNOWN, Candidate, Trace
from workbench.trace.rivals import experiment, rivals
from workbench.trace.smallest import named
from workbench.trace.thin import thin
from workbench.trace.unexplained import LEFT, described, noise_alone, unknown
from workbench.trace.verdict import cause, left_over, not_carried, verdict_sentence

STEPS = 4  # effects added at most


def extended(
    state: State, whole: Sequence[Passes], progress: Progress, most: int, offer: Offer
) -> list[tuple[State, list]]:
    """Add effects one after another while one earns its place: [(state with it, judgements of that step), ...].

    whole: passes of the identification records as they are. The last entry may have no state: the step in which nothing
    earned its place. The search ends, too, where what is left is the noise of drive and encoders: a further effect could only
    be fitted to that.
    """
    found = []
    for _ in range(most):
        judgements = step(state, progress, offer)
        best = leading(judgements)
        found.append((best.state if best else None, judgements))
        if best is None:
            break
        state = best.state
        if noise_alone(state, levels(whole, state.plant)):
            break
    return found


def leading(judgements: Sequence[Judgement]) -> Judgement | None:
    """Return the judgement whose effect is to be added, or None."""
    best = judgements[0] if judgements else None
    return best if best is not None and best.state is not None and best.candidate.earns else None


def revised(
    found: list[Judgement],
    last: State,
    declared: Plant,
    looked: list[list[Judgement]],
    progress: Progress,
    offer: Offer,
) -> tuple[list[Judgement], State]:
    """Ask of each effect but the last whether the later ones made it needless, or made another one the better answer.

    Greedy selection cannot take back a choice made while something else was missing. Each effect is taken out in turn and
    the search repeated with the others in place; what leads then stands in its stead. looked: every step's judgements, to
    which these are added.
    """
    for i in range(len(found) - 1):
        present = found[i]
        progress(f"asking again for {present.suspect.key}")
        rest = [j for k, j in enumerate(found) if k != i]
        try:
            reduced = State(without(last.plant, present.suspect, declared), last.passes)
        except NoValue:
            continue
        looked.append(judgements := step(reduced, progress, offer))
        best = leading(judgements)
        if best is not None and best.suspect.key == present.suspect.key:
            continue
        if best is None:
            return revised(rest, reduced, declared, looked, progress, offer) if len(rest) > 1 else (rest, reduced)
        found = [*rest[:i], best, *rest[i:]]
        last = best.state
    return found, last


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
    added = [leading(judgements) for state, judgements in steps if state is not None]
    last = added[-1].state if added else declared
    progress("looking for where the residual lives")
    level = levels(passes, last.plant, last.steady)
    unexplained = unknown(declared, last, level)
    looked = [judgements for _, judgements in steps]
    greedy = added, last
    if len(added) > 1 and not (unexplained and unexplained.instead):
        added, last = revised(added, last, plant, looked, progress, offer)
        unexplained = unknown(declared, last, level)
    if unexplained is not None and unexplained.instead:
        added, last = greedy = [], declared
    progress("fitting the extended model")
    start = identify(declared.plant, passes)
    fits = in_turn(start, added, last, passes)
    if len(fits) <= len(added) and added is not greedy[0]:
        added, last = greedy
        fits = in_turn(start, added, last, passes)
    added = added[: len(fits) - 1]
    after = fits[-1]
    floor = noise_floor(passes, level)
    if start.identification < LEFT * floor[IDENTIFICATION]:
        unexplained = None  # on whole records nothing is left; thinned ones see friction at high rates coarsely
    causes = []
    for i, j in enumerate(added):
        others = rivals(j, added, looked)
        progress("looking for the motion that would tell rivals apart")
        apart = experiment(last.plant, plant, j, others[0], identification, min(level.values())) if others else ""
        made = cause(j.candidate, fits[i], fits[i + 1], after)
        causes.append(replace(made, rivals=tuple(o.candidate.effect for o in others), experiment=apart))
    verdict = CAUSE if causes else UNKNOWN if unexplained else NOTHING
    findings = [*not_carried(causes), *(left_over(unexplained) if causes else ())]
    sentence = verdict_sentence(verdict, causes, fits[0], after, floor, unexplained)
    least = shown(steps[0][1])
    return Trace(
        verdict, sentence + (named(least) if verdict == NOTHING else ""),
        ranked([j.candidate for j in added], [j.candidate for j in steps[0][1]]), tuple(tuple(j.candidate for j in judgements) for _, judgements in steps),
        tuple(causes), fits[0], after, floor, tuple(findings), described(unexplained), least,
    )  # fmt: skip


def in_turn(start: Fit, added: Sequence[Judgement], last: State, passes: Sequence[Passes]) -> list[Fit]:
    """Return `start` and the fits with one more effect each, up to the first that explains nothing on whole records.

    The search looks at thinned records and compares commands; a fit of the drive itself has the last word.
    """
    fits = [start]
    for j in added:
        fit = identify(brought(fits[-1].plant, j.suspect, last.plant), passes)
        if not fit.identification < fits[-1].identification:
            break
        fits.append(fit)
    return fits


def ranked(added: Sequence[Candidate], first: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Return the candidates of the first step as they were judged there, those that were added in the end ahead of the others."""
    judged = {(c.effect, c.at): c for c in first}
    ahead = {(c.effect, c.at): judged.get((c.effect, c.at), c) for c in added}
    return (*ahead.values(), *(c for key, c in judged.items() if key not in ahead))
