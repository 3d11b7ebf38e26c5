"""Limit cycles with further harmonics: what the first alone misses where the command meets the drive's limit.

With a command that is nearly a square wave the velocity is nearly a triangle, whose slope at the target, and so the power
that a delay feeds in, is larger by up to pi^2/8 than that of its first harmonic. So odd harmonics up to the ninth are
balanced, time and frequency in turn: y = sum Re Q_k exp(i k f) gives the command's waveform, whose harmonics U_k give

    Q_k = P0(k theta) U_k - G(k w) F_k

with P0 the sampled response and G = 1/(-J w^2 + i b w) the continuous one of the bare mass. Of friction the first harmonic
is taken: its spring, and the loss that its largest deflection has.
"""

from dataclasses import dataclass

import numpy as np

from workbench.limit_cycle.axis import Axis
from workbench.limit_cycle.describing import Command, harmonics_of
from workbench.tune import sampled

ORDERS = np.array([1, 3, 5, 7, 9])
PHASES = 128
CLOSE = 2e-3  # of the first harmonic: what a balance may leave, where an integral stops or a schedule has a step
WITHIN = 5.0  # of the first harmonic's amplitude: further away it is another cycle
ASTRAY = 1e6  # what is left where a step of the search has gone to infinity


@dataclass(frozen=True)
class Refined:
    """amplitude: zero to peak. omega: rad/s. third: harmonic over the first. speed: the largest."""

    amplitude: float
    omega: float
    third: float
    speed: float


def refined(axis: Axis, law: Command, amplitude: float, omega: float) -> Refined | None:
    """Return the cycle with further harmonics near one of the first alone, or None where none is found."""
    from scipy.optimize import root

    dt = axis.loop.sample_time
    orders = ORDERS[ORDERS * omega * dt < 0.9 * np.pi]
    wave = np.exp(1j * np.outer(orders, 2.0 * np.pi * np.arange(PHASES) / PHASES))
    steps = _bare(axis)

    def unpacked(x):
        share = np.concatenate([[1.0], x[2 : 1 + orders.size] + 1j * x[1 + orders.size :]])
        return amplitude * np.exp(x[0]) * share, omega * np.exp(x[1])

    def left(x):
        q, w = unpacked(x)
        theta = orders * w * dt
        y = (q @ wave).real
        vh = ((q * sampled.difference(theta, axis.clock) / dt) @ wave).real
        if not (np.isfinite(y).all() and np.isfinite(vh).all()):
            return np.full(2 * orders.size, ASTRAY)
        u = law(y, vh, np.full(1, w * dt))
        driven = sampled.response(theta[None, :], steps, axis.clock)[0] * dt * dt / axis.mass
        held = 1.0 / (-axis.mass * (orders * w) ** 2 + 1j * axis.viscous * orders * w)
        largest = np.abs(y).max()
        spring, loss = (float(np.ravel(v)[0]) for v in axis.equivalents(largest, w))
        friction = np.zeros(orders.size, dtype=complex)
        friction[0] = q[0] * (spring + 1j * loss * (largest / abs(q[0])) ** 2)
        r = (q - driven * harmonics_of(u, orders) + held * friction) / abs(q[0])
        return np.concatenate([r.real, r.imag])

    with np.errstate(all="ignore"):
        found = root(left, np.zeros(2 * orders.size), method="hybr", options={"maxfev": 300})
        good = np.abs(found.fun).max() < CLOSE and np.abs(found.x[0]) < np.log(WITHIN)
    if not good:
        return None
    q, w = unpacked(found.x)
    y, v = (q @ wave).real, ((1j * orders * w * q) @ wave).real
    third = float(abs(q[1] / q[0])) if orders.size > 1 else 0.0
    return Refined(float(np.abs(y).max()), float(w), third, float(np.abs(v).max()))


def _bare(axis: Axis):
    """The sampled motion of the mass without friction other than viscous, in units of the sample."""
    dt = axis.loop.sample_time
    return sampled.steps(np.zeros(1), np.array([axis.viscous * dt / axis.mass]), axis.clock)
