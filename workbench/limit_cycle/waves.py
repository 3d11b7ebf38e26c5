"""Periodic waveforms and their harmonics: y(f) = sum Re q_k exp(i k f) over odd k, arrays (..., n) over the orders (n,)."""

from collections.abc import Callable

import numpy as np

TURNING = 64  # phases of a cycle among which a turning point is sought
STEPS = 4  # of Newton, to a turning point and to where it is found


def along(q: np.ndarray, orders: np.ndarray, first: np.ndarray, width: float, count: int) -> np.ndarray:
    """Return sum Re q_k exp(i k f) of harmonics (..., n) at `count` phases from `first` (...) on, (..., count)."""
    turned_on = q * np.exp(1j * orders * first[..., None])
    waves = np.exp(1j * width * np.outer(orders, np.arange(count)))
    flat = turned_on.reshape(-1, orders.size)
    return (flat.real @ waves.real - flat.imag @ waves.imag).reshape(*turned_on.shape[:-1], count)


def _value(q: np.ndarray, orders: np.ndarray, phase: np.ndarray) -> np.ndarray:
    """Return sum Re q_k exp(i k f) of harmonics (..., n) at one phase each, (...)."""
    return (q * np.exp(1j * orders * phase[..., None])).real.sum(axis=-1)


def turning(q: np.ndarray, orders: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (phase, y) of the largest reading over a cycle, (...)."""
    if orders.size == 1:
        return -np.angle(q[..., 0]), np.abs(q[..., 0])
    width = 2.0 * np.pi / TURNING
    phase = width * along(q, orders, np.zeros(q.shape[:-1]), width, TURNING).argmax(axis=-1)
    for _ in range(STEPS):
        slope, bend = (_value(q * (1j * orders) ** m, orders, phase) for m in (1, 2))
        phase = phase - slope / np.minimum(bend, -1e-300)
    return phase, _value(q, orders, phase)


def found_after(q: np.ndarray, orders: np.ndarray, turn: np.ndarray, back: float, theta: np.ndarray) -> np.ndarray:
    """Return the phase after a turning point `turn` (...) at which the reading has come back by `back`; at most a quarter cycle.

    What it comes back from is the furthest sample: within half a sample of the turning point, on average theta^2/24 of the
    reading's bend below it.
    """
    top, bend = _value(q, orders, turn), -_value(q * (1j * orders) ** 2, orders, turn)
    below = back + np.maximum(bend, 0.0) * theta**2 / 24.0
    ahead = np.sqrt(2.0 * below / np.maximum(bend, 1e-300))
    for _ in range(STEPS):
        phase = turn + np.minimum(ahead, np.pi / 2.0)
        left = top - below - _value(q, orders, phase)
        ahead = phase - turn + left / np.minimum(_value(q * (1j * orders), orders, phase), -1e-300)
    return np.clip(ahead, 0.0, np.pi / 2.0)


def shifted(x: np.ndarray, by: np.ndarray) -> np.ndarray:
    """Return a periodic x (..., phases) later by a phase (..., 1)."""
    spectrum = np.fft.rfft(x, axis=-1)
    return np.fft.irfft(spectrum * np.exp(-1j * by * np.arange(spectrum.shape[-1])), x.shape[-1], axis=-1)


def passed(u: np.ndarray, theta: np.ndarray, response: Callable[[np.ndarray], np.ndarray], halved: bool) -> np.ndarray:
    """Return what a filter of response(theta) lets through of a periodic u (..., n): over a cycle, or over half of one whose other
    half is its negative, then (..., n + 1) with where the next half begins. theta (...): rad a sample, of the cycle."""
    whole = np.concatenate([u, -u], axis=-1) if halved else u
    spectrum = np.fft.rfft(whole, axis=-1)
    out = np.fft.irfft(spectrum * response(theta[..., None] * np.arange(spectrum.shape[-1])), whole.shape[-1], axis=-1)
    return out[..., : u.shape[-1] + 1] if halved else out


def clipped(u: np.ndarray, limit: float) -> np.ndarray:
    """Return the mean of u (..., n + 1) within +-limit between each two phases, (..., n), with u linear between them.

    A waveform that is nearly square changes its sign between two phases: so its harmonics move smoothly with where.
    """
    now, onward = u[..., :-1], u[..., 1:]
    rise = onward - now
    flat = np.abs(rise) < 1e-9 * limit
    area = _area(u, limit)
    return np.where(flat, np.clip((now + onward) / 2.0, -limit, limit), area[..., 1:] - area[..., :-1]) / np.where(
        flat, 1.0, rise
    )


def harmonics_of(mean: np.ndarray, first: np.ndarray, orders: np.ndarray, width: float) -> np.ndarray:
    """Return U_k of u = sum Re U_k exp(i k f), (..., orders), of means (..., n) over spans of this width that follow each
    other over a cycle, or over half of one whose other half is its negative. first: middle of the first span, (...).

    The means have made harmonic k smaller by cos(k width/2), which is undone.
    """
    n = mean.shape[-1]
    waves = np.exp(-1j * width * np.outer(np.arange(n), orders)) * (2.0 / n / np.cos(orders * width / 2.0))
    flat = mean.reshape(-1, n)
    out = (flat @ waves.real + 1j * (flat @ waves.imag)).reshape(*mean.shape[:-1], len(orders))
    return out * np.exp(-1j * first[..., None] * orders)


def _area(u: np.ndarray, limit: float) -> np.ndarray:
    """Integral of the limited u over u."""
    size = np.abs(u)
    return np.where(size <= limit, u * u / 2.0, limit * size - limit * limit / 2.0)
