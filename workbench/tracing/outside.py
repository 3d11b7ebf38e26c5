"""How much of an effect is seen from outside the loop: its multiplier by instruments.

In a closed loop noise becomes motion, and a least-squares fit takes the noise that came back for an effect: a declared inertia
moves by a per cent, a friction grows over speed. What the reference's motion predicts of an effect's contribution holds no noise.
With d the effect's contribution to the drive, d' what trees over the reference predict of it out of sample, and r the residual
before it was added,

    m = sum(r d') / sum(d d')

is 1 of an effect that is there and 0 of one that only noise in the loop made (two-stage least squares: Young 2011; Janot,
Gautier and Brunot 2019).
"""

from collections.abc import Sequence

import numpy as np

from workbench.inverse.balances import predicted
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.tracing.explainable import part
from workbench.tracing.foreseen import foreseen, numbered


def multiplier(before: Plant, after: Plant, inverses: Sequence[InverseDynamics]) -> tuple[float, float]:
    """Return (m, its standard error over blocks) of what `after` has and `before` has not, on these records; (nan, inf) where no
    reference moves it."""
    left = [_residual(p, before) for p in inverses]
    parts = [part(p, r, before.geometry.gear_ratio) for p, r in zip(inverses, left, strict=True)]
    r = np.concatenate(left)
    d = r - np.concatenate([_residual(p, after) for p in inverses])
    told = foreseen(parts, d, np.ones(d.size, dtype=bool))
    known = np.isfinite(told)
    block = numbered(parts)
    count = int(block[-1]) + 1
    top = np.bincount(block[known], (r * told)[known], count)
    bottom = np.bincount(block[known], (d * told)[known], count)
    whole = float(bottom.sum())
    if whole <= 0.0:
        return float("nan"), float("inf")
    m = float(top.sum()) / whole
    spread = top - m * bottom
    return m, float(np.sqrt(count / max(count - 1, 1) * (spread @ spread))) / whole


def _residual(p: InverseDynamics, plant: Plant) -> np.ndarray:
    """Return the residual of the drive behind the filter, in the samples that count."""
    m = p.motion
    return m.filter(m.u - predicted(p, plant))[m.keep]
