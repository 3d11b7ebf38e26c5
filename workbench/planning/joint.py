"""Where the motor of two masses has to be for the load to follow a reference: the joint's law undone along the motion.

The load's balance asks for a torque; the deflection that gives it is found by Newton's steps along the whole record, each
with the joint's own slope there, since hysteresis, lost motion and geometry leave no law to invert.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from workbench.inverse.balances import balances
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant

STEPS = 12
CLOSE = 1e-3  # of the load's torque, rms, that may be left
NUDGE = 2.0  # counts by which the deflection is moved for its slope
LEAST = 0.3  # of the median slope: inside lost motion there is none


def _without_motor(plant: Plant) -> Plant:
    """Return the plant without what acts on the motor or the command: the load's balance is the same."""
    return replace(plant, effects=tuple(e for e in plant.effects if e.at not in ("motor", "command")))


def deflection(plant: Plant, make: Callable[[np.ndarray], InverseDynamics], count: float, samples: int) -> np.ndarray:
    """Return the deflection (n,) with which the load's forces balance. make(deflection) -> the inverse dynamics over that motion.

    count: of the encoders, rad or m. The deflection is as smooth as the evaluation filter makes it; it is NaN where the joint
    does not resist, so that no deflection balances.
    """
    rest = _without_motor(plant)
    x = np.zeros(samples)
    whole = None
    for _ in range(STEPS):
        inverse = make(x)
        smooth = inverse.motion.filter
        missing = smooth(balances(inverse, rest)[1])
        size = float(np.sqrt(np.mean(missing**2)))
        whole = size if whole is None else whole
        if size <= CLOSE * whole:
            break
        nudge = NUDGE * count
        slope = (missing - smooth(balances(make(x + nudge), rest)[1])) / nudge
        median = float(np.median(slope))
        if not median > 0.0:
            return np.full(samples, np.nan)
        slope = np.maximum(slope, LEAST * median)
        x = smooth(x + missing / slope)
    return x - x[0]
