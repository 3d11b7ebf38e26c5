"""The sampled loop linearised: what any law's sensitivity is, in gross sliding and at each amplitude.

A law is given by two responses: what it does to the position that it reads, and what to the speed (of the same reading, or
of the motor's where there are two masses).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from workbench.description import Equivalent
from workbench.simulation import Loop
from workbench.tuning import sampled
from workbench.tuning.sampled import Clock

LOWEST = 1e-3  # rad a sample: sensitivities are looked for from here to the Nyquist frequency
GRID = 160
BELOW, FINE = 0.05, 170  # from here up, so many frequencies, where a resonance has to be seen
CHECKED = 8  # knots of a schedule at which a search asks for the sensitivity; all of them are checked at the end


def peak_of(loop: np.ndarray, integrators: int) -> np.ndarray:
    """Return Ms (...,) of open loops L (..., f) over frequencies up to the Nyquist frequency; infinite where unstable.

    Beyond the border of stability |S| may be small again, so the Nyquist criterion is asked too. With no pole outside the unit
    circle and m integrators the phase of 1 + L, zero at the Nyquist frequency, has to come to -m pi/2 towards frequency
    zero; each encirclement of -1 puts it 2 pi off.
    """
    difference = 1.0 + loop
    phase = np.angle(difference)
    jumps = np.diff(phase, axis=-1)  # over half a turn where the principal value wraps: then the phase itself goes on
    turns = np.count_nonzero(jumps < -np.pi, axis=-1) - np.count_nonzero(jumps > np.pi, axis=-1)
    towards_zero = phase[..., 0] - 2.0 * np.pi * turns
    stable = (difference[..., -1].real > 0.0) & (np.abs(towards_zero + integrators * np.pi / 2.0) < np.pi)
    with np.errstate(divide="ignore"):
        return np.where(stable, 1.0 / np.min(np.abs(difference), axis=-1), np.inf)


class Judge:
    """What linearisations of any axis share. loop: the sampled loop. position, speed (n, f): responses from torque to the position and to the one whose speed is read. own (n,):
    integrators of each."""

    loop: Loop

    @property
    def clock(self) -> Clock:
        """The loop's sampling and delay."""
        return Clock.of(self.loop)

    @cached_property
    def theta(self) -> np.ndarray:
        """Frequencies (f,), rad a sample: dense where a resonance has to be seen."""
        return np.concatenate([np.geomspace(LOWEST, BELOW, 40, endpoint=False), np.geomspace(BELOW, np.pi, FINE)])

    @cached_property
    def rate(self) -> np.ndarray:
        """Response (f,) of the filtered difference, per second."""
        return sampled.difference(self.theta, self.clock) / self.loop.sample_time

    def peak(
        self, position: np.ndarray, speed: np.ndarray, integrators: int = 0, velocity_filter: np.ndarray | None = None
    ) -> np.ndarray:
        """Return Ms (points,) of laws with responses `position` and `speed`, (points, f) or (points, 1), the largest over the
        linearisations; infinite for an unstable loop. integrators: of the law. velocity_filter (points, 1): of the law's own,
        s; the loop's where absent."""
        c = speed * (self.rate if velocity_filter is None else self.rate_of(velocity_filter))
        loops = (position * p + c * v for p, v in zip(self.position, self.speed, strict=True))
        return np.max([peak_of(one, n + integrators) for one, n in zip(loops, self.own, strict=True)], axis=0)

    def rate_of(self, velocity_filter: np.ndarray) -> np.ndarray:
        """Return the response (points, f) of the difference filtered with time constants (points, 1), s, per second."""
        share = -np.expm1(-self.loop.sample_time / np.maximum(velocity_filter, 1e-9))
        back = np.exp(-1j * self.theta)
        return share * (1.0 - back) / (1.0 - (1.0 - share) * back) / self.loop.sample_time

    def scheduled_peak(
        self,
        knots: np.ndarray,
        kp: np.ndarray,
        kd: np.ndarray,
        velocity_filter: np.ndarray | None = None,
        behind: np.ndarray | None = None,
    ) -> np.ndarray:
        """Return Ms (points,) of schedules kp, kd (points, n) over knots (n,), at CHECKED of them. velocity_filter: as of `peak`.
        behind (points, f): response of what is behind the law, a notch's."""
        n = 1.0 if behind is None else behind
        pairs = ((n * kp[:, i, None], n * kd[:, i, None]) for i in checked(knots))
        return np.max([self.peak(*pair, velocity_filter=velocity_filter) for pair in pairs], axis=0)


def checked(knots: np.ndarray) -> np.ndarray:
    """Return the numbers of the knots at which a search asks for the sensitivity."""
    return np.unique(np.linspace(0, knots.size - 1, CHECKED).round().astype(int))


