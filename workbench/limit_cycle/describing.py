"""Controllers over one cycle of a periodic reading: the command's waveform, and its first harmonic.

The reading is y(f) over the phase f = w t, its filtered velocity vh(f) follows from the harmonics of y; theta = w Ts. Both come as arrays
(..., PHASES), one cycle along the last axis, the target at zero. A schedule moves its gains with the stroke since the last
reversal; the integral of a cascade is stepped until it repeats, with its limit and where it stops. The command obeys the
drive's limit.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from workbench.control import Controller, gains_at
from workbench.errors import WorkbenchError
from workbench.simulate import Loop

PHASES = 64  # of a cycle
CYCLES = 2  # of an integral that is stepped until it repeats


@dataclass(frozen=True)
class Dials:
    """Two numbers of a law that a region is drawn over: their names."""

    first: str
    second: str


PD, CASCADE = Dials("kp", "kd"), Dials("kv", "ki")
DIALS = {"fixed_pd": PD, "pi_cascade": CASCADE} | {
    f"scheduled_pd, {rule}": PD for rule in ("following", "frozen", "error")
}  # law -> what is turned

Command = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]  # (y, vh (..., p), theta (..., 1)) -> u (..., p)


def dials(controller: Controller) -> Dials:
    """Return what is turned of a controller; WorkbenchError for a law whose waveform is not known."""
    if controller.law.name not in DIALS:
        raise WorkbenchError(
            f"limit cycles are not predicted for the law '{controller.law.name}'; known: {', '.join(sorted(DIALS))}."
        )
    return DIALS[controller.law.name]


def turned(controller: Controller, first: float, second: float) -> Controller:
    """Return a controller with the numbers of its two dials multiplied."""
    of = dials(controller)
    if not controller.tables:
        p = controller.parameters
        return replace(controller, parameters={**p, of.first: p[of.first] * first, of.second: p[of.second] * second})
    tables = tuple(
        replace(t, columns={of.first: t.columns[of.first] * first, of.second: t.columns[of.second] * second})
        for t in controller.tables
    )
    return replace(controller, tables=tables)


def command(controller: Controller, limit: float, loop: Loop) -> Command:
    """Return the command over one cycle, of a controller of one lane on a drive with this limit."""
    dials(controller)
    p = {n: float(np.ravel(v)[0]) for n, v in controller.parameters.items()}
    if controller.law.name == "fixed_pd":
        return lambda y, vh, theta: clipped(-p["kp"] * y - p["kd"] * vh, limit)
    if controller.law.name == "pi_cascade":
        return lambda y, vh, theta: _cascade(p, y, vh, theta, limit, loop.sample_time)
    rule, table = controller.law.name.split(", ")[1], controller.tables[0]

    def scheduled(y, vh, theta):
        at = along(rule, y, loop.count)
        kp, kd = (g.reshape(y.shape) for g in gains_at(table, at.ravel()))
        return clipped(-p["scale"] * (kp * y + kd * vh), limit)

    return scheduled


def along(rule: str, y: np.ndarray, count: float) -> np.ndarray:
    """Return the amplitude that a schedule looks up along a cycle: see workbench.control.scheduled_pd."""
    top, bottom = y.max(axis=-1, keepdims=True), y.min(axis=-1, keepdims=True)
    falling = np.roll(y, -1, axis=-1) < y
    stroke = np.where(falling, top - y, y - bottom)
    if rule == "following":
        return stroke / 2.0
    if rule == "error":
        return np.minimum(stroke, np.maximum(np.abs(y), count)) / 2.0
    return (top - bottom) / 4.0 + 0.0 * y  # frozen: half of the error at the reversal


def _cascade(p: dict, y: np.ndarray, vh: np.ndarray, theta: np.ndarray, limit: float, dt: float) -> np.ndarray:
    """The law of workbench.control.pi_cascade along the phase, its integral stepped until it repeats."""
    error = np.clip(-p["kv"] * y, -p["speed_limit"], p["speed_limit"]) - vh
    phases = y.shape[-1]
    width = 2.0 * np.pi / phases
    grown = shifted(error, (theta - width) / 2.0) * (p["ki"] * dt * width / theta)  # it acts a sample late, not a phase
    start, u, integrals = np.zeros(y.shape[:-1]), np.empty(y.shape), np.empty(y.shape)
    for _ in range(CYCLES):
        integral = start
        for k in range(phases):
            integrals[..., k] = integral
            u[..., k] = asked = p["kvp"] * error[..., k] + integral
            free = (np.abs(asked) <= limit) | (asked * error[..., k] < 0.0)
            integral = np.where(free, np.clip(integral + grown[..., k], -limit, limit), integral)
        start = integral - integrals.mean(axis=-1)  # a cycle about the target has no mean
    return clipped(u, limit)


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
