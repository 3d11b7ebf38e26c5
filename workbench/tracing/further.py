"""What a further cause stands on: what the larger ones leave, as if these had been declared.

Of a declared model's residual that the reference foretells nothing of, an effect that takes less than `held` is no cause; nor is it one
beside a larger cause. What both take together says nothing of it: the larger one took nearly all of that. Where the reference foretells
nothing of the declared model's residual either, though the larger cause is in it, its silence says nothing.
"""

from dataclasses import replace

from workbench.identification.solve import NoValue
from workbench.processes import shared
from workbench.record import IDENTIFICATION
from workbench.tracing.candidates import without
from workbench.tracing.criteria import Criteria
from workbench.tracing.decide import in_question
from workbench.tracing.evidence import Weighed
from workbench.tracing.explainable import explainable
from workbench.tracing.foreseen import loaded
from workbench.tracing.selection import Selection
from workbench.tracing.state import State
from workbench.tracing.weighing import Confirmed


def foretold(selected: Selection, confirmed: Confirmed, before: float, criteria: Criteria) -> Confirmed:
    """Return what was confirmed with the explainable size of what the larger additions leave, of each further one that is in question.

    before: that size of the declared model's residual.
    """
    if before < criteria.explainable:
        return confirmed
    asked = {}
    for i in in_question(confirmed.weighed, criteria):
        state = _beside_larger(selected, confirmed, confirmed.weighed[i])
        if state is not None:
            asked[i] = state
    if not asked:
        return confirmed
    loaded()
    sizes = dict(zip(asked, shared(lambda s: explainable(s, criteria).size, list(asked.values())), strict=True))
    known = tuple(replace(w, foretold=sizes[i]) if i in sizes else w for i, w in enumerate(confirmed.weighed))
    return replace(confirmed, weighed=known)


def _beside_larger(selected: Selection, confirmed: Confirmed, w: Weighed) -> State | None:
    """Return the state with the additions alone that take more than one of them, None where it has no value."""
    last, size = selected.answer.last, w.size(IDENTIFICATION)
    more = {
        j.candidate.key
        for j, x in zip(confirmed.added, confirmed.weighed, strict=True)
        if x.size(IDENTIFICATION) > size
    }
    plant = last.plant
    for j in selected.answer.added:
        if j.candidate.key not in more:
            plant = without(plant, j.candidate, selected.base.plant)
    try:
        return State(plant, last.inverses)
    except NoValue:
        return None
