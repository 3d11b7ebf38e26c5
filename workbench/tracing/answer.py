"""What a search adds to a declared model."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from workbench.tracing.judge import ScoredCandidate
from workbench.tracing.state import State


@dataclass(frozen=True)
class Answer:
    """What is added to the declared model, and the state with all of it: that of the last addition, unless it is given."""

    added: Sequence[ScoredCandidate]
    declared: State
    pruned: State | None = None

    @property
    def last(self) -> State:
        return self.pruned or (self.added[-1].state if self.added else self.declared)

    @property
    def standing(self) -> "Answer":
        """The answer without effects that a later one took the place of."""
        held = {e.key for e in self.last.plant.effects}
        return replace(self, added=[j for j in self.added if j.candidate.key in held])
