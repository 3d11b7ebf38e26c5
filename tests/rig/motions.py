"""Motions: what the cascade follows and what torque is added, per control sample, and the records that are made of them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from rig.kernel import PER_CONTROL, RATE

CONTROL = RATE / PER_CONTROL  # Hz


@dataclass(frozen=True, eq=False)
class Motion:
    """reference rad, speed rad/s and injected torque N*m, each (n,) at 4 kHz. closed: the cascade is on. locked: the load
    is held."""

    reference: np.ndarray
    speed: np.ndarray
    injected: np.ndarray
    closed: bool = True
    locked: bool = False


@dataclass(frozen=True)
class Planned:
    """One record: the stem of its file, its role, how its motion is made (from a generator, and whether short)."""

    name: str
    role: str
    make: Callable[[np.random.Generator, bool], Motion]
    motion: str


def following(
    name: str, role: str, position: np.ndarray, rate: float, injected=None, motion: str = "as planned"
) -> Planned:
    """A record that follows a position (n,) in rad, and adds a torque (n,) in N*m to the command, given at `rate` Hz."""

    def make(rng, short: bool) -> Motion:
        given, t = np.arange(position.size) / rate, clock(position.size / rate)
        course = CubicSpline(given, position)
        added = np.zeros(t.size) if injected is None else CubicSpline(given, injected)(t)
        return Motion(course(t), course(t, 1), added)

    return Planned(name, role, make, motion)


def clock(seconds: float) -> np.ndarray:
    return np.arange(round(seconds * CONTROL)) / CONTROL


def gliding(speed: np.ndarray, seconds: float) -> np.ndarray:
    """A running mean, so that steps of a speed become ramps."""
    n = max(1, round(seconds * CONTROL))
    total = np.cumsum(np.concatenate([np.full(n, speed[0]), speed]))
    return (total[n:] - total[:-n]) / n


def slow_sine(rng, short: bool) -> Motion:
    """0.2 Hz, amplitudes 0.0024, 0.02, 0.2, 1.2 rad (short: the two that matter most, at 0.4 Hz)."""
    period, amplitudes = (2.5, (0.02, 1.2)) if short else (5.0, (0.0024, 0.02, 0.2, 1.2))
    t = clock(period * len(amplitudes))
    a = np.array(amplitudes)[np.minimum((t / period).astype(int), len(amplitudes) - 1)]
    a[0] = 0.0
    reference = gliding(a, 0.3) * np.sin(2 * np.pi * t / period)
    return Motion(reference, np.gradient(reference, t), np.zeros(t.size))


def multisine(rng, short: bool) -> Motion:
    """1 to 90 Hz, of equal torque, on top of a slow sweep of 1.4 rad."""
    t = clock(4.0 if short else 12.0)
    lines = np.arange(1.0, 90.5, 2.0) + rng.uniform(-0.2, 0.2, 45)
    phases = rng.uniform(0, 2 * np.pi, 45)
    injected = np.sqrt(2 / lines.size) * np.sin(2 * np.pi * np.outer(t, lines) + phases).sum(axis=1)
    frequency = 0.5 if short else 0.25
    reference = 1.4 * np.sin(2 * np.pi * frequency * t) * np.minimum(t, 1.0)
    return Motion(reference, np.gradient(reference, t), 0.33 * injected * np.minimum(2 * t, 1.0))


def staircase(rng, short: bool) -> Motion:
    """Speeds of both signs between 0.05 and 14 rad/s."""
    speeds = (0.1, 1.5, 14.0) if short else (0.05, 0.15, 0.4, 1.0, 2.5, 6.0, 14.0)
    each = 0.8 if short else 0.9
    levels = np.array([0.0, *(s * way for s in speeds for way in (1.0, -1.0)), 0.0])
    t = clock(each * (levels.size - 1))
    speed = gliding(levels[1:][np.minimum((t / each).astype(int), levels.size - 2)], 0.12)
    speed = speed - speed[0]
    return Motion(np.cumsum(speed) / CONTROL, speed, np.zeros(t.size))


def moves(rng, short: bool) -> Motion:
    """Point-to-point moves of random length with dwells, then small raw steps."""
    t = clock(4.5 if short else 10.0)
    reference, at, end = np.zeros(t.size), 0.0, 0.2
    raw = t[-1] * 0.8
    while end < raw - 0.6:
        to = rng.uniform(-2.5, 2.5)
        length = max(0.15, 1.9 * abs(to - at) / rng.uniform(6.0, 15.0))
        s = np.clip((t - end) / length, 0.0, 1.0)
        reference += (to - at) * s**3 * (10 - 15 * s + 6 * s**2)
        at, end = to, end + length + rng.uniform(0.1, 0.6)
    speed = np.gradient(reference, t)
    while end < t[-1]:
        reference[t >= end] += rng.choice([-1, 1]) * rng.uniform(5e-4, 2e-2)
        end += rng.uniform(0.15, 0.3)
    return Motion(reference, speed, np.zeros(t.size))


def pushing(rng, short: bool) -> Motion:
    """Random torque below 1 Hz against a load that is held."""
    t = clock(5.0 if short else 12.0)
    lines = np.linspace(0.2, 1.0, 12)
    torque = np.sin(2 * np.pi * np.outer(t, lines) + rng.uniform(0, 2 * np.pi, 12)).sum(axis=1)
    torque *= 0.5 / np.std(torque) * np.minimum(t, 1.0)
    return Motion(np.zeros(t.size), np.zeros(t.size), torque, closed=False, locked=True)


RECORDS = (
    Planned("id_slow_sine", "identification", slow_sine, "slow position sines"),
    Planned("id_multisine", "identification", multisine, "multisine torque injection 1-90 Hz on top of a slow sweep"),
    Planned("id_staircase", "identification", staircase, "velocity staircase"),
    Planned("val_moves", "validation", moves, "random point-to-point moves with dwells, then small raw steps"),
)
LOCKED = Planned("id_locked", "identification", pushing, "output locked, random motor torque below 1 Hz")
