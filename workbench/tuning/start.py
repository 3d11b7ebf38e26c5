"""Where the program starts: on the overshoot limit, as stiff as drive, speed and sensitivity allow, by bisection.

At most amplitudes that is the optimum already; the program then finds what may be traded along the sensitivity limit.
"""

import numpy as np

from workbench.tuning import response, sampled
from workbench.tuning.axis import Axis
from workbench.tuning.goal import TuningGoal

FLOOR = 1e-9  # of the largest gain that stability and drive allow: gains this small do nothing
GRID = np.geomspace(0.01, np.pi * (1.0 - 1e-6), 320)


def _plant(axis: Axis, kp: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the responses of command to position and to filtered velocity over GRID, (n, f), damped as kp goes."""
    position = sampled.response(GRID, axis.steps(kp), axis.clock)
    return position, position * sampled.difference(GRID, axis.clock)


def stable_box(axis: Axis) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest (kp, kd) that a stable loop can have, (n,) each.

    1 + L = 0 is linear in (kp, kd), so each frequency gives one point of the border of stability (D-partition, Neimark
    1949); from low frequencies on, it encloses the stable gains until one of them falls to zero.
    """
    position, speed = _plant(axis, np.zeros(axis.amplitude.size))
    both = position.real * speed.imag - position.imag * speed.real
    kp, kd = -speed.imag / both, position.imag / both
    past = np.maximum.accumulate((kp > 0.0) & (kd > 0.0), axis=1)  # the stiffness alone may hold kp below zero at first
    inside = past & ~np.maximum.accumulate(past & ((kp <= 0.0) | (kd <= 0.0)), axis=1)
    return 1.1 * np.where(inside, kp, FLOOR).max(axis=1), 1.1 * np.where(inside, kd, FLOOR).max(axis=1)


def _quadratics(position: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Return (n, f, 5): |1 + L|^2 - 1 = [kp, kd, kp^2, kd^2, kp kd] . row, L = kp position + kd speed."""
    cross = 2.0 * (position * speed.conj()).real
    return np.stack([2.0 * position.real, 2.0 * speed.real, np.abs(position) ** 2, np.abs(speed) ** 2, cross], axis=-1)


def softest(axis: Axis, box: tuple[np.ndarray, np.ndarray], drive: np.ndarray) -> np.ndarray:
    """Return the smallest kp that is considered, (n,); drive (n,): the largest that the drive allows."""
    return np.maximum(FLOOR * np.minimum(box[0], drive), 0.1 * FLOOR * axis.stiffness)


def damped(axis: Axis, kp: np.ndarray, zeta: float) -> np.ndarray:
    """Return the kd that gives a damping ratio, or 0 where the axis alone has more."""
    return np.maximum(2.0 * zeta * axis.omega(kp) - axis.passive(kp), 0.0)


def _admissible(axis: Axis, rows: np.ndarray, kp: np.ndarray, kd: np.ndarray, goal: TuningGoal) -> np.ndarray:
    """Return where speed and sensitivity hold, (n,); rows as `_quadratics` returns them, over GRID."""
    omega = axis.omega(kp)
    speed = axis.amplitude * kp / omega * response.speed_ratio(axis.zeta(kp, kd)) / axis.clock.sample_time
    gains = np.stack([kp, kd, kp**2, kd**2, kp * kd], axis=-1)
    least = 1.0 + (rows @ gains[:, :, None])[:, :, 0].min(axis=1)
    return (speed <= goal.speed) & (least >= goal.sensitivity**-2.0)


def start(
    axis: Axis, goal: TuningGoal, box: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (kp, kd, possible), (n,) each; possible is False where not even kp near 0 keeps the limits.

    The limits are followed from small kp up to where the first is met, so that gains beyond the border of stability, where
    |S| may be small again, are not taken.
    """
    zeta = response.damping_for(goal.allowed)
    drive = goal.drive / axis.amplitude / axis.unit_kp
    most, least = np.log(np.minimum(box[0], drive)), np.log(softest(axis, box, drive))
    kp = np.exp(most)
    for _ in range(2):  # the loss damps as c_e = loss/w_n, and w_n is known once kp is
        rows = _quadratics(*_plant(axis, kp))

        def fine(level, rows=rows):
            return _admissible(axis, rows, np.exp(level), damped(axis, np.exp(level), zeta), goal)

        low = least
        calm = damped(axis, np.exp(low), zeta)
        stable = sampled.spectral_radius(np.exp(low), calm, axis.steps(kp), axis.clock) < 1.0
        possible, climbing = fine(low) & stable, np.ones(kp.size, dtype=bool)
        high = most
        for step in (0.5, 0.7, 0.8, *np.linspace(0.84, 1.0, 16)):
            level = least + step * (most - least)
            ok = climbing & fine(level)
            low = np.where(ok, level, low)
            high = np.where(climbing & ~ok, level, high)
            climbing = ok
        for _ in range(16):
            middle = (low + high) / 2.0
            ok = fine(middle)
            low, high = np.where(ok, middle, low), np.where(ok, high, middle)
        kp = np.exp(low)
    return kp, damped(axis, kp, zeta), possible
