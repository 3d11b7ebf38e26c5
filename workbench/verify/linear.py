"""The sampled loop linearised, with one mass: what any law's sensitivity is, in gross sliding and at each amplitude."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from workbench.describe import Equivalent
from workbench.simulate import Loop
from workbench.tune import sampled
from workbench.tune.sampled import Clock

LOWEST = 1e-3  # rad a sample: sensitivities are looked for from here to the Nyquist frequency
GRID = 160
CHECKED = 10  # knots of a schedule at which a search asks for the sensitivity; all of them are checked at the end


def peak_of(loop: np.ndarray, integrators: int) -> np.ndarray:
    """Return Ms (...,) of open loops L (..., f) over frequencies up to the Nyquist frequency; infinite where unstable.

    Beyond the border of stability |S| may be small again, so the Nyquist criterion is asked too. With no pole outside the unit
    circle and m integrators the phase of 1 + L, zero at the Nyquist frequency, has to come to -m pi/2 towards frequency
    zero; each encirclement of -1 puts it 2 pi off.
    """
    difference = 1.0 + loop
    back = np.unwrap(np.angle(difference[..., ::-1]), axis=-1)
    stable = (difference[..., -1].real > 0.0) & (np.abs(back[..., -1] + integrators * np.pi / 2.0) < np.pi)
    return np.where(stable, np.max(1.0 / np.abs(difference), axis=-1), np.inf)


@dataclass(frozen=True, eq=False)
class Linear:
    """Linearisations of an axis: inertia (kg*m^2 or kg) with springs (n,) to ground, in the sampled loop.

    equivalent: of all friction over amplitude, where laws with a schedule are to be judged. Its loss is left out: it damps.
    """

    loop: Loop
    inertia: float
    viscous: float
    stiffnesses: np.ndarray
    equivalent: Equivalent | None = None

    @property
    def clock(self) -> Clock:
        return Clock.of(self.loop)

    @cached_property
    def theta(self) -> np.ndarray:
        """Frequencies (f,), rad a sample."""
        return np.geomspace(LOWEST, np.pi, GRID)

    @cached_property
    def rate(self) -> np.ndarray:
        """Response (f,) of the filtered difference, per second."""
        return sampled.difference(self.theta, self.clock) / self.loop.sample_time

    def responses(self, springs: np.ndarray) -> np.ndarray:
        """Return the responses (n, f) from torque to position, with the zero-order hold and the delay."""
        unit = self.loop.sample_time**2 / self.inertia
        damping = np.full(springs.size, self.viscous * self.loop.sample_time / self.inertia)
        motion = sampled.steps(springs * unit, damping, self.clock)
        return sampled.response(self.theta, motion, self.clock) * unit

    @cached_property
    def plant(self) -> np.ndarray:
        """Responses (n, f) at `stiffnesses`."""
        return self.responses(self.stiffnesses)

    def peak(self, law: Callable[[np.ndarray, np.ndarray], np.ndarray], integrators: int = 0) -> np.ndarray:
        """Return Ms (points,) of laws C(theta, filtered difference per second) (points, f), the largest over the springs;
        infinite for an unstable loop. integrators: of the law."""
        c = law(self.theta, self.rate)
        own = np.where(self.stiffnesses > 0.0, 0, 1 if self.viscous > 0.0 else 2)
        return np.max([peak_of(c * p, n + integrators) for p, n in zip(self.plant, own, strict=True)], axis=0)

    def spring_at(self, amplitude: np.ndarray) -> np.ndarray:
        """Return the equivalent stiffness at amplitudes (n,), between those described on a line over log amplitude."""
        known = self.equivalent
        return np.interp(np.log(amplitude), np.log(known.amplitude), known.stiffness)

    def scheduled_peak(self, knots: np.ndarray, kp: np.ndarray, kd: np.ndarray) -> np.ndarray:
        """Return Ms (points,) of schedules kp, kd (points, n) over knots (n,): at CHECKED of them, the gains there with
        the spring of that amplitude and with none, as when the axis still slides."""
        pick = np.unique(np.linspace(0, knots.size - 1, CHECKED).round().astype(int))
        springs = self.spring_at(knots[pick])
        c = kp[:, pick, None] + kd[:, pick, None] * self.rate
        sliding, sticking = self.responses(np.zeros(1)), self.responses(springs)
        free = 1 if self.viscous > 0.0 else 2
        return np.maximum(peak_of(c * sliding, free).max(axis=1), peak_of(c * sticking, 0).max(axis=1))
