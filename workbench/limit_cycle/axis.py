"""An axis as limit cycles see it: a mass in the sampled loop, and the equivalents of its friction over amplitude and frequency."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workbench.description.friction import cycles_of, equivalent_from, friction_of
from workbench.errors import WorkbenchError
from workbench.plant import ONE_MASS, Plant
from workbench.simulation import Loop
from workbench.tuning import sampled
from workbench.tuning.sampled import Clock

COUNTS = 10.0  # encoder counts at which amplitudes of interest begin: smaller cycles are shaped by the encoder
HALF = 129  # phases from a turning point to the next, of a cycle's friction
COARSE = (24, 6)  # amplitudes and frequencies at which friction that depends on speed is stepped
SLOWEST, FASTEST = 1.0, 1e4  # rad/s, between which it is


@dataclass(frozen=True, eq=False)
class Axis:
    """mass: kg*m^2 or kg. viscous: N*m*s/rad or N*s/m. limit: of the drive. speed: of the axis.

    equivalents(A, w) -> (k_e, c_e w) of all other friction, broadcast. force(A, w, f (..., n)) -> it (..., n), N*m or N, at phases 0
    to pi after a turning point of A cos f: where a motion of another shape is at the same place, its friction is the same.
    """

    loop: Loop
    mass: float
    viscous: float
    limit: float
    speed: float
    equivalents: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
    force: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]

    @property
    def clock(self) -> Clock:
        return Clock.of(self.loop)

    def response(self, theta: np.ndarray, stiffness: np.ndarray, loss: np.ndarray) -> np.ndarray:
        """Return P at theta = w Ts, from the command to the position with hold and delay; all broadcast to one shape."""
        theta, stiffness, loss = np.broadcast_arrays(theta, stiffness, loss)
        dt = self.loop.sample_time
        unit = dt * dt / self.mass
        damping = (self.viscous + loss * dt / theta) * dt / self.mass
        motion = sampled.steps((stiffness * unit).ravel(), damping.ravel(), self.clock)
        return sampled.response(theta.ravel()[:, None], motion, self.clock).reshape(theta.shape) * unit


def axis_of(plant: Plant, loop: Loop, largest: float, *, inertia: float = 1.0, friction: float = 1.0) -> Axis:
    """Return an axis of one mass, for amplitudes up to `largest`, rad or m. inertia, friction: factors as in Scenario.

    Effects of position alone (cogging, gravity) are stepped with the friction as forces about zero. Raises WorkbenchError for
    two masses, and a drive without limit, under which a loop that hunts may grow for ever.
    """
    if plant.kind != ONE_MASS:
        raise WorkbenchError("limit cycles are predicted for an axis of one mass; this one has two.")
    if not np.isfinite(plant.limits.drive):
        raise WorkbenchError("limit cycles need the drive's limit; state it in the campaign (limits).")
    rest, mass, viscous = friction_of(plant)
    found = Cycles.of(rest, largest, loop.count or largest / 1e6)
    return Axis(
        loop, inertia * mass, friction * viscous, plant.limits.drive, plant.limits.speed,
        lambda a, w: tuple(friction * v for v in found.equivalents(a, w)), lambda a, w, f: friction * found.force(a, w, f),
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Cycles:
    """Settled cycles of a plant's friction, read between those that are stepped, straight over log A and log w.

    parts: (stiffness, loss, forces over HALF phases from a turning point to the next), interpolators; none without friction.
    """

    parts: tuple

    @classmethod
    def of(cls, rest: Plant, largest: float, counts: float) -> "Cycles":
        """Return the cycles of amplitudes from half of COUNTS encoder counts to twice the largest."""
        from scipy.interpolate import RegularGridInterpolator

        if not rest.effects:
            return cls(())
        still = all("rate independent" in e.holds for e in rest.effects)
        a = np.geomspace(0.5 * COUNTS * counts, 2.0 * largest, (2 if still else 1) * COARSE[0])
        w = np.geomspace(SLOWEST, FASTEST, 2 if still else COARSE[1])
        each = [_settled(rest, a, np.full(a.size, x), counts) for x in (w[:1] if still else w)]
        each = each * 2 if still else each
        values = [np.stack([one[k] for one in each], axis=1) for k in range(3)]
        return cls(
            tuple(
                RegularGridInterpolator((np.log(a), np.log(w)), v, bounds_error=False, fill_value=None) for v in values
            )
        )

    def equivalents(self, amplitude, omega) -> tuple[np.ndarray, np.ndarray]:
        """Return (k_e, c_e w), broadcast."""
        if not self.parts:
            zero = np.zeros(np.broadcast_shapes(np.shape(amplitude), np.shape(omega)))
            return zero, zero
        points = np.stack(np.broadcast_arrays(np.log(amplitude), np.log(omega)), axis=-1)
        stiffness, loss = (np.maximum(read(points), 0.0) for read in self.parts[:2])
        return stiffness, loss

    def force(self, amplitude: np.ndarray, omega: np.ndarray, phase: np.ndarray) -> np.ndarray:
        """Return the friction (..., n) of cycles (...) at phases (..., n) from 0 to pi after a turning point."""
        if not self.parts:
            return np.zeros(phase.shape)
        points = np.stack(np.broadcast_arrays(np.log(amplitude), np.log(omega)), axis=-1)
        known = self.parts[2](points).reshape(*points.shape[:-1], HALF)
        at = np.nan_to_num(phase / np.pi * (HALF - 1))
        before = np.minimum(at.astype(int), HALF - 2)
        low, high = (np.take_along_axis(known, before + k, axis=-1) for k in (0, 1))
        return low + (at - before) * (high - low)


def _settled(rest: Plant, a: np.ndarray, w: np.ndarray, counts: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (k_e (n,), c_e w (n,), forces (n, HALF)) of settled cycles of amplitudes a (n,) at w (n,)."""
    force = cycles_of(rest, a, w, counts)
    known = equivalent_from(a, force)
    half = force[:, : force.shape[1] // 2 + 1]
    picked = np.linspace(0, half.shape[1] - 1, HALF).astype(int)
    return known.stiffness, known.loss, half[:, picked]
