"""What a memory of a load's dry friction takes of the drive while the load moves.

A force at the load enters no balance of the motor. But dry friction has no direction at rest, nor where it turns, and what it leaves there
may be most of a load's small balance: joint and damping give way for it, and the drive errs. Where the load's balance counts only while
the load moves, the drive shows what is missing there.
"""

from collections.abc import Sequence
from math import sqrt

import numpy as np

from workbench.identification.fit import fitted_on, identify
from workbench.inverse.bodies import VELOCITY
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import TWO_MASS, Plant
from workbench.tracing.explainable import moving


def in_motion(before: Plant, after: Plant, inverses: Sequence[InverseDynamics]) -> float:
    """Return what a plant of two masses leaves less of the drive than another one on the identification records, over the drive's rms, both
    fitted with the load's balance where the load moves; 0 where it leaves more."""
    seen = [_while_the_load_moves(p, before) for p in fitted_on(inverses)]
    more, less = (identify(plant, seen).identification for plant in (before, after))
    return sqrt(max(more**2 - less**2, 0.0))


def _while_the_load_moves(p: InverseDynamics, plant: Plant) -> InverseDynamics:
    """Return the inverse dynamics over a record in which the load's balance counts where the load is neither at rest nor has just turned."""
    if plant.kind != TWO_MASS or p.motion.record.locked:
        return p
    m = p.motion
    counts = np.ones((2, m.u.size), dtype=bool) if p.counts is None else p.counts.copy()
    counts[1] &= moving(p.bodies.body(plant, "load")[1][VELOCITY], m.dt, m.keep)
    return InverseDynamics(m, p.fine, p.coarse, counts, p.times)
