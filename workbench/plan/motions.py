"""Smooth reference motions, from rest to rest, each within an envelope, and the pool that a plan picks from."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil

import numpy as np

from workbench.effect import Effect
from workbench.plan.envelope import Envelope, Sensing

REST = 0.15  # s, at both ends: longer than what identification trims
LEAST = 30.0  # counts: a smaller amplitude shows the encoder more than the axis
FASTEST = 0.3  # of the evaluation bandwidth: the highest frequency of a sine; a multisine goes to twice that


@dataclass(frozen=True, eq=False)
class Reference:
    """position (n,), rad or m, every dt s; speed and acceleration are its central differences. phrase: "a sine of ..."."""

    phrase: str
    position: np.ndarray
    dt: float

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


def smoothstep(s: np.ndarray) -> np.ndarray:
    """Return 0 to 1 with speed and acceleration zero at both ends: the quintic 10 s^3 - 15 s^4 + 6 s^5."""
    s = np.clip(s, 0.0, 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


def window(t: np.ndarray, seconds: float, rise: float) -> np.ndarray:
    """Return a weight that rises from 0 to 1, stays, and falls to 0, at rest for REST s at both ends."""
    return smoothstep((t - REST) / rise) * smoothstep((seconds - REST - t) / rise)


def clock(seconds: float, dt: float) -> np.ndarray:
    return np.arange(round(seconds / dt)) * dt


def move_time(distance: float, e: Envelope) -> float:
    """Return the shortest time in s of a quintic move: peak speed 15/8 D/T, peak acceleration 10/sqrt(3) D/T^2."""
    return max(1.875 * abs(distance) / e.speed, (5.7735 * abs(distance) / e.acceleration) ** 0.5, 0.02)


def sine(e: Envelope, amplitude: float, frequency: float, seconds: float, dt: float, unit: str, places=()) -> Reference:
    """A sine about the centre, or about each of several places in turn."""
    t = clock(seconds, dt)
    about = (
        f"about {quantity(e.centre, unit)}" if not places else f"about {('two', 'three')[len(places) - 2]} positions"
    )
    phrase = f"a sine of {quantity(amplitude, unit)} at {frequency:.2g} Hz {about}"
    places = places or (e.centre,)
    each = seconds / len(places)
    position = np.full(t.size, places[0])
    for k, (place, after) in enumerate(zip(places, (*places[1:], places[-1]), strict=True)):
        travel = max(move_time(after - place, e), 0.2 * each)
        length = each - (travel if after != place else 0.0)
        s = t - k * each
        rise = min(1.0 / frequency, 0.4 * (length - 2 * REST))
        here = (s >= 0.0) & (s < each)
        wave = amplitude * window(s, length, rise) * np.sin(2 * np.pi * frequency * (s - REST))
        position[here] = (place + wave + (after - place) * smoothstep((s - length) / travel))[here]
    return Reference(phrase, position, dt)


def ramps(e: Envelope, stroke: float, speed: float, seconds: float, dt: float, unit: str) -> Reference:
    """Back and forth at a constant speed; corners are rounded by a running mean of the speed."""
    t = clock(seconds, dt)
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
    e: Envelope, level: float, top: float, seconds: float, dt: float, unit: str, sweep: float = 0.0
) -> Reference:
    """Lines of equal acceleration from 1 Hz to `top` with Schroeder's phases, on top of a slow sine of amplitude `sweep`.

    level: of the acceleration limit, and of what speed and travel leave beside the sweep.
    """
    t = clock(seconds, dt)
    lines = np.arange(1.0, top + 0.5, max(1.0, round(top / 30)))
    k = np.arange(lines.size)
    phases = -np.pi * k * (k - 1) / lines.size
    angle = 2 * np.pi * np.outer(lines, t) + phases[:, None]
    size = (2 * np.pi * lines[:, None]) ** -2.0
    shape = window(t, seconds, 0.25) * np.sum(size * np.sin(angle), axis=0)
    slow = 1.0 / max(seconds - 2 * REST, 1.0)
    carrier = sweep * window(t, seconds, 0.25 / slow) * np.sin(2 * np.pi * slow * (t - REST))
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
    t = clock(seconds, dt)
    position, at, now, k = np.full(t.size, e.centre), 0.0, REST, 0
    while True:
        k += 1
        to = reach * ((k * 0.618034) % 1.0 - 0.5)
        travel, back = move_time(to - at, e), move_time(to, e)
        if now + travel + REST + back + REST > seconds:
            break
        position += (to - at) * smoothstep((t - now) / travel)
        now, at = now + travel + 0.5 * REST, to
    position -= at * smoothstep((t - now) / move_time(at, e))
    return Reference(f"point-to-point moves within {quantity(reach, unit)}, as fast as the limits allow", position, dt)


def amplitudes(effects: tuple[Effect, ...], e: Envelope, s: Sensing) -> list[float]:
    """Return amplitudes from tens of counts to half the travel, and about the stroke of each effect that has one."""
    least, most = max(LEAST * s.counts, 1e-5 * e.span), 0.49 * e.span
    strokes = [p.value for x in effects for p in x.parameters.values() if p.scale == "stroke" and p.value > 0.0]
    wanted = [*np.geomspace(least, most, 4), *(f * x for x in sorted(strokes) for f in (0.5, 2.0, 8.0))]
    kept: list[float] = []
    for a in sorted(wanted):
        if least <= a <= most * 1.0001 and (not kept or a > 1.5 * kept[-1]):
            kept.append(float(a))
    return kept


def speeds(effects: tuple[Effect, ...], e: Envelope, seconds: float) -> list[float]:
    """Return speeds up to the limit, and about the speed of each effect that has one."""
    known = [p.value for x in effects for p in x.parameters.values() if p.scale == "speed" and p.value > 0.0]
    wanted = [*(e.speed * np.array([0.003, 0.03, 0.2, 0.9])), *(f * v for v in sorted(known) for f in (0.4, 1.2, 3.0))]
    kept: list[float] = []
    for v in sorted(wanted):
        if v <= 0.95 * e.speed and (not kept or v > 1.5 * kept[-1]):
            kept.append(float(v))
    return kept


def pool(effects: tuple[Effect, ...], e: Envelope, s: Sensing, seconds: float, unit: str) -> Iterator[Reference]:
    """Yield motions of one length within the envelope: for friction at rest and in motion, for position, for inertia."""
    least = 2.0 / (seconds - 2 * REST)
    top = max(FASTEST * s.bandwidth, least)
    tried = []
    for a in amplitudes(effects, e, s):
        fastest = min(0.9 * e.speed / a / (2 * np.pi), (0.9 * e.acceleration / a) ** 0.5 / (2 * np.pi), top)
        for f in dict.fromkeys(
            float(x) for x in np.geomspace(least, max(fastest, least), 1 + min(2, ceil(fastest / least)))
        ):
            tried.append(sine(e, a, f, seconds, dt=s.dt, unit=unit))
        if a < 0.1 * e.span and 3.0 * least <= fastest:
            places = (e.low + 1.2 * a, e.centre, e.high - 1.2 * a)
            tried.append(sine(e, a, min(2.0, fastest), seconds, s.dt, unit, places))
    tried += [ramps(e, 0.95 * e.span, v, seconds, s.dt, unit) for v in speeds(effects, e, seconds)]
    for level in (0.1, 0.5, 0.9):
        tried.append(multisine(e, level, 2 * top, seconds, s.dt, unit))
    tried.append(multisine(e, 0.6, 2 * top, seconds, s.dt, unit, sweep=0.3 * min(e.span, e.speed * seconds / 7)))
    tried += [moves(e, part * e.span, seconds, s.dt, unit) for part in (0.05, 0.3, 0.95)]
    for reference in tried:
        if reference.within(e):
            yield reference
