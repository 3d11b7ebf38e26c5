"""Controllers over one cycle of a periodic reading: the command's waveform, by the law's own step.

The reading is y(f) over the phase f = w t, its filtered velocity vh(f) follows from the harmonics of y; theta = w Ts. Both
come as arrays (..., phases), one cycle along the last axis, the target at zero. What a law does at a sample is evaluated at
every phase: a schedule looks up its gains by the stroke since the last reversal, and states are stepped along the phase
until they repeat. The command obeys the drive's limit.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca
import numpy as np

from workbench.control import Controller, Law, gains_at
from workbench.effect import namespace
from workbench.errors import WorkbenchError
from workbench.kernel.arrays import evaluate
from workbench.simulate import Loop
from workbench.simulate.stage import Stage, stage

PHASES = 64  # of a cycle
CYCLES = 2  # that states are stepped until they repeat
SIGNALS = ("r", "y", "e", "vh", "dt", "limit", "count", "stroke", "share", "reversal")

Command = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]  # (y, vh (..., p), theta (..., 1)) -> u (..., p)


@dataclass(frozen=True)
class Dials:
    """Two numbers of a law that a region is drawn over: their names."""

    first: str
    second: str


DIALS = (Dials("kv", "ki"), Dials("kp", "kd"))


def dials(controller: Controller) -> Dials:
    """Return what is turned of a controller; WorkbenchError where it has no such gains, or reads two encoders."""
    law = controller.law
    for pair in DIALS:
        if {pair.first, pair.second} <= {*law.parameters, *law.columns} and not law.both:
            return pair
    raise WorkbenchError(
        f"limit cycles are not predicted for the law '{law.name}': one encoder, and gains {' or '.join(f'{d.first}, {d.second}' for d in DIALS)} "
        "are needed."
    )


def turned(controller: Controller, first: float, second: float) -> Controller:
    """Return a controller with the numbers of its two dials multiplied."""
    of = dials(controller)
    factor = {of.first: first, of.second: second}
    tables = tuple(
        replace(t, columns={n: c * factor.get(n, 1.0) for n, c in t.columns.items()}) for t in controller.tables
    )
    parameters = {n: v * factor.get(n, 1.0) for n, v in controller.parameters.items()}
    return replace(controller, parameters=parameters, tables=tables)


@lru_cache(maxsize=64)
def _stage(law: Law, looks_up: bool) -> Stage:
    """Return a law's step, or where it looks up, as a program of named values."""
    signals = {n: ca.SX.sym(n) for n in (*SIGNALS, *law.columns)}
    states = {n: ca.SX.sym(n) for n in law.states}
    numbers = {n: ca.SX.sym(n) for n in law.parameters}
    after, out = (law.amplitude if looks_up else law.step)(
        namespace(**signals), namespace(**states), namespace(**numbers)
    )
    given = signals | {f"z.{n}": v for n, v in states.items()} | {f"p.{n}": v for n, v in numbers.items()}
    return stage("law", given, {"out": out, **{f"z.{n}": v for n, v in after.items()}})


def command(controller: Controller, limit: float, loop: Loop) -> Command:
    """Return the command over one cycle, of a controller of one lane on a drive with this limit."""
    dials(controller)
    law = controller.law
    known = {"r": 0.0, "limit": limit, "count": loop.count, "share": 0.5}
    known |= {f"p.{n}": float(np.ravel(v)[0]) for n, v in controller.parameters.items()}

    def waveform(y, vh, theta):
        width = 2.0 * np.pi / y.shape[-1]
        now = known | {"y": y, "e": -y, "vh": vh, "dt": loop.sample_time * width / theta}
        if law.amplitude is not None:
            at = _stepped(_stage(law, True), now | reversals(y), y.shape)[0]
            columns = gains_at(controller.tables[0], at.ravel())
            now |= {n: c.reshape(y.shape) for n, c in zip(law.columns, columns, strict=True)}
        step = _stage(law, False)
        u, states = _stepped(step, now, y.shape, centred=True)
        if states:  # a state acts a sample late, not a phase
            late = {n: shifted(v, (theta - width) / 2.0) for n, v in states.items()}
            u = _values(step, now | late)["out"]
        return clipped(np.broadcast_to(u, y.shape), limit)

    return waveform


