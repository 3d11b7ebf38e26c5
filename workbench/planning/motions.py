"""Smooth reference motions, from rest to rest. Each takes an envelope, its size, its length and the sample time."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.planning.envelope import Envelope

REST = 0.15  # s, at both ends: longer than what identification trims


@dataclass(frozen=True, eq=False)
class Reference:
    """position (n,), rad or m, every dt s; speed and acceleration are its central differences. phrase: "a sine of ...".

    sized: a factor -> the same motion with its amplitude (of ramps, its speed) times that; None where it has no size.
    """

    phrase: str
    position: np.ndarray
    dt: float
    sized: Callable[[float], "Reference"] | None = None

    @property
    def speed(self) -> np.ndarray:
        return np.gradient(self.position, self.dt)

    @property
    def acceleration(self) -> np.ndarray:
        return np.gradient(self.speed, self.dt)

    @property
    def time(self) -> np.ndarray:
        return np.arange(self.position.size) * self.dt

    def within(self, envelope: Envelope) -> bool:
        """Whether position, speed and acceleration stay within the limits; rounding is forgiven."""
        slack = 1.0 + 1e-6
        inside = envelope.low - 1e-6 * envelope.span <= self.position.min()
        inside = inside and self.position.max() <= envelope.high + 1e-6 * envelope.span
        return bool(
            inside
            and np.abs(self.speed).max() <= envelope.speed * slack
            and np.abs(self.acceleration).max() <= envelope.acceleration * slack
        )


def quantity(value: float, unit: str) -> str:
    """Return a value with two digits and the prefix that suits it: "0.5 mrad", "12 µrad"."""
    size = abs(value)
    prefix, factor = ("", 1.0) if size >= 0.1 or size == 0.0 else ("m", 1e-3) if size >= 1e-4 else ("µ", 1e-6)
    digits = f"{value / factor:.0f}" if size / factor >= 99.5 else f"{value / factor:.2g}"
    return f"{digits} {prefix}{unit}"


def _smoothstep(s: np.ndarray) -> np.ndarray:
    """Return 0 to 1 with speed and acceleration zero at both ends: the quintic 10 s^3 - 15 s^4 + 6 s^5."""
    s = np.clip(s, 0.0, 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


def _window(t: np.ndarray, seconds: float, rise: float) -> np.ndarray:
    """Return a weight that rises from 0 to 1, stays, and falls to 0, at rest for REST s at both ends."""
    return _smoothstep((t - REST) / rise) * _smoothstep((seconds - REST - t) / rise)


def _clock(seconds: float, dt: float) -> np.ndarray:
    return np.arange(round(seconds / dt)) * dt


def _move_time(distance: float, e: Envelope) -> float:
    """Return the shortest time in s of a quintic move: peak speed 15/8 D/T, peak acceleration 10/sqrt(3) D/T^2."""
    return max(1.875 * abs(distance) / e.speed, (5.7735 * abs(distance) / e.acceleration) ** 0.5, 0.02)


def sine(e: Envelope, amplitude: float, seconds: float, dt: float, unit: str, frequency: float, places=()) -> Reference:
    """A sine about the centre, or about each of three places in turn."""
    t = _clock(seconds, dt)
    about = f"about {quantity(e.centre, unit)}"
    if places:
        about = f"about three positions over {quantity(places[-1] - places[0], unit)}"
    phrase = f"a sine of {quantity(amplitude, unit)} at {frequency:.2g} Hz {about}"
    places = places or (e.centre,)
    each = seconds / len(places)
    position = np.full(t.size, places[0])
    for k, (place, after) in enumerate(zip(places, (*places[1:], places[-1]), strict=True)):
        travel = max(_move_time(after - place, e), 0.2 * each)
        length = each - (travel if after != place else 0.0)
        s = t - k * each
        rise = min(1.0 / frequency, 0.4 * (length - 2 * REST))
        here = (s >= 0.0) & (s < each)
        wave = amplitude * _window(s, length, rise) * np.sin(2 * np.pi * frequency * (s - REST))
        position[here] = (place + wave + (after - place) * _smoothstep((s - length) / travel))[here]
    return Reference(phrase, position, dt)


def ramps(e: Envelope, speed: float, seconds: float, dt: float, unit: str, stroke: float) -> Reference:
    """Back and forth at a constant speed; corners are rounded by a running mean of the speed."""
    t = _clock(seconds, dt)
    corner = max(4.2 * speed / e.acceleration, 0.02)  # Hann's window turns 2 v round with a peak of 4 v/corner
    leg = max(min(stroke / speed, 0.5 * (seconds - 2 * REST)), 2 * corner)
    legs = max(int((seconds - 2 * REST - corner) / leg), 1)  # the first and the last are halves
    where = (t - REST) / leg + 0.5
    way = np.where((t >= REST) & (t < REST + leg * legs), 1.0 - 2.0 * (np.floor(where) % 2), 0.0)
    n = max(round(corner / dt), 1)
    kernel = np.hanning(n + 2)[1:-1]
    rate = np.convolve(speed * way, kernel / kernel.sum())[: t.size]
    travelled = np.cumsum(rate) * dt
    position = e.centre + travelled - 0.5 * (travelled.max() + travelled.min())
    return Reference(
        f"ramps at {quantity(speed, unit)}/s, {quantity(float(np.ptp(travelled)), unit)} back and forth", position, dt
    )


def multisine(
    e: Envelope, level: float, seconds: float, dt: float, unit: str, top: float, sweep: float = 0.0
) -> Reference:
    """Lines of equal acceleration from 1 Hz to `top` with Schroeder's phases, on top of a slow sine of amplitude `sweep`.

    level: of the acceleration limit, and of what speed and travel leave beside the sweep.
    """
    t = _clock(seconds, dt)
    lines = np.arange(1.0, top + 0.5, max(1.0, round(top / 30)))
    k = np.arange(lines.size)
    phases = -np.pi * k * (k - 1) / lines.size
    angle = 2 * np.pi * np.outer(lines, t) + phases[:, None]
    size = (2 * np.pi * lines[:, None]) ** -2.0
    shape = _window(t, seconds, 0.25) * np.sum(size * np.sin(angle), axis=0)
    slow = 1.0 / max(seconds - 2 * REST, 1.0)
    carrier = sweep * _window(t, seconds, 0.25 / slow) * np.sin(2 * np.pi * slow * (t - REST))
    fast, under = Reference("", shape, dt), Reference("", carrier, dt)
    room = [
        (0.5 * e.span - np.abs(carrier).max()) / np.abs(shape).max(),
        (e.speed - np.abs(under.speed).max()) / np.abs(fast.speed).max(),
        (e.acceleration - np.abs(under.acceleration).max()) / np.abs(fast.acceleration).max(),
    ]
    factor = level * max(min(room), 0.0)
    rms = factor * float(np.std(fast.acceleration))
    over = f" on top of a sine of {quantity(sweep, unit)} at {slow:.2g} Hz" if sweep else ""
    phrase = f"a multisine from 1 to {top:.0f} Hz with an acceleration of {quantity(rms, unit)}/s^2 rms{over}"
    return Reference(phrase, e.centre + carrier + factor * shape, dt)


def moves(e: Envelope, reach: float, seconds: float, dt: float, unit: str) -> Reference:
    """Point-to-point moves as fast as the limits allow, over `reach` about the centre, with dwells."""
    t = _clock(seconds, dt)
    position, at, now, k = np.full(t.size, e.centre), 0.0, REST, 0
    while True:
        k += 1
        to = reach * ((k * 0.618034) % 1.0 - 0.5)
        travel, back = _move_time(to - at, e), _move_time(to, e)
        if now + travel + REST + back + REST > seconds:
            break
        position += (to - at) * _smoothstep((t - now) / travel)
        now, at = now + travel + 0.5 * REST, to
    position -= at * _smoothstep((t - now) / _move_time(at, e))
    return Reference(f"point-to-point moves within {quantity(reach, unit)}, as fast as the limits allow", position, dt)


def joined(references: Sequence[Reference], e: Envelope) -> Reference:
    """Return one motion: each in turn, and moves at half the speed limit from where one ends to where the next begins."""
    dt, parts = references[0].dt, [references[0].position]
    for following in references[1:]:
        at, to = parts[-1][-1], following.position[0]
        travel = max(2.0 * _move_time(to - at, e), dt)
        parts += [at + (to - at) * _smoothstep(_clock(travel, dt) / travel), following.position]
    counts = Counter(r.phrase for r in references)
    phrase = ", then ".join(f"{n} times {p}" if n > 1 else p for p, n in counts.items())
    return Reference(phrase, np.concatenate(parts), dt)
