"""Candidates judged: each fitted beside the present model, scored on data that its fold did not see, and ordered."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import isclose

import numpy as np

from workbench.finding import capital, title
from workbench.identify.passes import Passes
from workbench.identify.problem import Problem
from workbench.identify.solve import NoValue, Solution, scales, solve
from workbench.plant import Plant
from workbench.trace.candidates import ADDITION, WHOLE, Offer, Suspect
from workbench.trace.floor import calm
from workbench.trace.linearised import Linearised
from workbench.trace.result import Candidate
from workbench.trace.score import HeldOut, gain, held_out
from workbench.trace.search import fitted
from workbench.trace.smallest import Smallest, smallest

SHARE = 0.05  # of the residual's power that an effect must explain on held-out blocks
CERTAIN = 3.0  # standard errors by which its gain must differ from zero
LEADING = 6  # candidates that are fitted again with everything free
BEHIND = 0.4  # of the best one's gain, below which a candidate is not
ALIKE_RATES = 1e-6  # relative difference of two sample times that are one: a record's comes from its stamps
SETTLED = 1e-6  # relative decrease of the cost at which a fit is as good as it is judged
ALIKE = 2.0  # standard errors of a gain over another candidate within which the two are told apart by their simplicity

Progress = Callable[[str], None]


class State:
    """A plant with its solution on the thinned identification records, and its held-out errors."""

    def __init__(self, plant: Plant, passes: Sequence[Passes], theta: np.ndarray | None = None):
        self.passes = passes
        self.problem = Problem(plant, passes)
        self.solution = solve(self.problem, theta, SETTLED)
        self.plant = self.problem.with_linear(self.problem.with_shape(self.solution.theta), self.solution.c)
        self.errors: HeldOut = held_out(self.problem, self.solution)

    @cached_property
    def power(self) -> float:
        """Sum of squares of the measured drive behind the filter, where errors count."""
        return sum(float(np.sum(p.motion.filter(p.motion.u)[p.motion.keep] ** 2)) for p in self.passes)

    @property
    def freedom(self) -> int:
        """Free parameters."""
        return len(self.problem.free_linear) + len(self.problem.free_shape)

    @cached_property
    def absorbed(self) -> np.ndarray:
        """Orthonormal columns (N, r): what this model can absorb, to first order in its shape parameters."""
        columns = np.hstack([self.solution.phi, self.solution.tangents])
        columns = columns / scales(columns)
        left, singular, _ = np.linalg.svd(columns, full_matrices=False)
        return left[:, singular > 1e-7 * max(singular[:1], default=0.0)]

    @property
    def steady(self) -> float:
        """Rms of the residual's steady part."""
        first = self.passes[0].motion
        parts = zip(self.passes, self.problem.drive_part(self.solution.residual), strict=True)
        return calm(
            [r for p, r in parts if isclose(p.motion.dt, first.dt, rel_tol=ALIKE_RATES)],
            first.dt,
            first.filter.bandwidth,
        )

    @cached_property
    def residuals(self) -> list[np.ndarray]:
        """Residual of each identification record (n,), zero in the trimmed ends."""
        found = []
        for p, part in zip(self.passes, self.problem.drive_part(self.solution.residual), strict=True):
            full = np.zeros(p.motion.u.size)
            full[p.motion.keep] = part
            found.append(full)
        return found


@dataclass(frozen=True, eq=False)
class Passed:
    """What is kept of a state that was not chosen: its plant."""

    plant: Plant


@dataclass(frozen=True, eq=False)
class Judgement:
    """A suspect, what it came to beside the present model, and the state with it: whole() solves it with all free."""

    suspect: Suspect
    candidate: Candidate
    errors: HeldOut
    freedom: int
    problem: Linearised | None = None
    solution: Solution | None = None
    state: State | Passed | None = None
    shows: Smallest | None = None

    def whole(self, before: State) -> "Judgement":
        """Return the judgement after a fit with everything free; itself where that has no value."""
        if self.problem is None:
            return self
        problem, theta = self.problem.whole(self.solution)
        try:
            after = State(problem.plant, before.passes, theta)
        except NoValue:
            return self
        return replace(
            self,
            candidate=scored(before, self.suspect, after.errors, after.solution.cost),
            errors=after.errors,
            state=after,
        )


