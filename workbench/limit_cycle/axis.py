"""An axis as limit cycles see it: a mass in the sampled loop, and the equivalents of its friction over amplitude and frequency."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workbench.errors import WorkbenchError
from workbench.plant import ONE_MASS, Plant
from workbench.simulate import Loop
from workbench.tune import sampled
from workbench.tune.sampled import Clock
from workbench.verify.equivalent import equivalent_of, friction_of

COUNTS = 10.0  # encoder counts at which amplitudes of interest begin: smaller cycles are shaped by the encoder
COARSE = (24, 6)  # amplitudes and frequencies at which friction that depends on speed is stepped
SLOWEST, FASTEST = 1.0, 1e4  # rad/s, between which it is


@dataclass(frozen=True, eq=False)
class Axis:
    """mass: kg*m^2 or kg. viscous: N*m*s/rad or N*s/m. limit: of the drive. speed: of the axis.

    equivalents(A, w) -> (k_e, c_e w) of all other friction, broadcast.
    """

    loop: Loop
    mass: float
    viscous: float
    limit: float
    speed: float
    equivalents: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]

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
    read = _equivalents(rest, largest, loop.count, friction)
    return Axis(loop, inertia * mass, friction * viscous, plant.limits.drive, plant.limits.speed, read)


def _equivalents(rest: Plant, largest: float, counts: float, factor: float):
    """Return (A, w) -> (k_e, c_e w), interpolated in the logarithms between cycles that are stepped."""
    from scipy.interpolate import RegularGridInterpolator

    if not rest.effects:
        return lambda a, w: tuple(np.zeros(np.broadcast_shapes(np.shape(a), np.shape(w))) for _ in range(2))
    still = all("rate independent" in e.holds for e in rest.effects)
    a = np.geomspace(0.5 * COUNTS * (counts or largest / 1e6), 2.0 * largest, (2 if still else 1) * COARSE[0])
    w = np.geomspace(SLOWEST, FASTEST, 2 if still else COARSE[1])
    each = [equivalent_of(rest, a, np.full(a.size, x), counts or 1e-12) for x in (w[:1] if still else w)]
    each = each * 2 if still else each
    grid = np.log(a), np.log(w)
    readers = [
        RegularGridInterpolator(
            grid, np.stack([getattr(e, n) for e in each], axis=1), bounds_error=False, fill_value=None
        )
        for n in ("stiffness", "loss")
    ]

    def at(amplitude, omega):
        points = np.stack(np.broadcast_arrays(np.log(amplitude), np.log(omega)), axis=-1)
        return tuple(factor * np.maximum(read(points), 0.0) for read in readers)

    return at
