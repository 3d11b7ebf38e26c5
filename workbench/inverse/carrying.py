"""Whether a fit of two masses lets the joint carry anything.

The load's balance, 0 = inertia and friction there less the joint's torque, has a solution that is always right: no load, and a
joint without stiffness. Where what is wrong with the measured angle (a clock, a zero, counts) is more than what torque does to
it, a fit goes there. The drive's balance then is that of one rigid body, and nothing in either says what a joint lacks.
"""

from collections.abc import Sequence

import numpy as np

from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import TWO_MASS, Plant
from workbench.record import IDENTIFICATION

# Error of the load's balance, over the torque of the joint, from which the joint explains nothing of how the load moves. Fits
# that carry have 0.01 to 0.5, those that do not 0.98 and more: half of it would take a joint whose law is wrong for an idle one,
# twice of it nothing.
IDLE = 0.9


def load_errors(inverses: Sequence[InverseDynamics], plant: Plant) -> dict[str, float]:
    """Return role -> relative error of the load's balance, of two masses: a second error beside that of the drive.

    rms(F(what is left)) / rms(F(torque of the joint)), F the evaluation filter; the joint's torque is that of its law at the
    measured deflection. Records in which the load is locked have no such balance. Infinite where the joint has no torque.
    """
    power: dict[str, np.ndarray] = {}
    for p in sorted(inverses, key=lambda p: p.motion.record.name):
        if p.rows(plant) != 2:
            continue
        left, joint = np.zeros((2, p.motion.u.size))
        for e, name, column in p.columns(plant):
            force = (e.parameters[name].value if name else 1.0) * column[1]
            left, joint = left + force, joint + force * (e.at == "joint")
        squares = np.sum(p.motion.filter(np.stack([left, joint]))[:, p.motion.keep] ** 2, axis=1)
        role = p.motion.record.role
        power[role] = power.get(role, 0.0) + squares
    return {role: float(np.sqrt(x / whole)) for role, (x, whole) in power.items() if whole > 0.0}


def idle_error(inverses: Sequence[InverseDynamics], plant: Plant) -> float | None:
    """Return the error of the load's balance on the identification records where a fitted plant's joint carries nothing there.

    None where it carries. Infinite where its law has no torque. Then no cause is to be named from its balances.
    """
    free = [p for p in inverses if p.motion.record.role == IDENTIFICATION and not p.motion.record.locked]
    if plant.kind != TWO_MASS or not free or not any(e.at == "joint" for e in plant.effects):
        return None
    error = load_errors(free, plant).get(IDENTIFICATION, np.inf)
    return None if error < IDLE else error
