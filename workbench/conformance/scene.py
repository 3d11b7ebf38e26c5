"""A motion that shows an effect at work: its size, speed and time follow from the scales of the effect's parameters."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import pi

import numpy as np

from workbench.definition import Effect
from workbench.kernel import step

WAVES = ((1.0, 0.55, 0.0), (2.7, 0.3, 0.4), (7.3, 0.15, 1.1))  # (frequency, amplitude, phase): reversals of many sizes
A_PERIOD = 400  # samples of the slowest wave
BEGINS = 100  # samples on the bench clock before it: what earlier motion left shows, too
DRAWN = 0.1  # what a parameter without a value is set to
SHORTEST = 5e-3  # s: of a time, so that a record over it is longer than what identification trims


@dataclass(frozen=True, eq=False)
class Scene:
    """signals: name -> (n,); dt in s; length: displacement, zero to peak; omega: rad/s of the slowest wave."""

    signals: Mapping[str, np.ndarray]
    dt: float
    length: float
    omega: float


def _scaled(effect: Effect, word: str) -> list[float]:
    """Values of the parameters with this scale, not zero."""
    return [p.value for p in effect.parameters.values() if p.scale == word and p.value]


def scene(effect: Effect, samples: int = 600, faster: float = 1.0) -> Scene:
    """Return a scene for an effect. faster: the same path, run through in a shorter time."""
    strokes, orders = _scaled(effect, "stroke"), _scaled(effect, "order")
    length = max([1.6 * s for s in strokes] + [20.0 / k for k in orders], default=1.0)
    omega = 2.0 * pi
    if speeds := _scaled(effect, "speed"):
        omega = 3.0 * max(speeds) / length
    for p in effect.parameters.values():
        if p.scale in ("rate", "resonance") and p.value:
            omega = 0.37 * p.value * (2.0 * pi if p.unit == "Hz" else 1.0)
        if p.scale == "time" and p.value:
            omega = 0.3 / abs(p.value)
    dt = 2.0 * pi / omega / A_PERIOD
    theta = omega * dt * np.arange(samples)
    omega, dt = omega * faster, dt / faster

    def wave(derivative: int = 0, shift: float = 0.0) -> np.ndarray:
        return sum(
            a * (f * omega) ** derivative * np.sin(f * theta + p + shift + derivative * pi / 2) for f, a, p in WAVES
        )

    offset = wave()[0]
    q, v, a = length * (wave() - offset), length * wave(1), length * wave(2)
    signals = {
        "q": q,
        "dq": np.diff(q, prepend=q[0]),
        "v": v,
        "a": a,
        "dt": np.full(samples, dt),
        "t": dt * (BEGINS + np.arange(samples)),
        "u": wave(shift=0.7),
        "tau": wave(shift=1.9),
        "tau_inertia": 0.8 * wave(shift=0.3),
        "dir": v / (np.abs(v) + 0.02 * np.abs(v).max()),
        "motor_q": 1.3 * q,
        "load_q": 0.7 * q,
        "temperature": 300.0 + 5.0 * wave(shift=0.2),
        "normal": 1.0 + 0.3 * wave(shift=0.9),
    }
    signals |= {n: np.full(samples, x) for n, x in (("ratio", 30.0), ("pole_pairs", 5.0), ("locked", 0.0))}
    return Scene(signals, dt, length, omega)


def drawn(effect: Effect) -> Effect:
    """Return the effect with every parameter away from zero, its linear ones so that each column weighs the same."""
    values = {}
    for n in effect.shape:
        p = effect.parameters[n]
        least = DRAWN if not p.value else SHORTEST if p.scale == "time" else 0.0
        values[n] = float(np.clip(max(p.value, min(least, 0.3 * p.upper)), p.lower, p.upper)) if least else p.value
    shaped = replace(
        effect, parameters={n: replace(p, value=values.get(n, p.value)) for n, p in effect.parameters.items()}
    )
    if not effect.linear:
        return shaped
    columns = outputs(shaped, scene(shaped).signals)[: len(effect.linear)]
    for i, (n, column) in enumerate(zip(effect.linear, columns, strict=True)):
        p, size = effect.parameters[n], float(np.sqrt(np.mean(column**2)))
        values[n] = float(np.clip(0.9**i / size if size > 0.0 else 1.0, p.lower, 0.3 * p.upper))
    return shaped(**values)


def outputs(effect: Effect, signals: Mapping[str, np.ndarray]) -> np.ndarray:
    """Columns and provided signals along `signals`, (m, n)."""
    return step.build(effect).run(signals, {n: p.value for n, p in effect.parameters.items()})


def output(effect: Effect, signals: Mapping[str, np.ndarray]) -> np.ndarray:
    """The effect's output along `signals`, (n,)."""
    weights = [effect.parameters[n].value for n in effect.linear] or [1.0]
    return np.array(weights) @ outputs(effect, signals)[: len(weights)]


def along(effect: Effect, q: np.ndarray, dt: float) -> np.ndarray:
    """Output on a path q (n,) from rest at q[0], walked at uniform time steps; dir is the sign of each increment."""
    dq = np.diff(q, prepend=q[0])
    signals = dict(scene(effect, samples=q.size).signals)
    v = dq / dt
    signals |= {"q": q, "dq": dq, "v": v, "a": np.diff(v, prepend=v[0]) / dt, "dir": np.sign(dq)}
    signals |= {
        "dt": np.full(q.size, dt),
        "t": dt * (BEGINS + np.arange(q.size)),
        "motor_q": 1.3 * q,
        "load_q": 0.7 * q,
    }
    return output(effect, signals)
