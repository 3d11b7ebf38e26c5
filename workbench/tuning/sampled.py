"""The exact sampled loop, in units of the sample: time Ts, torque J/Ts^2 per displacement.

Plant: y'' + damping y' + stiffness y = u behind a zero-order hold and a delay, which need not be whole samples.
Controller: u = -N (kp y + kd vh), vh <- vh + alpha (y - y_before - vh), N a notch or 1. Arrays over amplitudes come first.
"""

from dataclasses import dataclass

import numpy as np

from workbench.control.notched import behind
from workbench.threads import one_thread


@dataclass(frozen=True)
class Clock:
    """What the loop does to a signal. whole, part: the delay, samples. alpha: weight of the velocity filter. notch: (b0, b1,
    b2, a2) of one behind the law (`control.notched`), or none."""

    sample_time: float
    whole: int
    part: float
    alpha: float
    notch: tuple[float, float, float, float] | None = None

    @classmethod
    def of(cls, loop) -> "Clock":
        """Return the clock of a loop with sample_time, delay and velocity_filter, s."""
        samples = loop.delay / loop.sample_time
        whole = int(np.floor(samples + 1e-9))
        part = samples - whole
        filtered = -np.expm1(-loop.sample_time / loop.velocity_filter) if loop.velocity_filter > 0.0 else 1.0
        return cls(loop.sample_time, whole, part if part > 1e-9 else 0.0, float(filtered))