@dataclass(frozen=True, eq=False)
class Linear(Judge):
    """Linearisations of one mass: inertia (kg*m^2 or kg) with springs (n,) to ground.

    equivalent: of all friction over amplitude, where laws with a schedule are to be judged. Its loss is left out: it damps.
    """

    loop: Loop
    inertia: float
    viscous: float
    stiffnesses: np.ndarray
    equivalent: Equivalent | None = None

    @cached_property
    def theta(self) -> np.ndarray:
        return np.geomspace(LOWEST, np.pi, GRID)

    def responses(self, springs: np.ndarray) -> np.ndarray:
        """Return the responses (n, f) from torque to position, with the zero-order hold and the delay."""
        unit = self.loop.sample_time**2 / self.inertia
        damping = np.full(springs.size, self.viscous * self.loop.sample_time / self.inertia)
        motion = sampled.steps(springs * unit, damping, self.clock)
        return sampled.response(self.theta, motion, self.clock) * unit

    @cached_property
    def position(self) -> np.ndarray:
        return self.responses(self.stiffnesses)

    @property
    def speed(self) -> np.ndarray:
        return self.position

    @property
    def own(self) -> np.ndarray:
        return np.where(self.stiffnesses > 0.0, 0, 1 if self.viscous > 0.0 else 2)

    def spring_at(self, amplitude: np.ndarray) -> np.ndarray:
        """Return the equivalent stiffness at amplitudes (n,), between those described on a line over log amplitude."""
        known = self.equivalent
        return np.interp(np.log(amplitude), np.log(known.amplitude), known.stiffness)

    @cached_property
    def _at_knots(self) -> dict[bytes, tuple[np.ndarray, np.ndarray]]:
        return {}

    def _sliding_and_sticking(self, knots: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the responses without a spring (1, f) and with those of amplitudes (n,), (n, f): a search asks for the same knots at
        every point, and their matrix exponentials take longer than the points."""
        key = knots.tobytes()
        if key not in self._at_knots:
            self._at_knots[key] = self.responses(np.zeros(1)), self.responses(self.spring_at(knots))
        return self._at_knots[key]

    def scheduled_peak(
        self,
        knots: np.ndarray,
        kp: np.ndarray,
        kd: np.ndarray,
        velocity_filter: np.ndarray | None = None,
        behind: np.ndarray | None = None,
    ) -> np.ndarray:
        """Return Ms (points,) of schedules: at CHECKED knots the gains there with the spring of that amplitude, and with none,
        as when the axis still slides."""
        pick = checked(knots)
        rate = self.rate if velocity_filter is None else self.rate_of(velocity_filter)[:, None]
        c = kp[:, pick, None] + kd[:, pick, None] * rate
        c = c if behind is None else c * behind[:, None]
        sliding, sticking = self._sliding_and_sticking(knots[pick])
        free = 1 if self.viscous > 0.0 else 2
        return np.maximum(peak_of(c * sliding, free).max(axis=1), peak_of(c * sticking, 0).max(axis=1))


@dataclass(frozen=True, eq=False)
class TwoMasses(Judge):
    """Linearisations of two masses on a joint, without ground: every load with every stiffness of the joint.

    motor: kg*m^2 or kg. loads, stiffnesses: of each linearisation, (n,). damping: of the joint, N*m*s/rad or N*s/m.
    motor_position, motor_speed: whether the law reads those of the motor, else of the load.
    """

    loop: Loop
    motor: float
    loads: np.ndarray
    stiffnesses: np.ndarray
    damping: float
    motor_position: bool = False
    motor_speed: bool = True

    @cached_property
    def responses(self) -> tuple[np.ndarray, np.ndarray]:
        """(motor, load): responses (n, f) from torque to each position, with the zero-order hold and the delay."""
        both = [self._response(m, k) for m, k in zip(self.loads, self.stiffnesses, strict=True)]
        return np.array([b[0] for b in both]), np.array([b[1] for b in both])

    def _response(self, load: float, stiffness: float) -> np.ndarray:
        """(2, f): x = [q, v, q of the load, v of the load], exact between samples (Van Loan 1978)."""
        k, c = stiffness, self.damping
        a = np.zeros((5, 5))
        a[0, 1] = a[2, 3] = 1.0
        a[1, :4] = np.array([-k, -c, k, c]) / self.motor
        a[3, :4] = np.array([k, c, -k, -c]) / load
        a[1, 4] = 1.0 / self.motor
        return sampled.forced(a, self.theta, self.clock)[:, [0, 2]].T

    @property
    def position(self) -> np.ndarray:
        return self.responses[0 if self.motor_position else 1]

    @property
    def speed(self) -> np.ndarray:
        return self.responses[0 if self.motor_speed else 1]

    @property
    def own(self) -> np.ndarray:
        return np.full(self.loads.size, 2)
