"""Whether the order of a further wave is one that a mechanism has: orders of one are those of its shafts and teeth."""

from collections.abc import Sequence
from math import pi

import numpy as np

from workbench.definition import Effect
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant

# Orders of one mechanism are those of its shafts and teeth: two stand as small numbers. What lives in position without being
# periodic is dressed by waves whose orders do not. Halved, orders 5 and 6 of a shaft are strangers; doubled, nearly none are.
SMALL = 6
MEETS = 0.01  # relative error of a ratio of orders: their intervals are a few per mille


def stranger(wave: Effect, plant: Plant, inverses: Sequence[InverseDynamics]) -> bool:
    """Whether a wave of a plant stands to no other one of its name and place as small numbers, nor to a shaft of the axis, though there is
    another one. Of the axis' own turn, and of its motor's, where the travel holds a turn of the axis: else a window of it may be any order's."""
    others = [e for e in plant.effects if (e.name, e.at) == (wave.name, wave.at) and e.key != wave.key]
    name = next((n for n, p in wave.parameters.items() if p.scale == "order"), None)
    if name is None or not others:
        return False
    order = wave.parameters[name].value
    known = [e.parameters[name].value for e in others]
    travel = max(float(np.ptp(p.motion.q)) for p in inverses)
    if plant.rotary and travel >= 2.0 * pi:
        known += [1.0, plant.geometry.gear_ratio]
    ratios = [order / of for of in known if of > 0.0]
    small = [p / q for p in range(1, SMALL + 1) for q in range(1, SMALL + 1)]
    return bool(ratios) and not any(abs(r / s - 1.0) < MEETS for r in ratios for s in small)
