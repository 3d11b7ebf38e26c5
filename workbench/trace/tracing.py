"""The trace, first version: one effect after another, each fitted jointly and judged on data that its fold did not see."""

from collections.abc import Callable, Collection, Sequence

import numpy as np

from workbench.errors import WorkbenchError
from workbench.finding import capital, title
from workbench.identify.fit import fitted_on, seen
from workbench.identify.passes import Passes
from workbench.identify.problem import Problem
from workbench.identify.result import Fit
from workbench.identify.solve import NoValue, Solution, solve
from workbench.plant import Plant
from workbench.threads import one_thread
from workbench.trace.candidates import ADDITION, Suspect, suspects
from workbench.trace.floor import floor as noise_floor
from workbench.trace.result import CAUSE, NOTHING, UNKNOWN, Candidate, Trace
from workbench.trace.score import HeldOut, gain, held_out
from workbench.trace.search import fitted
from workbench.trace.verdict import cause, not_carried, plainly_left, verdict_sentence, where

STEPS = 4  # effects added at most
SHARE = 0.05  # of the residual's power that an effect must explain on held-out blocks
CERTAIN = 3.0  # standard errors by which its gain must differ from zero
ALIKE = 2.0  # standard errors of a gain over another candidate within which the two are told apart by their simplicity

Progress = Callable[[str], None]


class State:
    """A plant with its solution, and what is left of the records."""

    def __init__(
        self, plant: Plant, passes: Sequence[Passes], problem: Problem | None = None, solution: Solution | None = None
    ):
        self.passes = passes
        self.problem = problem or Problem(plant, passes)
        self.solution = solution or solve(self.problem)
        self.plant = self.problem.with_linear(self.problem.with_shape(self.solution.theta), self.solution.c)
        self.errors: HeldOut = held_out(self.problem, self.solution)

    @property
    def power(self) -> float:
        """Sum of squares of the measured drive behind the filter, where errors count."""
        return sum(float(np.sum(p.motion.filter(p.motion.u)[p.motion.keep] ** 2)) for p in self.passes)

    @property
    def freedom(self) -> int:
        """Free parameters."""
        return len(self.problem.free_linear) + len(self.problem.free_shape)

    def residuals(self) -> list[np.ndarray]:
        """Residual of each identification record (n,), zero in the trimmed ends."""
        found = []
        for p, part in zip(self.passes, self.problem.drive_part(self.solution.residual), strict=True):
            full = np.zeros(p.motion.u.size)
            full[p.motion.keep] = part
            found.append(full)
        return found


def judged(state: State, suspect: Suspect) -> tuple[Candidate, State]:
    """Fit one suspect jointly and score it against the present state."""
    try:
        problem, solution = fitted(suspect, state.passes, state.residuals())
    except NoValue:
        sentence = f"{capital(title(suspect.effect))} has no value on these records."
        whole = float(np.sqrt(state.errors.total / state.power))
        hopeless = Candidate(suspect.effect, suspect.at, suspect.kind, 0.0, 0.0, whole, whole, False, sentence)
        return hopeless, state
    after = State(suspect.plant, state.passes, problem, solution)
    g, scatter = gain(state.errors, after.errors)
    earns = g > SHARE and g > CERTAIN * scatter
    power = state.power
    name = title(suspect.effect)
    verb = "Correcting the declared" if suspect.kind != ADDITION else "Adding"
    sentence = (
        f"{verb} {name} takes away {100 * g:.1f} % of the held-out residual power (standard error {100 * scatter:.1f} %)."
        if g > 0
        else f"{verb} {name} explains nothing on held-out blocks."
    )
    candidate = Candidate(
        suspect.effect, suspect.at, suspect.kind, g, scatter,
        float(np.sqrt(after.errors.total / power)), float(np.sqrt(after.solution.cost / power)), earns, sentence,
    )  # fmt: skip
    return candidate, after


def step(state: State, progress: Progress, only: Collection[str] | None = None) -> tuple[list[Candidate], State | None]:
    """Judge every suspect; return them best first, and the state with the best one added where it earns its place.

    only: names of effects, where not every suspect is to be judged.
    """
    judgements = []
    for suspect in suspects(state.plant):
        if only is not None and suspect.effect not in only:
            continue
        progress(f"trying {suspect.key}")
        judgements.append(judged(state, suspect))
    judgements = simplest_first(judgements)
    ranked = [candidate for candidate, _ in judgements]
    best = next(((c, s) for c, s in judgements if c.earns), None)
    return ranked, best[1] if best else None


def simplest_first(judgements: list[tuple[Candidate, State]]) -> list[tuple[Candidate, State]]:
    """Order by gain, those that earn their place ahead of those that do not.

    Of those that the data cannot tell from the best, the one with the fewest free parameters leads.
    """
    judgements = sorted(judgements, key=lambda j: (not j[0].earns, -j[0].gain, j[0].effect, j[0].at))
    if not judgements:
        return judgements
    leader = judgements[0]
    level = [j for j in judgements if j is leader or alike(leader[1], j[1], leader[0].gain)]
    simplest = min(level, key=lambda j: (j[1].freedom, -j[0].gain, j[0].effect, j[0].at))
    return [simplest, *(j for j in judgements if j is not simplest)]


def alike(best: State, other: State, share: float) -> bool:
    """Whether `best` takes away no more of what `other` leaves on held-out blocks than its scatter, or than SHARE.

    A ratio over blocks, as every gain: a few blocks in which much is left would drown a plain difference in scatter.
    """
    further, scatter = gain(other.errors, best.errors)
    return further <= max(ALIKE * scatter, SHARE) and share > SHARE


@one_thread
def trace(
    plant: Plant,
    passes: Sequence[Passes],
    progress: Progress = lambda _: None,
    most: int = STEPS,
    only: Collection[str] | None = None,
) -> Trace:
    """Trace the residual of `plant` on the identification records among `passes`.

    most: effects added at most. only: names of the effects that are judged, all where absent. Returns the verdict with its evidence. Validation records are evaluated, never used for a choice.
    """
    identification = fitted_on(passes)
    progress("fitting the declared model")
    try:
        declared = state = State(plant, identification)
    except NoValue:
        raise WorkbenchError(
            "the declared model has no value on these records: a shape parameter lies far from them; check it and its unit."
        ) from None
    steps, added = [], []
    fits = [_fit(state, passes)]
    for _ in range(most):
        ranked, better = step(state, progress, only)
        steps.append(tuple(ranked))
        if better is None:
            break
        added.append(next(c for c in ranked if c.earns))
        state = better
        fits.append(_fit(state, passes))
    floor = noise_floor(passes, state.plant)
    before, after = fits[0], fits[-1]
    causes = tuple(cause(c, fits[i], fits[i + 1], after) for i, c in enumerate(added))
    verdict = CAUSE if causes else (UNKNOWN if plainly_left(after, floor) else NOTHING)
    findings = list(not_carried(causes))
    return Trace(
        verdict, verdict_sentence(verdict, causes, before, after, floor), steps[0], tuple(steps), causes,
        before, after, floor, tuple(findings), where(declared.passes, declared.residuals()) if verdict == UNKNOWN else {},
    )  # fmt: skip


def _fit(state: State, passes: Sequence[Passes]) -> Fit:
    return seen(state.problem, state.solution, passes)
