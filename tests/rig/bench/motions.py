"""Motions of a bench: what the cascade follows and what is added to its command, per control sample.

Each is drawn within the reach of a machine: `Reach(stroke, speed, acceleration, torque)`, SI.
"""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Reach:
    """stroke: to either side; speed, acceleration: largest; torque: what may be injected."""

    stroke: float
    speed: float
    acceleration: float
    torque: float


@dataclass(frozen=True, eq=False)
class Motion:
    """reference, speed, acceleration and injected torque, each (n,) at the control rate."""

    reference: np.ndarray
    injected: np.ndarray
    rate: float
    what: str
    closed: bool = True
    locked: bool = False

    @property
    def speed(self) -> np.ndarray:
        return np.gradient(self.reference, 1.0 / self.rate)

    @property
    def acceleration(self) -> np.ndarray:
        return np.gradient(self.speed, 1.0 / self.rate)


def clock(seconds: float, rate: float) -> np.ndarray:
    return np.arange(round(seconds * rate)) / rate


def gliding(x: np.ndarray, n: int) -> np.ndarray:
    """A running mean of n samples that begins at x[0]: steps become ramps."""
    n = max(1, n)
    total = np.cumsum(np.concatenate([np.full(n, x[0]), x]))
    return (total[n:] - total[:-n]) / n


def course(speed: np.ndarray, reach: Reach, rate: float) -> np.ndarray:
    """The position along a speed (n,), made to keep to the acceleration, begun at rest."""
    step = np.abs(np.diff(speed)).max(initial=0.0)
    speed = np.concatenate([[0.0], speed[1:]])
    speed = gliding(gliding(speed, round(step / reach.acceleration * rate)), round(0.012 * rate))
    return np.cumsum(speed) / rate


def follow(q: np.ndarray, rate: float, what: str, injected: np.ndarray | None = None) -> Motion:
    return Motion(q, np.zeros(q.size) if injected is None else injected, rate, what)


def trapezoids(rng, reach: Reach, seconds: float, rate: float) -> Motion:
    """Moves between random places at several speeds, with rests."""
    t, q, at, begin = clock(seconds, rate), np.zeros(round(seconds * rate)), 0.0, 0.2
    while begin < seconds - 0.3:
        to, v = rng.uniform(-1, 1) * reach.stroke, reach.speed * rng.choice([0.15, 0.4, 0.7, 1.0])
        length, a = abs(to - at), 0.9 * reach.acceleration
        v = min(v, np.sqrt(length * a))
        rise, cruise = v / a, max(length / v - v / a, 0.0)
        s = t - begin
        up, down = np.clip(s, 0, rise), np.clip(s - rise - cruise, 0, rise)
        gone = 0.5 * a * up**2 + v * np.clip(s - rise, 0, cruise) + v * down - 0.5 * a * down**2
        q += np.sign(to - at) * gone
        at, begin = (
            at + np.sign(to - at) * (a * rise**2 + v * cruise),
            begin + 2 * rise + cruise + rng.uniform(0.05, 0.5),
        )
    return follow(gliding(q, round(0.01 * rate)), rate, "trapezoidal moves between random places at several speeds")


def triangles(rng, reach: Reach, seconds: float, rate: float) -> Motion:
    """To and fro at three speeds."""
    t, speeds = clock(seconds, rate), reach.speed * np.array([0.03, 0.15, 0.6])
    each = seconds / 3
    k = np.minimum((t / each).astype(int), 2)
    period = np.array([min(4 * 0.8 * reach.stroke / v, each / 1.5) for v in speeds])
    way = np.where(((t % each) / period[k] + 0.25) % 1.0 < 0.5, 1.0, -1.0)
    return follow(course(speeds[k] * way, reach, rate), rate, "slow triangles at three speeds")


