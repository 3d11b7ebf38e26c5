"""What a memory of declared dry friction takes of the drive while its body moves.

Dry friction has no direction at rest, nor where it turns: what it holds there is any share of its level, and a way of some counts tells
which. A drive that waits between moves may have a quarter of its power in that. It says how friction gives way, and nothing of the law that
a moving axis follows. Of two masses what a load's friction leaves at rest may be most of its small balance, though a force there enters no
balance of the motor: joint and damping give way for it, and the drive errs. Where the balance of the body counts only while that moves, the
drive shows what is missing there.
"""

from collections.abc import Sequence
from math import sqrt

import numpy as np

from workbench.identification.fit import fitted_on, identify
from workbench.inverse.bodies import VELOCITY
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import TWO_MASS, Plant
from workbench.tracing.explainable import moving


def in_motion(before: Plant, after: Plant, inverses: Sequence[InverseDynamics], at: str) -> float:
    """Return what a plant leaves less of the drive than another one on the identification records, over the drive's rms, both fitted with the
    balance of the body `at` where that moves; 0 where it leaves more."""
    seen = [_while_it_moves(p, before, at) for p in fitted_on(inverses)]
    more, less = (identify(plant, seen).identification for plant in (before, after))
    return sqrt(max(more**2 - less**2, 0.0))


def _while_it_moves(p: InverseDynamics, plant: Plant, at: str) -> InverseDynamics:
    """Return the inverse dynamics over a record in which the balance of a body counts where it is neither at rest nor has just turned."""
    behind = plant.kind == TWO_MASS and at == "load"
    if behind and p.motion.record.locked:
        return p
    m = p.motion
    counts = np.ones((2, m.u.size), dtype=bool) if p.counts is None else p.counts.copy()
    counts[int(behind)] &= moving(p.bodies.body(plant, at)[1][VELOCITY], m.dt, m.keep)
    return InverseDynamics(m, p.fine, p.coarse, counts, p.times)
