"""Where the motor of two masses has to be for the load to follow a reference: the joint's law undone along the motion.

The load's balance asks for a torque; the deflection that gives it is found by Newton's steps along the whole record, each
with the joint's own slope there, since hysteresis, lost motion and geometry leave no law to invert, and with the joint's
damping, without which the steps grow where the motion is fast.
"""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np

from workbench.inverse.balances import balances
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant

STEPS = 12
CLOSE = 1e-3  # of the load's torque, rms, that may be left
FASTER = 0.7  # of what was left: a step that leaves more than this of it brings nothing, and the second such step is the last
OPEN = 0.1  # of the load's torque, rms: where more is left, no deflection balances it
NUDGE = 2.0  # counts by which the deflection is moved for its slope
WIDER = 4.0  # by which a nudge grows that meets no resistance: it has to pass the gap that it is in
WIDEST = 6  # times that it grows: what does not resist within two thousand counts is no joint
LEAST = 0.3  # of the median slope: inside lost motion there is none
SHAKEN = 0.1  # of the evaluation bandwidth: the frequency at which the deflection is moved for its damping


def _without_motor(plant: Plant) -> Plant:
    """Return the plant without what acts on the motor or the command: the load's balance is the same."""
    return replace(plant, effects=tuple(e for e in plant.effects if e.at not in ("motor", "command")))


def deflection(plant: Plant, make: Callable[[np.ndarray], InverseDynamics], count: float, samples: int) -> np.ndarray:
    """Return the deflection (n,) with which the load's forces balance. make(deflection) -> the inverse dynamics over that motion.

    count: of the encoders, rad or m. The deflection is as smooth as the evaluation filter makes it; it is NaN where the joint
    does not resist, so that no deflection balances.
    """
    rest, nowhere = _without_motor(plant), np.full(samples, np.nan)
    motion = make(np.zeros(samples)).motion

    def missing_at(x: np.ndarray) -> np.ndarray:
        """Return what the load's balance lacks (n,)."""
        return motion.filter(balances(make(x), rest)[1])

    sizes: list[float] = []
    x = best = np.zeros(samples)
    damping: float | None = None
    while len(sizes) < STEPS:
        missing = missing_at(x)
        sizes.append(float(np.sqrt(np.mean(missing**2))))
        if sizes[-1] == min(sizes):
            best = x
        if sizes[-1] <= CLOSE * sizes[0] or _stalled(sizes):
            break
        slope, nudge = _slope(lambda by, at=x, here=missing: (here - missing_at(at + by)) / by, NUDGE * count)
        if slope is None:
            return nowhere
        if damping is None:
            shaken = 2 * np.pi * SHAKEN * motion.filter.bandwidth
            wave, rate = nudge * np.sin(shaken * motion.t), nudge * shaken * np.cos(shaken * motion.t)
            felt = missing - missing_at(x + wave) - slope * wave
            damping = max(float(felt @ rate / (rate @ rate)), 0.0)
        x = motion.filter(x + _moved(missing, slope, damping / motion.dt))
    return best - best[0] if min(sizes) <= OPEN * sizes[0] else nowhere


def _stalled(sizes: list[float]) -> bool:
    """Whether the last step brought nothing, of those that balance, or the last two: the first may go too far, and the next come back."""
    steps = [b > FASTER * a for a, b in pairwise(sizes)]
    return steps[-1:] == [True] and (sizes[-1] <= OPEN * sizes[0] or steps[-2:] == [True, True])


def _slope(over: Callable[[float], np.ndarray], nudge: float) -> tuple[np.ndarray | None, float]:
    """Return (the joint's slope (n,), the least nudge that half of the motion resists); the slope is over(nudge), or None."""
    for _ in range(WIDEST):
        slope = over(nudge)
        if (median := float(np.median(slope))) > 0.0:
            return np.maximum(slope, LEAST * median), nudge
        nudge *= WIDER
    return None, nudge


def _moved(missing: np.ndarray, slope: np.ndarray, damping: float) -> np.ndarray:
    """Return d with slope d_i + damping (d_i - d_{i-1}) = missing, (n,). damping: over the sample time."""
    if damping == 0.0:
        return missing / slope
    from scipy.linalg import solve_banded

    before = np.full(missing.size, -damping)
    return solve_banded((1, 0), np.stack([slope + damping, before]), missing)
