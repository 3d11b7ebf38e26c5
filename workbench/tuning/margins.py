"""Gain and phase margins of the exact sampled loop, by python-control: a second opinion on what the program did."""

import numpy as np

from workbench.tuning import sampled


def margins(kp: np.ndarray, kd: np.ndarray, motion, clock: sampled.Clock) -> tuple[np.ndarray, np.ndarray]:
    """Return (gain margin, phase margin in rad), (n,) each: the smallest gain factor above 1 and the smallest lag that make a
    stable loop unstable, inf where there is none; motion as sampled.steps returns it."""
    import control

    theta = np.geomspace(1e-3, np.pi, 400)
    loops = sampled.law(kp, kd, theta, clock) * sampled.response(theta, motion, clock)
    gain, phase = np.full(kp.size, np.inf), np.full(kp.size, np.inf)
    for i, loop in enumerate(loops):
        gains, phases, *_ = control.stability_margins(control.frd(loop, theta, smooth=True), returnall=True)
        gain[i] = min((g for g in np.atleast_1d(gains) if g > 1.0), default=np.inf)
        phase[i] = np.radians(min((p for p in np.atleast_1d(phases) if p > 0.0), default=np.inf))
    return gain, phase
