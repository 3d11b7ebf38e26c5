"""What a search selected and whole records bear out of it, and how another addition is asked in the place of one."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from workbench.identification.result import Fit
from workbench.record import IDENTIFICATION
from workbench.tracing.answer import Answer
from workbench.tracing.candidates import ADDITION, Offer
from workbench.tracing.criteria import Criteria
from workbench.tracing.evidence import Weighed
from workbench.tracing.full_rate import nested_fits
from workbench.tracing.judge import Progress, ScoredCandidate
from workbench.tracing.near_law import as_declared
from workbench.tracing.preparing import Declared
from workbench.tracing.ranking import step
from workbench.tracing.selection import Selection
from workbench.tracing.state import State
from workbench.tracing.weighing import Confirmed, weighed


@dataclass(frozen=True, eq=False)
class Choice:
    """selected: by the search. confirmed: what whole records bear out of it, weighed. late, offer, criteria, progress: of the trace."""

    selected: Selection
    confirmed: Confirmed
    late: Declared
    offer: Offer
    criteria: Criteria
    progress: Progress

    @property
    def largest(self) -> tuple[ScoredCandidate, Weighed] | None:
        """The addition that takes most, as weighed; None where that is a correction of a declared value, or there is none."""
        both = zip(self.confirmed.added, self.confirmed.weighed, strict=True)
        found = max(both, key=lambda x: x[1].size(IDENTIFICATION), default=None)
        return found if found and found[0].candidate.kind == ADDITION else None

    def less(self, *gone: ScoredCandidate) -> State | None:
        """Return the state that the search ended with, without some additions; None where it has no value."""
        return self.selected.less(*gone)

    def judged(self, state: State, offer: Offer) -> list[ScoredCandidate]:
        """Return what is offered beside a state, judged; a free curve in it stands for the friction that is declared."""
        known = {**offer.stands_for, **{law.key: law.declared for law in self.selected.laws}}
        return step(state, self.progress, replace(offer, stands_for=known), self.criteria)

    def fitted_with(self, k: ScoredCandidate, *gone: ScoredCandidate) -> tuple[list[ScoredCandidate], list[Fit]]:
        """Return what whole records bear out with another addition in the place of the first that is gone, and the fits: of the declared
        plant, and with one more of these each."""
        added = [k if a is gone[0] else a for a in self.confirmed.added if a not in gone[1:]]
        return nested_fits(self.late, added, as_declared(k.state.plant, self.selected.laws), k.state.inverses)

    def taking(self, k: ScoredCandidate, kept: Sequence[ScoredCandidate], fits: Sequence[Fit]) -> "Choice":
        """Return the choice with the additions `kept`, of which `k` is new, weighed anew. fits: as `fitted_with` returns them."""
        answer = Answer(kept, self.selected.answer.declared, k.state)
        again = weighed(self.selected, kept, fits, self.late.inverses, self.criteria)
        return replace(
            self,
            selected=replace(self.selected, answer=answer),
            confirmed=replace(self.confirmed, added=kept, fits=fits, weighed=again),
        )