def judged(state: State, suspect: Suspect) -> Judgement:
    """Fit one suspect beside the present model and score it against the present state."""
    try:
        problem, solution = fitted(suspect, state.problem, state.solution, state.residuals)
    except NoValue:
        sentence = f"{capital(title(suspect.effect))} has no value on these records."
        whole = float(np.sqrt(state.errors.total / state.power))
        hopeless = Candidate(suspect.effect, suspect.at, suspect.kind, 0.0, 0.0, whole, whole, False, sentence)
        return Judgement(suspect, hopeless, state.errors, state.freedom)
    errors = held_out(problem, solution)
    freedom = len(problem.free_linear) + len(problem.free_shape) + len(state.problem.free_shape)
    shows = smallest(suspect.key, suspect.kind != ADDITION, problem, solution, state.absorbed, SHARE)
    return Judgement(
        suspect, scored(state, suspect, errors, solution.cost), errors, freedom, problem, solution, shows=shows
    )


def scored(state: State, suspect: Suspect, errors: HeldOut, cost: float) -> Candidate:
    """Return the candidate that a suspect is, by its held-out errors against those of the present state."""
    g, scatter = gain(state.errors, errors)
    name = title(suspect.effect)
    verb = "Correcting the declared" if suspect.kind != ADDITION else "Adding"
    sentence = (
        f"{verb} {name} takes away {100 * g:.1f} % of the held-out residual power (standard error {100 * scatter:.1f} %)."
        if g > 0
        else f"{verb} {name} explains nothing on held-out blocks."
    )
    return Candidate(
        suspect.effect, suspect.at, suspect.kind, g, scatter,
        float(np.sqrt(errors.total / state.power)), float(np.sqrt(cost / state.power)),
        g > SHARE and g > CERTAIN * scatter, sentence,
    )  # fmt: skip


def step(state: State, progress: Progress, offer: Offer = WHOLE) -> list[Judgement]:
    """Judge every suspect that is offered; return them best first, those that lead fitted with everything free."""
    judgements: list[Judgement] = []
    for suspect in offer.suspects(state.plant):
        progress(f"trying {suspect.key}")
        judgements = by_gain([*judgements, judged(state, suspect)])
        # columns of the others are many megabytes, and nobody asks for them again
        judgements[LEADING:] = [
            replace(j, problem=None, solution=None) if j.problem else j for j in judgements[LEADING:]
        ]
    for i, j in enumerate(judgements[:LEADING]):
        if j.candidate.gain > max(SHARE / 2, BEHIND * judgements[0].candidate.gain):
            progress(f"fitting {j.suspect.key} with everything free")
            judgements[i] = j.whole(state)
    return simplest_first(judgements)


def lighter(judgements: Sequence[Judgement], chosen: Judgement | None) -> list[Judgement]:
    """Return judgements without the columns of those that were not chosen: they are hundreds of megabytes."""

    def light(j: Judgement) -> Judgement:
        return replace(j, problem=None, solution=None, state=j.state and Passed(j.state.plant))

    return [j if j is chosen else light(j) for j in judgements]


def by_gain(judgements: Sequence[Judgement]) -> list[Judgement]:
    """Order by gain, those that earn their place ahead of those that do not."""
    return sorted(
        judgements,
        key=lambda j: (not j.candidate.earns, -j.candidate.gain, j.candidate.effect, j.candidate.at),
    )


def simplest_first(judgements: Sequence[Judgement]) -> list[Judgement]:
    """Order by gain; of those that the data cannot tell from the best, the one with the fewest free parameters leads."""
    judgements = by_gain(judgements)
    if not judgements:
        return judgements
    leader = judgements[0]
    level = [j for j in judgements if j is leader or (j.state and alike(leader, j))]
    simplest = min(level, key=lambda j: (j.freedom, -j.candidate.gain, j.candidate.effect, j.candidate.at))
    return [simplest, *(j for j in judgements if j is not simplest)]


def alike(best: Judgement, other: Judgement) -> bool:
    """Whether `best` takes away no more of what `other` leaves on held-out blocks than its scatter, or than SHARE.

    A ratio over blocks, as every gain: a few blocks in which much is left would drown a plain difference in scatter.
    """
    further, scatter = gain(other.errors, best.errors)
    return further <= max(ALIKE * scatter, SHARE) and best.candidate.gain > SHARE


def shown(judgements: Sequence[Judgement]) -> tuple[Smallest, ...]:
    """Return the smallest effect of each kind that a step could have shown, by name and place."""
    found = [j.shows for j in judgements if j.shows is not None]
    return tuple(sorted(found, key=lambda s: (s.effect, s.at, s.change)))