def reversals(y: np.ndarray) -> dict[str, np.ndarray]:
    """Return stroke, the distance since the last reversal, and reversal, 1 at the phases after one."""
    top, bottom = y.max(axis=-1, keepdims=True), y.min(axis=-1, keepdims=True)
    falling = np.roll(y, -1, axis=-1) < y
    return {
        "stroke": np.where(falling, top - y, y - bottom),
        "reversal": 1.0 * (falling != np.roll(falling, 1, axis=-1)),
    }


def _values(made: Stage, given: dict) -> dict:
    return dict(zip(made.outputs, evaluate(made.program, [given[n] for n in made.inputs])[0], strict=True))


def _stepped(made: Stage, given: dict, shape: tuple[int, ...], centred: bool = False):
    """Return (output, state -> its values) over the phases; states are stepped until they repeat.

    centred: a cycle about the target leaves no mean in a state, which a free integral would keep from its start.
    """
    names = [n for n in made.outputs if n != "out"]
    if not names:
        return np.broadcast_to(_values(made, given)["out"], shape), {}
    along = {n: np.empty(shape) for n in ("out", *names)}
    start = {n: np.zeros(shape[:-1]) for n in names}
    for _ in range(CYCLES):
        now = start
        for k in range(shape[-1]):
            here = {n: v[..., k % v.shape[-1]] if np.ndim(v) else v for n, v in given.items()}
            for n in names:
                along[n][..., k] = now[n]
            values = _values(made, here | now)
            along["out"][..., k] = values["out"]
            now = {n: values[n] for n in names}
        start = {n: v - along[n].mean(axis=-1) if centred else v for n, v in now.items()}
    return along["out"], {n: along[n] for n in names}


def shifted(x: np.ndarray, by: np.ndarray) -> np.ndarray:
    """Return a periodic x (..., phases) later by a phase (..., 1)."""
    spectrum = np.fft.rfft(x, axis=-1)
    return np.fft.irfft(spectrum * np.exp(-1j * by * np.arange(spectrum.shape[-1])), x.shape[-1], axis=-1)


def clipped(u: np.ndarray, limit: float) -> np.ndarray:
    """Return a periodic u (..., phases) within +-limit, its mean about each phase with u linear between phases.

    A waveform that is nearly square changes its sign between two phases: so its harmonics move smoothly with where.
    """
    onward = np.roll(u, -1, axis=-1)
    rise = onward - u
    flat = np.abs(rise) < 1e-9 * limit
    mean = np.where(
        flat, np.clip((u + onward) / 2.0, -limit, limit), _area(onward, limit) - _area(u, limit)
    ) / np.where(flat, 1.0, rise)
    return (mean + np.roll(mean, 1, axis=-1)) / 2.0


def harmonics_of(u: np.ndarray, orders: np.ndarray) -> np.ndarray:
    """Return U_k of u = sum Re U_k exp(i k f), (..., orders), of a waveform (..., phases) as `clipped` gives it.

    Its means over neighbours have made harmonic k smaller by cos^2(pi k/phases), which is undone.
    """
    phases = u.shape[-1]
    wave = np.exp(-2j * np.pi / phases * np.outer(np.arange(phases), orders))
    return 2.0 / phases * (u @ wave) / np.cos(np.pi * orders / phases) ** 2


def _area(u: np.ndarray, limit: float) -> np.ndarray:
    """Integral of the limited u over u."""
    size = np.abs(u)
    return np.where(size <= limit, u * u / 2.0, limit * size - limit * limit / 2.0)
