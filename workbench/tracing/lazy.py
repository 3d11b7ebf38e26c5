"""Candidates that a further round does not ask again: what took next to nothing of a state of which hardly less is left now.

What a candidate takes shrinks, as a rule, with what was taken before it, so that a greedy selection need not ask those again that are
far from leading (Minoux 1978, Accelerated greedy algorithms for maximizing submodular set functions). It is a rule with exceptions: two
effects may hide one another. So all are asked again once a plain part of what was left is taken, or what was added is not certain.
"""

from collections.abc import Callable, Sequence

import numpy as np

from workbench.tracing.candidates import Candidate
from workbench.tracing.criteria import Criteria
from workbench.tracing.judge import ScoredCandidate
from workbench.tracing.state import State

# Of the least share that an effect must take, that a candidate took of the state that it was judged beside, from which it is asked again; and of
# the held-out power that was left when it was asked, below which everything is another matter. The first doubled and the second halved, no verdict of
# c, d, the carried and the measured axes changes; nor with all asked in every round (the second of 1), for which d08 takes a quarter longer
HOPE, MUCH = 0.1, 0.5

Asked = tuple[str, str, bool]  # a candidate: its key, its kind, and whether it takes the place of something
Took = tuple[float, float]  # share of the held-out power that was left, and that power


class Lazy:
    """What the rounds of a search have asked, and how much was left when they did."""

    def __init__(self, criteria: Criteria):
        self._least = HOPE * criteria.share
        self._asked: dict[Asked, Took] = {}

    def noted(self, judgements: Sequence[ScoredCandidate], state: State) -> None:
        """Keep what these took of a state."""
        self._asked |= {
            _which(j.candidate): (j.score.gain, state.errors.total) for j in judgements if j.theta is not None
        }

    def beside(self, state: State, everything: bool) -> Callable[[Candidate], bool]:
        """Return whether a candidate is asked beside a state: it was not asked yet, or that was another matter, or it may take its share now.

        everything: whether all are.
        """
        left = state.errors.total

        def asks(candidate: Candidate) -> bool:
            gain, before = self._asked.get(_which(candidate), (1.0, np.inf))
            return everything or left < MUCH * before or gain * before > self._least * left

        return asks


def _which(candidate: Candidate) -> Asked:
    return candidate.key, candidate.kind, bool(candidate.instead)
