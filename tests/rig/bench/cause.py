"""One thing that may be missing of a bench's declared model, and the shapes in which it comes.

A cause is put on a machine at a size; it is sized until what the declared model cannot absorb of it is as large as asked.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter

from rig.bench.machines import Machine, Stand, Timeline


@dataclass(frozen=True, eq=False)
class Cause:
    """effect: the name that a trace should give; "" for what no catalogue has. on(machine, size) -> machine; size 1 is a first
    guess. wrong: (place, factor of size) of a declared inertia that is off. law: in words. largest: size beyond which it
    is another thing. where: (coordinate, spans) of what no catalogue has."""

    effect: str
    at: str
    law: str
    parameters: Callable[[float], dict]
    on: Callable[[Machine, float], Machine] = lambda m, size: m
    wrong: str = ""
    largest: float = np.inf
    where: tuple | None = None


def put(
    effect: str, at: str, law: str, scaled: dict, fixed: dict | None = None, largest: float = np.inf, where=None
) -> Cause:
    """A cause of fields of the Facts: scaled ones go with its size."""
    fixed = fixed or {}

    def values(size):
        return {**{k: v * size for k, v in scaled.items()}, **fixed}

    return Cause(effect, at, law, values, lambda m, size: m.put(**values(size)), largest=largest, where=where)


def waves(effect: str, at: str, law: str, name: str, rows: np.ndarray, largest: float = np.inf) -> Cause:
    """A cause of waves whose amplitudes go with its size."""

    def sized(size):
        return rows * np.array([size, 1.0, 1.0])

    return Cause(
        effect,
        at,
        law,
        lambda size: {name: sized(size).tolist()},
        lambda m, size: m.waved(name, sized(size)),
        largest=largest,
    )


def timed(effect: str, at: str, law: str, level=None, push=None, parameters=None, where=None) -> Cause:
    """A cause of the bench clock: level(t, size) a factor on friction, push(t, size) a force."""

    def on(m, size):
        line = Timeline(
            (lambda t: level(t, size)) if level else np.ones_like, (lambda t: push(t, size)) if push else np.zeros_like
        )
        return replace(m, timelines=(*m.timelines, line))

    return Cause(effect, at, law, lambda size: {"size": size, **(parameters or {})}, on, where=where)


def harmonics(rng, amplitude: float, order: float, many: int) -> np.ndarray:
    """Waves (many, 3): the order and multiples of it, each weaker than the one before."""
    multiples = np.concatenate([[1.0], rng.choice(np.arange(2.0, 7.0), many - 1, replace=False)])
    shares = np.cumprod(np.concatenate([[1.0], rng.uniform(0.2, 0.7, many - 1)]))
    return np.column_stack([amplitude * shares, order * multiples, rng.uniform(-np.pi, np.pi, many)])


def sign(rng) -> float:
    return float(rng.choice([-1.0, 1.0]))


def turns(rng, s: Stand) -> float:
    """An order over position that the motions pass often enough: teeth, poles, or the pitch of a screw."""
    return 2 * np.pi * rng.uniform(6.0, 40.0) / (2 * s.reach.stroke) if s.linear else float(rng.integers(8, 60))


def mover(s: Stand) -> str:
    return "motor" if s.machine.two else "axis"


def end(s: Stand) -> str:
    return "load" if s.machine.two else "axis"


def walk(seed: int, tau: float, t: np.ndarray) -> np.ndarray:
    """First-order noise of rms one at the moments t, the same whatever record asks for it."""
    step, rng = tau / 20, np.random.default_rng(seed)
    n = int(1000.0 / step)
    white, keep = rng.standard_normal(n), np.exp(-step / tau)
    x = lfilter([np.sqrt(1 - keep**2)], [1.0, -keep], white)
    return np.interp(t, np.arange(n) * step, x)
