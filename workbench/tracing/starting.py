"""Records begin as a model asks for: a search looks at starts of the records that belong to what it holds.

Where nobody promised how a record begins (`inverse.prehistory`), a start that was found with another model makes up for what that one lacked.
"""

from collections.abc import Sequence

import numpy as np

from workbench.inverse.dynamics import InverseDynamics
from workbench.inverse.prehistory import begun, by_turns
from workbench.plant import Plant
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
