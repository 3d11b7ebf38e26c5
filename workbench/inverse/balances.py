"""What a plant asks for along a motion: the sums of its forces, and the drive that they take."""

import numpy as np

from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant


def balances(inverse: InverseDynamics, plant: Plant) -> np.ndarray:
    """Return the sum of all forces at their values, on the motion, (rows, n): the required drive, and the load's residual."""
    total = np.zeros((inverse.rows(plant), inverse.motion.u.size))
    for e, name, column in inverse.columns(plant):
        total += (e.parameters[name].value if name else 1.0) * column
    added = inverse.payload(plant)
    return total if added is None else total + inverse.closed(plant, added, added)


def required(inverse: InverseDynamics, plant: Plant) -> np.ndarray:
    """Return the required drive u' (n,): every force of the plant at its values, on the motion.

    With two masses it is the motor's balance, the joint's torque by its law at the measured deflection.
    """
    return balances(inverse, plant)[0]


def predicted(inverse: InverseDynamics, plant: Plant) -> np.ndarray:
    """Return the drive u (n,) that the plant asks for, given the motion: command maps undone from the required drive."""
    return inverse.command.undone(plant, required(inverse, plant))
