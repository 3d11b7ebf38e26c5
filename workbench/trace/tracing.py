"""The trace, first version: one effect after another, each fitted jointly and judged on data that its fold did not see."""

from collections.abc import Callable, Collection, Sequence

import numpy as np

from workbench.effect import find
from workbench.errors import WorkbenchError
from workbench.finding import Finding, capital, title
from workbench.identify.fit import fitted_on, seen
from workbench.identify.passes import Passes
from workbench.identify.problem import Problem
from workbench.identify.result import Fit
from workbench.identify.solve import NoValue, Solution, solve
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.threads import one_thread
from workbench.trace.candidates import ADDITION, Suspect, suspects
from workbench.trace.floor import floor as noise_floor
from workbench.trace.result import CAUSE, NOTHING, UNKNOWN, Candidate, Cause, Trace
from workbench.trace.score import HeldOut, gain, held_out
from workbench.trace.search import fitted

STEPS = 4  # effects added at most
SHARE = 0.05  # of the residual's power that an effect must explain on held-out blocks
CERTAIN = 3.0  # standard errors by which its gain must differ from zero
ALIKE = 2.0  # standard errors of a gain over another candidate within which the two are told apart by their simplicity
ABOVE_FLOOR = 2.0  # residual over floor at which something is plainly left that no candidate explains

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
    causes = tuple(_cause(c, fits[i], fits[i + 1], after) for i, c in enumerate(added))
    verdict = CAUSE if causes else (UNKNOWN if _plainly_left(after, floor) else NOTHING)
    findings = list(_not_carried(causes))
    return Trace(
        verdict, _verdict_sentence(verdict, causes, before, after, floor), steps[0], tuple(steps), causes,
        before, after, floor, tuple(findings), _where(declared) if verdict == UNKNOWN else {},
    )  # fmt: skip


def _fit(state: State, passes: Sequence[Passes]) -> Fit:
    return seen(state.problem, state.solution, passes)


def _plainly_left(fit: Fit, floor) -> bool:
    least = floor[IDENTIFICATION]
    return bool(least > 0 and fit.identification > ABOVE_FLOOR * least)


def _share(before: float, after: float) -> float:
    return 1.0 - (after / before) ** 2 if before > 0 else 0.0


def _cause(candidate: Candidate, before: Fit, here: Fit, last: Fit) -> Cause:
    effect = find(candidate.effect)
    estimates = tuple(e for e in last.estimates if (e.effect, e.at) == (candidate.effect, candidate.at))
    identification = _share(before.rms[IDENTIFICATION], here.rms[IDENTIFICATION])
    validation = _share(before.rms[VALIDATION], here.rms[VALIDATION])
    verb = "is declared with a wrong value" if candidate.kind != ADDITION else "is missing"
    sentence = (
        f"{capital(title(candidate.effect))} at the {candidate.at} {verb}: {effect.cause}. It explains "
        f"{100 * identification:.1f} % of the residual power on the identification records and {100 * validation:.1f} % "
        "on the validation record."
    )
    return Cause(candidate.effect, candidate.at, sentence, estimates, identification, validation)


def _not_carried(causes: Sequence[Cause]):
    for c in causes:
        if c.share_validation < 0.5 * c.share_identification:
            yield Finding(
                "not carried over", c.effect,
                f"{capital(title(c.effect))} explains {100 * c.share_identification:.0f} % on identification but only "
                f"{100 * c.share_validation:.0f} % on validation; do not rely on it before a second validation record.",
                {"identification": c.share_identification, "validation": c.share_validation},
            )  # fmt: skip


def _verdict_sentence(verdict: str, causes: Sequence[Cause], before: Fit, after: Fit, floor) -> str:
    if verdict == CAUSE:
        names = " and ".join(title(c.effect) for c in causes)
        is_are = "is" if len(causes) == 1 else "are"
        what = "missing" if len(causes) > 1 or "missing" in causes[0].sentence else "declared with a wrong value"
        return (
            f"{capital(names)} {is_are} {what}. With {'it' if len(causes) == 1 else 'them'}, the validation error falls from "
            f"{100 * before.validation:.2f} % to {100 * after.validation:.2f} % and the identification error from "
            f"{100 * before.identification:.2f} % to {100 * after.identification:.2f} % "
            f"(noise floor {100 * floor[IDENTIFICATION]:.2g} %)."
        )
    if verdict == UNKNOWN:
        return (
            f"Something is missing that no effect of the catalogue explains: the residual is "
            f"{before.identification / floor[IDENTIFICATION]:.1f} times the noise floor, and no candidate earns its place."
        )
    return (
        f"Nothing is missing: the residual, {100 * before.identification:.2f} % on identification, is "
        f"{before.identification / floor[IDENTIFICATION]:.2f} times the noise floor, and no effect of the catalogue "
        "explains a share of it that holds on held-out blocks."
        if floor[IDENTIFICATION] > 0
        else "Nothing is missing: no effect of the catalogue explains a share of the residual that holds on held-out blocks."
    )


def _where(state: State) -> dict[str, object]:
    """The coordinate in which the residual's power is most concentrated, in ten bins of equal population each."""
    signals = {"position": [], "velocity": [], "time": []}
    power = []
    for p, r in zip(state.passes, state.residuals(), strict=True):
        m, keep = p.motion, p.motion.keep
        for name, values in (("position", m.q), ("velocity", m.v), ("time", m.t)):
            signals[name].append(values[keep])
        power.append(r[keep] ** 2)
    power = np.concatenate(power)
    best = {}
    for name, parts in signals.items():
        values = np.concatenate(parts)
        edges = np.quantile(values, np.linspace(0, 1, 11))
        index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, 9)
        shares = np.bincount(index, weights=power, minlength=10) / power.sum()
        k = int(np.argmax(shares))
        if shares[k] > best.get("share", 0.0):
            best = {"coordinate": name, "low": float(edges[k]), "high": float(edges[k + 1]), "share": float(shares[k])}
    return best