@one_thread  # of many small matrices: on a busy machine threads that wait for one another take a hundred times as long
def hold(stiffness: np.ndarray, damping: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
    """Return (Phi (n, 2, 2), Gamma (n, 2)): what state and a constant u make of [y, y'] after `time` samples (Van Loan 1978)."""
    from scipy.linalg import expm

    block = np.zeros((np.size(stiffness), 3, 3))
    block[:, 0, 1], block[:, 1, 0], block[:, 1, 1], block[:, 1, 2] = 1.0, -stiffness, -damping, 1.0
    out = expm(block * time)
    return out[:, :2, :2], out[:, :2, 2]


def steps(stiffness: np.ndarray, damping: np.ndarray, clock: Clock) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (Phi, early, late): x <- Phi x + early u[k - whole - 1] + late u[k - whole], exact."""
    late_phi, late = hold(stiffness, damping, 1.0 - clock.part)
    if clock.part == 0.0:
        return late_phi, np.zeros_like(late), late
    early_phi, early = hold(stiffness, damping, clock.part)
    return late_phi @ early_phi, np.einsum("nij,nj->ni", late_phi, early), late


def response(theta: np.ndarray, motion: tuple[np.ndarray, np.ndarray, np.ndarray], clock: Clock) -> np.ndarray:
    """Return the plant's frequency response at theta = w Ts, (n, f); theta (f,) or (n, f), motion as `steps` returns it."""
    phi, early, late = motion
    z = np.exp(1j * np.atleast_2d(theta))
    drive = late[:, :, None] + early[:, :, None] / z[:, None]
    top = (z - phi[:, 1, 1, None]) * drive[:, 0] + phi[:, 0, 1, None] * drive[:, 1]
    bottom = (z - phi[:, 0, 0, None]) * (z - phi[:, 1, 1, None]) - (phi[:, 0, 1] * phi[:, 1, 0])[:, None]
    return top / bottom / z**clock.whole


@one_thread
def forced(system: np.ndarray, theta: np.ndarray, clock: Clock) -> np.ndarray:
    """Return the responses (..., f, n) of the n states of x' = A x + b u to a held and delayed u at theta (f,), exact (Van Loan 1978).

    system (..., n + 1, n + 1): A and b over a row of zeros, in SI.
    """
    from scipy.linalg import expm

    n, time, part = system.shape[-1] - 1, clock.sample_time, clock.part
    late, early = expm(system * time * (1.0 - part)), expm(system * time * part)
    phi, z = late[..., :n, :n] @ early[..., :n, :n], np.exp(1j * theta)
    through = late[..., :n, :n] @ early[..., :n, n, None]
    drive = late[..., None, :n, n] + through[..., None, :, 0] / z[:, None]
    x = np.linalg.solve(z[:, None, None] * np.eye(n) - phi[..., None, :, :], drive[..., None])[..., 0]
    return x / z[:, None] ** clock.whole


def difference(theta: np.ndarray, clock: Clock) -> np.ndarray:
    """Return the frequency response of the filtered difference, y to vh, per sample."""
    back = np.exp(-1j * np.asarray(theta))
    return clock.alpha * (1.0 - back) / (1.0 - (1.0 - clock.alpha) * back)


def law(kp: np.ndarray, kd: np.ndarray, theta: np.ndarray, clock: Clock) -> np.ndarray:
    """Return the law's frequency response, y to -u, (n, f), with the notch behind it."""
    plain = kp[:, None] + kd[:, None] * difference(np.atleast_2d(theta), clock)
    return plain if clock.notch is None else plain * behind(clock.notch, np.atleast_2d(theta))


def closed(kp: np.ndarray, kd: np.ndarray, motion, clock: Clock) -> np.ndarray:
    """Return the closed loop's matrix, (n, s, s), over [y, y', y_before, vh, u one sample ago, two ago, ..., two states of a notch]."""
    phi, early, late = motion
    past, own = clock.whole + (clock.part > 0.0), 0 if clock.notch is None else 2
    size = 4 + past + own
    out = np.zeros((kp.size, size, size))
    filtered = np.zeros(size)
    filtered[[0, 2, 3]] = clock.alpha, -clock.alpha, 1.0 - clock.alpha
    command = -kd[:, None] * filtered
    command[:, 0] -= kp
    if own:
        (b0, b1, b2, a2), plain, state = clock.notch, command, np.eye(size)[-2:]
        command = b0 * plain + state[0]
        out[:, -2] = b1 * (plain - command) + state[1]
        out[:, -1] = b2 * plain - a2 * command
    out[:, :2, :2] = phi
    out[:, 2, 0] = 1.0
    out[:, 3] = filtered
    for age, gain in ((clock.whole, late), (clock.whole + 1, early)):
        if age == 0:
            out[:, :2] += gain[:, :, None] * command[:, None, :]
        elif age <= past:
            out[:, :2, 3 + age] += gain
    if past:
        out[:, 4] = command
        for age in range(1, past):
            out[:, 4 + age, 3 + age] = 1.0
    return out


def spectral_radius(kp: np.ndarray, kd: np.ndarray, motion, clock: Clock) -> np.ndarray:
    """Return the largest modulus of the closed loop's eigenvalues, (n,); the loop is stable below 1."""
    return np.abs(np.linalg.eigvals(closed(kp, kd, motion, clock))).max(axis=1)


def sensitivity(kp: np.ndarray, kd: np.ndarray, theta: np.ndarray, motion, clock: Clock) -> np.ndarray:
    """Return |S| = 1/|1 + L|, (n, f)."""
    return 1.0 / np.abs(1.0 + law(kp, kd, theta, clock) * response(theta, motion, clock))


def sensitivity_peak(kp, kd, motion, clock: Clock, lowest: float = 1e-3) -> tuple[np.ndarray, np.ndarray]:
    """Return (Ms, theta), (n,) each: the peak of |S| over lowest..pi, found between grid points by zooming in."""
    theta = np.broadcast_to(np.geomspace(lowest, np.pi, 240), (kp.size, 240))
    for _ in range(4):
        size = sensitivity(kp, kd, theta, motion, clock)
        i = size.argmax(axis=1)
        rows = np.arange(kp.size)
        left, right = theta[rows, np.maximum(i - 1, 0)], theta[rows, np.minimum(i + 1, theta.shape[1] - 1)]
        peak, where = size[rows, i], theta[rows, i]
        theta = left[:, None] + (right - left)[:, None] * np.linspace(0.0, 1.0, 13)
    return peak, where
