"""Limit cycles with further harmonics: what the first alone misses where the command meets the drive's limit.

With a command that is nearly a square wave the velocity is nearly a triangle, whose slope at the target, and so the power
that a delay feeds in, is larger by up to pi^2/8 than that of its first harmonic. So odd harmonics up to the nineteenth are
balanced, time and frequency in turn: y = sum Re Q_k exp(i k f) gives the command's waveform, whose harmonics U_k give

    Q_k = P0(k theta) U_k - G(k w) F_k

with P0 the sampled response and G = 1/(-J w^2 + i b w) the continuous one of the bare mass. F is the friction along that very
motion: of each place between its turning points that which a settled sine of the same amplitude has there.

A cycle is stable where a larger amplitude decays: with D(A, w) what the first harmonic leaves while the others follow, and
s = sigma + i w, Re ds/dA = Im(D_A / D_w) < 0 (Loeb's criterion).
"""

from dataclasses import dataclass

import numpy as np

from workbench.limit_cycle.axis import Axis
from workbench.limit_cycle.describing import Command
from workbench.limit_cycle.waves import along, harmonics_of, turning
from workbench.tuning import sampled

ORDERS = np.arange(1, 20, 2)
NYQUIST = 0.9 * np.pi  # rad a sample, up to which a harmonic is balanced
PHASES = 192  # of a cycle, of the command: where a stable and an unstable cycle meet, a thousandth of a gain decides
SPANS = 64  # of half a cycle, over which friction is averaged
CLOSE = 1e-6  # of the first harmonic: what a balance may leave
KINK, NEAR = 2e-3, 1e-2  # what it may leave where an integral stops, and how far the root may be there, of any unknown
WITHIN = 5.0  # of the first harmonic's amplitude: further away it is another cycle
BESIDE = (
    0.0,
    0.05,
    -0.05,
    0.15,
    -0.15,
)  # of the logarithm of the amplitude: where a loop meets no limit its slope is none
FINEST = 1.0 / 32.0  # step from the first harmonic alone to all
NEWTON, HALVED = 25, 6
STRIDE = 0.5  # of any unknown in one step of Newton
SLIGHT = (
    1e-3,
    5e-3,
    2e-2,
)  # differences in the unknowns, for slopes: over the steps that an integral makes where it stops


@dataclass(frozen=True)
class Cycle:
    """amplitude: zero to peak, rad or m. omega: rad/s. stable: whether motion comes to it. third: harmonic over the first.
    speed: its largest."""

    amplitude: float
    omega: float
    stable: bool
    third: float
    speed: float


