"""What lay before a record: friction with memory starts in a state that no channel holds.

A campaign may state that its records start with relaxed friction (`initial_condition`). Where it states nothing, the state is
that after one displacement h from the relaxed one, h of each record: an operator of increments keeps of its past what its
last reversals left, and h is the largest of them. It is searched where the memory is long (a gap before the friction, a belt):

    h = argmin over [-SPAN r, SPAN r] of |F(u - R(q; h))|^2        r: the lengths of the operators with memory, summed

h is no parameter of the axis: it is found for validation records, too, as the zeros of two encoders are.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.inverse.balances import predicted
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import Motion
from workbench.plant import Plant

# Memory over a record's travel from which its start is searched. Presliding of bearings is below 1e-3: the first move erases
# it. Halved or doubled, no campaign here changes; a gap of a tenth of the travel leaves a third of a record in doubt.
LONG = 0.02
SPAN = 1.5  # beyond 1 nothing is remembered: both ends are on a border whatever the shape of the virgin curve
ROUNDS = 4  # of starts and parameters by turns: a length that was fitted to a wrong start is wrong itself
SETTLED = 0.98  # of the cost before a round, above which the next would be the same
COARSE, FINE = 13, 7  # values of h tried over the span, and then about the best


def begun(plant: Plant, inverses: Sequence[InverseDynamics]) -> tuple[InverseDynamics, ...] | None:
    """Return the inverse dynamics with the displacement before each record that a fitted plant asks for, or None where no start is open."""
    found = [_begun(plant, p) for p in inverses]
    if all(new is old for new, old in zip(found, inverses, strict=True)):
        return None
    return tuple(found)


def _begun(plant: Plant, p: InverseDynamics) -> InverseDynamics:
    reach = _memory(plant)
    m = p.motion
    if m.record.history is not None or reach < LONG * np.ptp(m.q[m.keep]):
        return p
    span = SPAN * reach
    tried = np.linspace(-span, span, COARSE)
    best = min(tried, key=lambda h: _left(plant, p, h))
    step = tried[1] - tried[0]
    best = min(best + np.linspace(-step, step, FINE), key=lambda h: _left(plant, p, h))
    return InverseDynamics(displaced(m, float(best)), counts=p.counts, times=p.times)


def _memory(plant: Plant) -> float:
    """Return the length (m or rad) over which forces on the motor's side remember where they turned."""
    lengths = [
        p.value
        for e in plant.effects
        if e.at in ("axis", "motor") and "dq" in e.reads and e.states
        for p in e.parameters.values()
        if p.scale == "stroke" and not p.fixed
    ]
    return float(sum(lengths))


def _left(plant: Plant, p: InverseDynamics, h: float) -> float:
    """Return the power that a plant leaves of the filtered drive where the record was begun by a displacement h."""
    moved = displaced(p.motion, h)
    residual = moved.filter(moved.u - predicted(InverseDynamics(moved, times=p.times), plant))[moved.keep]
    return float(residual @ residual)


def displaced(motion: Motion, h: float) -> Motion:
    """Return a motion whose record was begun by a displacement h (m or rad) from the relaxed state."""
    dq = np.array(motion.dq)
    dq[0] += h
    return replace(motion, dq=dq, record=replace(motion.record, history=h))
