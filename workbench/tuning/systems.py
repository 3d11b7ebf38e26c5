"""Plant and law of one amplitude as python-control's objects: what its own tools, and whoever has them, may be asked of.

plant: x[k+1] = Phi x[k] + early u[k - whole - 1] + late u[k - whole], q = x_1, exact at the samples (Van Loan 1978)
law:   C(z) = kp + kd/Ts alpha (z - 1)/(z - 1 + alpha)
"""

import numpy as np

from workbench.tuning import sampled
from workbench.tuning.axis import Axis


def plant_system(axis: Axis, row: int, kp: float):
    """Return the sampled axis at one amplitude as control.StateSpace, from torque to position, SI. kp: SI, with which its loss is
    damping."""
    import control

    clock, unit = axis.clock, axis.unit_kp
    phi, early, late = (a[row] for a in axis.steps(np.full(axis.amplitude.size, kp / unit)))
    held = clock.whole + 1  # commands that have not acted yet, the latest first
    a, b = np.zeros((2 + held, 2 + held)), np.zeros((2 + held, 1))
    a[:2, :2] = phi
    a[:2, 2 + clock.whole] += early
    if clock.whole:
        a[:2, 1 + clock.whole] += late
    else:
        b[:2, 0] += late
    a[3:, 2:-1] = np.eye(held - 1)
    b[2, 0] = 1.0
    c = np.zeros((1, 2 + held))
    c[0, 0] = 1.0 / unit
    return control.StateSpace(a, b, c, 0.0, clock.sample_time)


def law_system(kp: float, kd: float, clock: sampled.Clock):
    """Return a PD with its velocity filter as control.TransferFunction, from position to torque, SI."""
    import control

    g, back = kd * clock.alpha / clock.sample_time, 1.0 - clock.alpha
    return control.TransferFunction([kp + g, -(kp * back + g)], [1.0, -back], clock.sample_time)