@dataclass(frozen=True, eq=False)
class Harmonics:
    """The balance of a loop near a cycle of the first harmonic alone: amplitude, rad or m, and omega, rad/s.

    Unknowns x (..., 2 n): logarithms of amplitude and frequency over those, real and imaginary parts of the shares Q_k/Q_1.
    slight: difference in them over which slopes are taken.
    """

    axis: Axis
    law: Command
    amplitude: float
    omega: float
    orders: np.ndarray
    slight: float

    def motion(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (Q (..., n), w (...))."""
        n = self.orders.size
        share = np.concatenate([np.ones((*x.shape[:-1], 1)), x[..., 2 : 1 + n] + 1j * x[..., 1 + n :]], axis=-1)
        return self.amplitude * np.exp(x[..., :1]) * share, self.omega * np.exp(x[..., 1])

    def left(self, x: np.ndarray, weight: float) -> np.ndarray:
        """Return what the balance leaves of each harmonic, over the first, (..., 2 n). weight: of all but the first, 0 to 1."""
        q, w = self.motion(x)
        axis, orders, dt = self.axis, self.orders, self.axis.loop.sample_time
        theta = orders * (w * dt)[..., None]
        u = self.law(q, q * sampled.difference(theta, axis.clock) / dt, orders, w * dt, PHASES)
        bare = sampled.steps(np.zeros(1), np.array([axis.viscous * dt / axis.mass]), axis.clock)
        driven = sampled.response(theta, bare, axis.clock).reshape(theta.shape) * dt * dt / axis.mass
        swing = theta / dt
        held = 1.0 / (-axis.mass * swing**2 + 1j * axis.viscous * swing)
        size = np.abs(q[..., :1])
        made = (driven * u - held * _friction_along(axis, q, orders, w)) / size
        r = q / size - np.where(orders == 1, 1.0, weight) * made
        return np.concatenate([r.real, r.imag], axis=-1)

    def slopes(self, x: np.ndarray, weight: float) -> np.ndarray:
        """Return the Jacobian (2 n, 2 n) at x (2 n,)."""
        steps = self.slight * np.eye(x.size)
        both = self.left(np.concatenate([x + steps, x - steps]), weight)
        return (both[: x.size] - both[x.size :]).T / (2.0 * self.slight)

    def solved(self, x: np.ndarray, weight: float) -> np.ndarray | None:
        """Return the root near x, by Newton's steps, halved where they do not help; None where there is none."""
        left = self.left(x, weight)
        for _ in range(NEWTON):
            size = np.abs(left).max()
            if not np.isfinite(size) or size < CLOSE:
                break
            try:
                step = np.linalg.solve(self.slopes(x, weight), -left)
            except np.linalg.LinAlgError:
                return None
            step *= min(1.0, STRIDE / max(np.abs(step).max(), 1e-300))
            tries = x + step * 0.5 ** np.arange(HALVED)[:, None]
            found = self.left(tries, weight)
            sizes = np.abs(found).max(axis=-1)
            if not (
                sizes < size
            ).any():  # at a kink, or where there is no root: then the slopes are singular and steps long
                return x if size < KINK and np.abs(step).max() < NEAR else None
            best = int(np.argmax(sizes < size))
            x, left = tries[best], found[best]
        return x if np.abs(left).max() < CLOSE and abs(x[0]) < np.log(WITHIN) else None


def refined(axis: Axis, law: Command, amplitude: float, omega: float, *, root: bool = True) -> Cycle | None:
    """Return the cycle with further harmonics that a cycle of the first alone becomes, or None where they take it away.

    Where all harmonics at once lead nowhere, it is begun from beside, and then they are given weight little by little. root:
    whether there is a cycle of the first alone; where there is none, one search has to do.
    """
    orders = ORDERS[ORDERS * omega * axis.loop.sample_time < NYQUIST]
    each = [Harmonics(axis, law, amplitude, omega, orders, slight) for slight in (SLIGHT if root else SLIGHT[:1])]
    start = np.zeros(2 * orders.size)
    higher = (np.arange(start.size) == 0).astype(float)
    with np.errstate(all="ignore"):
        tried = (
            (at, at.solved(start + beside * higher, 1.0)) for at in each for beside in (BESIDE if root else BESIDE[:1])
        )
        at, x = next(((at, x) for at, x in tried if x is not None), (each[0], None))
        x = _followed(at, start) if x is None and root else x
        if x is None:
            return None
        q, w = at.motion(x)
        stable = _stable(at.slopes(x, 1.0))
    _, top = turning(q, orders)
    third = float(abs(q[1] / q[0])) if orders.size > 1 else 0.0
    speed = float(np.abs(along(1j * orders * w * q, orders, np.zeros(()), np.pi / SPANS, SPANS)).max())
    return Cycle(float(top), float(w), stable, third, speed)


def _followed(at: Harmonics, x: np.ndarray) -> np.ndarray | None:
    """Return the root that the first harmonic's becomes as the others gain weight; None where it ends on the way."""
    weight, step = 0.0, 0.25
    here = at.solved(x, 0.0)
    while here is not None and weight < 1.0:
        onward = at.solved(here, min(weight + step, 1.0))
        if onward is not None:
            here, weight = onward, min(weight + step, 1.0)
        elif step > FINEST:
            step /= 2.0
        else:
            return None
    return here


def _friction_along(axis: Axis, q: np.ndarray, orders: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Return the harmonics (..., n) of the friction along a motion of harmonics q (..., n) at omega (...)."""
    turn, top = turning(q, orders)
    width = np.pi / SPANS
    place = np.arccos(np.clip(along(q, orders, turn, width, SPANS + 1) / top[..., None], -1.0, 1.0))
    force = axis.force(top, omega, place)
    return harmonics_of((force[..., 1:] + force[..., :-1]) / 2.0, turn + width / 2.0, orders, width)


def _stable(slopes: np.ndarray) -> bool:
    """Whether motion comes to a cycle, by Loeb's criterion on what the first harmonic leaves while the others follow."""
    n = len(slopes) // 2
    first, others = [0, n], [k for k in range(2 * n) if k not in (0, n)]  # rows: real and imaginary part of the first
    own = slopes[np.ix_(first, [0, 1])]
    if others:
        own = own - slopes[np.ix_(first, range(2, 2 * n))] @ np.linalg.solve(
            slopes[np.ix_(others, range(2, 2 * n))], slopes[np.ix_(others, [0, 1])]
        )
    over_amplitude, over_omega = own[0] + 1j * own[1]
    return bool((over_amplitude / over_omega).imag < 0.0)
