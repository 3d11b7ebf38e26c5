"""The search: one effect after another, each the one that explains most of what the others leave on data not seen."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.inverse.dynamics import InverseDynamics
from workbench.residual.noise_floor import noise_rms, with_stationary
from workbench.tracing.candidates import Offer
from workbench.tracing.criteria import Criteria
from workbench.tracing.free_law import free_law, otherwise_spelled, steadier
from workbench.tracing.judge import Progress, ScoredCandidate, lighter
from workbench.tracing.lazy import Lazy
from workbench.tracing.orders import any_curve
from workbench.tracing.ranking import step
from workbench.tracing.state import State
from workbench.tracing.unexplained import PLAIN, noise_alone


@dataclass(frozen=True)
class Step:
    """One round of the search: every judgement, best first, and the one whose effect was added; None where it ended.

    provisional: whether it was added before its gain was certain.
    """

    judgements: Sequence[ScoredCandidate]
    added: ScoredCandidate | None
    provisional: bool = False


def extended(
    state: State,
    whole: Sequence[InverseDynamics],
    progress: Progress,
    offer: Offer,
    criteria: Criteria,
    freshly: Callable[[State], State],
    enough: Callable[[Sequence[ScoredCandidate]], bool] = lambda _: False,
) -> list[Step]:
    """Add effects one after another while one earns its place. Only the last step may have added nothing.

    whole: inverse dynamics of the identification records as they are. Near the floor an effect must take away a plain share. One effect may be added
    provisionally (see `promised`): it stays where a later one earns its place, and `pruned` asks whether it earns its own.
    Before anything was added, what may be any curve is asked for no steadier law of its class, and promises nothing.
    freshly: a state with its free virgin curves found anew. enough: asked of what was added, all of it certain, whether the search is to end with
    it. Where nothing is left that could be a cause, no further effect is asked.
    """
    found: list[Step] = []
    first, quiet = state, noise_rms(whole, state.plant)
    provisional: ScoredCandidate | None = None
    lazy = Lazy(criteria)
    for _ in range(criteria.steps):
        if found and provisional is None and spent(state, first, quiet, criteria):
            break
        level = with_stationary(quiet, whole, state.steady)
        judgements = step(state, progress, offer, criteria, lazy.beside(state, everything=provisional is not None))
        lazy.noted(judgements, state)
        least = criteria.plain if noise_alone(state, level, PLAIN) else 0.0
        best = leading(judgements, least)
        if (
            best is not None
            and (free := free_law(state, judgements, best, [s.added for s in found], criteria, offer)) is not None
        ):
            judgements, best = [free, *judgements], free
        if best is None and not noise_alone(state, level, PLAIN):
            asked = [j for j in judgements if found or not any_curve(j, state, criteria, offer)]
            steady = steadier(state, _most_first(asked), criteria, offer)
            if steady is None and found and not any(j.score.earns for j in judgements):
                steady = otherwise_spelled(state, [s.added for s in found], criteria, offer)
            if steady is not None and steady.state is not None:
                judgements, best = [steady, *judgements], steady
            elif provisional is None:
                best = provisional = promised(asked, criteria, offer.hinted)
        found.append(Step(lighter(judgements, best), best, best is not None and best is provisional))
        if best is None or (provisional is None and enough([s.added for s in found])):
            break
        state = freshly(best.state)
        quiet = noise_rms(whole, state.plant)
    return earned(found)


def spent(state: State, first: State, quiet: Mapping[str, float], criteria: Criteria) -> bool:
    """Whether what a state leaves on blocks that were not seen, above the noise of the drive and the counts, is less than what a further
    cause takes: than what is of practical size, and than `lesser` of what was taken of `first`. quiet: record -> rms of that noise; where it
    says more than is left it is not what it was read to be, and ends nothing."""
    kept = {
        p.motion.record.name: np.ones(p.motion.u.size, bool) if p.counts is None else p.counts[0]
        for p in state.inverses
    }
    noise = sum(
        quiet[m.record.name] ** 2 * kept[m.record.name][m.keep].sum() for m in (p.motion for p in state.inverses)
    )
    taken = first.errors.total - state.errors.total
    return 0.0 <= state.errors.total - noise < min(criteria.practical**2 * state.power, criteria.lesser**2 * taken)


def earned(steps: list[Step]) -> list[Step]:
    """Return the steps without what was added provisionally, and what came of it, where no effect was added after it."""
    added = [s for s in steps if s.added is not None]
    if not added or not added[-1].provisional:
        return steps
    until = steps.index(added[-1])
    return [*steps[:until], Step(steps[until].judgements, None)]


def promised(
    judgements: Sequence[ScoredCandidate], criteria: Criteria, hinted: Collection[str] = ()
) -> ScoredCandidate | None:
    """Return the leading judgement where its gain is plain though not certain, or None.

    Where two effects are missing each explains the blocks in which it acts and leaves the other's as they are, so that the
    gain of either scatters from block to block. hinted: as of `Offer`; of these `hint` is not asked.
    """
    best = judgements[0] if judgements else None
    if best is None or best.state is None:
        return None
    hint = 0.0 if best.candidate.key in hinted else criteria.hint
    return best if best.score.gain > max(criteria.plain, hint * best.score.scatter) else None


def _most_first(judgements: Sequence[ScoredCandidate]) -> list[ScoredCandidate]:
    """Return judgements of which none leads by the gain of those fitted with everything free: what earns its place and does not lead is
    nothing of its own. Where a simpler one explains as much as that, the simpler one is first."""
    ordered = sorted(judgements, key=lambda j: (j.refitted is None, -j.score.gain, j.candidate.key))
    if ordered and ordered[0].score.earns and judgements[0].refitted and not judgements[0].score.earns:
        return [judgements[0], *(j for j in ordered if j is not judgements[0])]
    return ordered


def leading(judgements: Sequence[ScoredCandidate], least: float = 0.0) -> ScoredCandidate | None:
    """Return the judgement whose effect is to be added, or None. least: share that it must take away."""
    best = judgements[0] if judgements else None
    worth = best is not None and best.state is not None and best.score.earns and best.score.gain > least
    return best if worth else None