def runs(rng, reach: Reach, seconds: float, rate: float) -> Motion:
    """Constant speeds of both signs, from a hundredth of the largest on."""
    t, levels = clock(seconds, rate), reach.speed * np.geomspace(0.01, 0.9, 6)
    each = seconds / 12
    k = np.minimum((t / each).astype(int), 11)
    levels = np.minimum(levels, 1.6 * reach.stroke / each)
    speed = levels[k // 2] * np.where(k % 2 == 0, 1.0, -1.0)
    return follow(course(speed, reach, rate), rate, "runs at constant speed in both directions")


def chirp(rng, reach: Reach, seconds: float, rate: float) -> Motion:
    """A swept sine, limited in stroke, speed and acceleration."""
    t, low, high = clock(seconds, rate), rng.uniform(0.3, 0.6), rng.uniform(20.0, 45.0)
    grows = np.log(high / low) / seconds
    w = 2 * np.pi * low * np.exp(grows * t)
    a = np.minimum(np.minimum(0.8 * reach.stroke, 0.8 * reach.speed / w), 0.6 * reach.acceleration / w**2)
    q = a * np.sin((w - w[0]) / grows) * np.minimum(2 * t, 1.0)
    return follow(q, rate, f"swept sine {low:.1f} to {high:.0f} Hz, limited in stroke, speed and acceleration")


def sines(rng, reach: Reach, seconds: float, rate: float) -> np.ndarray:
    """Incommensurate slow sines (n,), within stroke and speed."""
    t = clock(seconds, rate)
    lines = np.array([0.11, 0.173, 0.31, 0.47]) * rng.uniform(0.9, 1.2, 4)
    q = np.sin(2 * np.pi * np.outer(t, lines) + rng.uniform(0, 2 * np.pi, 4)) @ (1.0 / np.arange(1, 5))
    q *= min(0.8 * reach.stroke / np.abs(q).max(), 0.6 * reach.speed / np.abs(np.gradient(q, 1 / rate)).max())
    return (q - q[0]) * np.minimum(t / 0.6, 1.0) ** 2 * (3 - 2 * np.minimum(t / 0.6, 1.0))


def prbs(rng, reach: Reach, seconds: float, rate: float) -> Motion:
    """Binary torque noise on top of slow sines."""
    hold = rng.choice([60.0, 120.0, 240.0])
    t = clock(seconds, rate)
    bits = rng.choice([-1.0, 1.0], int(seconds * hold) + 2)
    q = sines(rng, reach, seconds, rate)
    return follow(
        q,
        rate,
        f"slow sines, binary torque noise clocked at {hold:.0f} Hz on top",
        0.5 * reach.torque * bits[(t * hold).astype(int)] * (t > 0.3),
    )


def multisine(rng, reach: Reach, seconds: float, rate: float) -> Motion:
    """A multisine of torque, 1 to 60 Hz, on top of slow sines."""
    t, lines = clock(seconds, rate), np.arange(1.0, 60.0, 2.0) + rng.uniform(-0.3, 0.3, 30)
    u = np.sin(2 * np.pi * np.outer(t, lines) + rng.uniform(0, 2 * np.pi, 30)).sum(axis=1) / np.sqrt(15.0)
    return follow(
        sines(rng, reach, seconds, rate),
        rate,
        "slow sines, multisine of torque on top",
        0.35 * reach.torque * u * np.minimum(t, 1.0),
    )


def rich(rng, reach: Reach, seconds: float, rate: float) -> Motion:
    """A multisine of position, 0.3 to 12 Hz."""
    t, lines = clock(seconds, rate), np.geomspace(0.3, 12.0, 14) * rng.uniform(0.95, 1.05, 14)
    w = 2 * np.pi * lines
    q = (np.sin(np.outer(t, w) + rng.uniform(0, 2 * np.pi, 14)) / w**1.3).sum(axis=1)
    q *= min(
        0.8 * reach.stroke / np.abs(q).max(),
        0.7 * reach.speed / np.abs(np.gradient(q, 1 / rate)).max(),
        0.7 * reach.acceleration / np.abs(np.gradient(np.gradient(q, 1 / rate), 1 / rate)[5:-5]).max(),
    )
    s = np.minimum(t / 0.6, 1.0)
    return follow((q - q[0]) * s**3 * (10 - 15 * s + 6 * s**2), rate, "multisine of position 0.3 to 12 Hz")


def shuttle(rng, reach: Reach, seconds: float, rate: float) -> Motion:
    """Stop and go in equal steps, forward and back."""
    t = clock(seconds, rate)
    step = 2 * 0.8 * reach.stroke / 8
    each = seconds / 16
    moving = min(0.6 * each, max(2.0 * step / reach.speed, np.sqrt(8.0 * step / reach.acceleration)))
    k = np.minimum((t / each).astype(int), 15)
    s = np.clip((t - k * each) / moving, 0, 1)
    done = k + s**3 * (10 - 15 * s + 6 * s**2)
    q = step * np.where(done <= 4, done, np.where(done <= 12, 8 - done, done - 16))
    return follow(q, rate, "stop and go in equal steps")


def small(rng, reach: Reach, seconds: float, rate: float) -> Motion:
    """Sines of small and growing strokes."""
    t = clock(seconds, rate)
    f = rng.uniform(0.6, 1.2)
    k = np.minimum((t / seconds * 6).astype(int), 5)
    a = np.minimum(reach.stroke * np.geomspace(2e-4, 0.1, 6), 0.7 * reach.speed / (2 * np.pi * f))[k]
    q = gliding(np.concatenate([[0.0], a[1:]]), round(0.3 * rate)) * np.sin(2 * np.pi * f * t)
    return follow(q, rate, "sines of small and growing strokes")


def blocked(rng, reach: Reach, seconds: float, rate: float) -> Motion:
    """Slow random torque against a load that is held."""
    t, lines = clock(seconds, rate), np.linspace(0.2, 1.4, 9)
    u = np.sin(2 * np.pi * np.outer(t, lines) + rng.uniform(0, 2 * np.pi, 9)).sum(axis=1)
    u *= 0.4 * reach.torque / np.std(u) * np.minimum(t, 1.0)
    return Motion(np.zeros(t.size), u, rate, "output blocked, slow random torque", closed=False, locked=True)


BROAD = (chirp, prbs, multisine, rich)
SLOW = (triangles, runs, shuttle, small)


def moved(motion: Motion, by: float) -> Motion:
    """The same, begun elsewhere."""
    return replace(motion, reference=motion.reference + by)
