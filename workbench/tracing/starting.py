"""Records begin as a model asks for: a search looks at starts of the records that belong to what it holds.

Where nobody promised how a record begins (`inverse.prehistory`), a start that was found with another model makes up for what that one lacked.
"""

from collections.abc import Sequence

import numpy as np

from workbench.identification.solve import NoValue
from workbench.inverse.dynamics import InverseDynamics
from workbench.inverse.prehistory import begun, begun_at, by_turns
from workbench.plant import Plant
from workbench.tracing.near_law import Law, as_declared
from workbench.tracing.state import State

COMPARED = 1e-4  # relative decrease of the cost at which these fits are as good as they are compared
FURTHER = 12  # steps of these fits: where more would be wanted, shape parameters are hard to tell apart


def freely(plant: Plant, inverses: Sequence[InverseDynamics], theta: np.ndarray, base: State) -> State:
    """Return a plant fitted with everything free, as well as such fits are compared. theta: start on the search scale. base: what it is
    compared with."""
    return State(plant, inverses, theta, base=base.solution.cost, most=FURTHER, tolerance=COMPARED)


def at_own_starts(state: State, base: State | None = None) -> State:
    """Return a fit on records that begin as it asks for, where nothing is promised and it leaves less so on held-out blocks.

    base: what it is compared with; itself where absent. An axis that hangs on its friction begins with it loaded. Where that friction is
    not declared, from relaxed starts whatever forgets soonest would lead; where something else is not, the starts that were found without it
    make up for it.
    """

    def again(fit: State) -> State | None:
        found = begun(fit.plant, fit.inverses)
        return None if found is None else freely(fit.problem.plant, found, fit.solution.theta, base or state)

    return by_turns(state, again, lambda fit: fit.errors.total)


def afresh(state: State, declared: Plant, known: Sequence[Law]) -> State:
    """Return a state whose declared laws were searched from their declared values, on records that begin relaxed, where that leaves less.

    declared: as it was declared. Values and starts that were found with a model that lacked what was added since hold each other where they are.
    """
    if all(p.motion.record.found is None for p in state.inverses):
        return state
    plant = as_declared(state.plant, known)
    for e in declared.effects:
        if any(not p.fixed for n, p in e.parameters.items() if n in e.shape) and e.key in plant:
            plant = plant.swap(e)
    try:
        other = at_own_starts(State(plant, begun_at(state.inverses, [None] * len(state.inverses))))
    except NoValue:
        return state
    return other if other.errors.total < state.errors.total else state
