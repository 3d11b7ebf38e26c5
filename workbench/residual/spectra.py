"""A residual over frequency, and over order: the spectrum over position, in which what is periodic in an angle is a line."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.frequency.spectra import densities
from workbench.inverse.dynamics import InverseDynamics
from workbench.residual.orders import order_spectrum, peaks

POINTS = 200  # of a spectrum over frequency
LINES = 64  # of resolution below the evaluation bandwidth
HIGHEST = 1.2  # frequency shown, over the bandwidth
COLUMNS = 500  # of a spectrum over order as it is drawn: the largest value of each
MOVING = 0.01  # of the rms speed, above which an axis moves
OCTAVE = 2.0**0.5
STANDS_OUT = 4.0  # a peak over the median about it from which it is called a line


@dataclass(frozen=True, eq=False)
class Spectrum:
    """A residual's amplitude (m,) over `at` (m,): over frequency in Hz its density in N*m/sqrt(Hz), over order in N*m.

    lines: (order, times the median of an octave about it) of the largest peaks, the one that stands out most first. band:
    the narrowest stretch that holds half of the power.
    """

    coordinate: str
    unit: str
    at: np.ndarray
    amplitude: np.ndarray
    lines: tuple[tuple[float, float], ...] = ()
    band: tuple[float, float] = (float("nan"), float("nan"))


def _split(inverses: Sequence[InverseDynamics], residual: np.ndarray) -> list[np.ndarray]:
    """Return a pooled residual (n,) as one (n_i,) a record."""
    ends = np.cumsum([p.motion.keep.stop - p.motion.keep.start for p in inverses])
    return np.split(residual, ends[:-1])


def over_frequency(inverses: Sequence[InverseDynamics], residual: np.ndarray) -> Spectrum:
    """Return the density of a residual (n,) over frequency, the records weighed by their lengths (Welch 1967)."""
    band = max(p.motion.filter.bandwidth for p in inverses)
    at = np.linspace(0.0, HIGHEST * band, POINTS)
    total, weight = np.zeros(POINTS), 0.0
    for p, r in zip(inverses, _split(inverses, residual), strict=True):
        rate = 1 / p.motion.dt
        segment = min(r.size, int(rate / band * LINES))
        f, density, *_ = densities(r, r, rate, segment, straightened=False)
        total, weight = total + r.size * np.interp(at, f, density), weight + r.size
    power = total / weight
    return Spectrum("frequency", "Hz", at, np.sqrt(power), band=half(at, power))


def half(at: np.ndarray, power: np.ndarray) -> tuple[float, float]:
    """Return the narrowest stretch that holds half of a power (m,)."""
    total = np.concatenate([[0.0], np.cumsum(power)])
    if not total[-1] > 0.0:
        return float("nan"), float("nan")
    ends = np.searchsorted(total, total[:-1] + 0.5 * total[-1])
    reached = np.flatnonzero(ends < total.size)
    k = reached[np.argmin(ends[reached] - reached)]
    return float(at[k]), float(at[min(ends[k] - 1, at.size - 1)])


def over_order(inverses: Sequence[InverseDynamics], residual: np.ndarray, unit: str) -> Spectrum:
    """Return the amplitude of a residual (n,) over order, thinned to its largest values. unit: of position.

    Orders reach to the one that passes the evaluation filter at the median speed of what moves. Where an axis moves so fast
    that two samples lie farther apart than half of its wave, a sample says nothing of it and is left out: else a stretch of
    constant speed would show its own sampling as a line.
    """
    speed = np.abs(np.concatenate([p.motion.v[p.motion.keep] for p in inverses]))
    typical = float(np.median(speed[speed >= MOVING * np.sqrt(np.mean(speed**2))]))
    highest = 2 * np.pi * max(p.motion.filter.bandwidth for p in inverses) / max(typical, 1e-300)
    whole = []
    for p, r in zip(inverses, _split(inverses, residual), strict=True):
        full = np.zeros(p.motion.u.size)
        full[p.motion.keep] = np.where(np.abs(p.motion.v[p.motion.keep]) * p.motion.dt * highest <= np.pi, r, 0.0)
        whole.append(full)
    travel = max(float(np.ptp(p.motion.q)) for p in inverses)
    orders, amplitude = order_spectrum(inverses, whole)
    shown = (orders * travel > 2 * np.pi) & (orders <= highest)
    orders, amplitude = orders[shown], amplitude[shown]
    if orders.size < 3:
        return Spectrum("order", f"1/{unit}", orders, amplitude)
    found = peaks(orders, amplitude, travel)
    lines = sorted(((k, _above(orders, amplitude, k)) for k in found), key=lambda line: -line[1])
    groups = np.array_split(np.arange(orders.size), min(COLUMNS, orders.size))
    top = [g[np.argmax(amplitude[g])] for g in groups if g.size]
    return Spectrum("order", f"1/{unit}", orders[top], amplitude[top], tuple(lines))


def _above(orders: np.ndarray, amplitude: np.ndarray, k: float) -> float:
    """Return how many times the median of the octave about it the amplitude at order k is: what falls evenly has no line."""
    about = amplitude[(orders > k / OCTAVE) & (orders < k * OCTAVE)]
    middle = float(np.median(about))
    return float(amplitude[np.argmin(np.abs(orders - k))]) / middle if middle > 0.0 else 0.0
