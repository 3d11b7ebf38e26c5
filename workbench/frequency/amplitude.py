"""Frequency responses of a loop whose plant holds a force with memory: they depend on the amplitude, so it is solved for.

Three views that differ by nature. The describing function with the amplitude that the closed loop itself brings
(`in_closed_loop`) costs milliseconds; a stepped sine in the simulated or real loop, locked in over whole periods
(`first_harmonic`), is what it approximates; the best linear approximation under a random-phase multisine (`best_linear`)
is another object, for a motion of many frequencies, and its scatter from phase to phase says how nonlinear the axis is.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workbench.errors import WorkbenchError

ROUNDS = 100  # of the fixed point; where friction is a small part of the loop's stiffness ten do
SETTLED = 1e-9  # relative change of the amplitude


@dataclass(frozen=True, eq=False)
class ClosedLoop:
    """omega (n,) rad/s; amplitude (n,): of the position; plant (n,): position over drive at that amplitude; sensitivity
    (n,): error over reference."""

    omega: np.ndarray
    amplitude: np.ndarray
    plant: np.ndarray
    sensitivity: np.ndarray


def with_force(plant: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Return position over drive of a plant whose input loses a force N x: P/(1 + P N), (n,)."""
    return plant / (1.0 + plant * force)


def in_closed_loop(plant: np.ndarray, feedback: np.ndarray, force: Callable, size, omega: np.ndarray) -> ClosedLoop:
    """Return the loop's response to a reference of amplitude `size` (scalar or (n,)), by the describing function.

    plant, feedback (n,): P and C at omega (n,). force(amplitude (n,), omega (n,)): N, the force's describing function. The
    amplitude A = |C P/(1 + P N(A) + P C)| size is a fixed point. WorkbenchError where it does not settle.
    """
    omega = np.asarray(omega, dtype=float)
    size = np.broadcast_to(np.asarray(size, dtype=float), omega.shape)
    loop = plant * feedback
    amplitude = size
    for _ in range(ROUNDS):
        stiff = force(amplitude, omega)
        following = np.abs(loop / (1.0 + plant * stiff + loop)) * size
        moved = np.abs(following - amplitude).max() / size.max()
        amplitude = following
        if moved < SETTLED:
            break
    else:
        raise WorkbenchError(
            f"the amplitude of the closed loop still changes by {moved:.1g} after {ROUNDS} rounds: the force is no small "
            "part of the loop there; take a stepped sine instead."
        )
    seen = with_force(plant, stiff)
    return ClosedLoop(omega, amplitude, seen, 1.0 / (1.0 + seen * feedback))


def first_harmonic(signal: np.ndarray, frequency: float, dt: float) -> np.ndarray:
    """Return the complex amplitude (...,) of a signal (..., n) at a frequency in Hz, over the whole periods at its end."""
    signal = np.asarray(signal, dtype=float)
    period = 1.0 / (frequency * dt)
    n = int(round(int(signal.shape[-1] / period + 1e-9) * period))
    if n < 1:
        raise WorkbenchError(
            f"{signal.shape[-1]} samples hold no whole period of {frequency:g} Hz; record {period:.0f} or more."
        )
    turn = np.exp(-2j * np.pi * frequency * dt * np.arange(n))
    return 2.0 / n * signal[..., -n:] @ turn


def multisine(lines: np.ndarray, period: int, rms: float, seed: int) -> np.ndarray:
    """Return one period (n,) of equal cosines with random phases. lines: numbers of periods, integers below n/2.

    Odd lines alone leave even ones free, where an even nonlinearity of the force shows.
    """
    spectrum = np.zeros(period // 2 + 1, dtype=complex)
    spectrum[lines] = np.exp(2j * np.pi * np.random.default_rng(seed).random(len(lines)))
    x = np.fft.irfft(spectrum, period)
    return x * (rms / np.sqrt(np.mean(x**2)))


@dataclass(frozen=True, eq=False)
class BestLinear:
    """value (n,): mean over realisations. noise (n,): standard deviation of one realisation's mean over periods. total
    (n,): standard deviation from realisation to realisation; what it holds beyond noise is nonlinear. Of |value|."""

    value: np.ndarray
    noise: np.ndarray
    total: np.ndarray


def best_linear(reference: np.ndarray, drive: np.ndarray, position: np.ndarray, lines: np.ndarray) -> BestLinear:
    """Return position over drive at the lines of multisines: the best linear approximation in the loop.

    reference (m, n): one period of each realisation. drive, position (m, p, n): settled periods of each, p >= 2. Both are
    taken relative to the reference, so that the loop's noise does not bias them (Pintelon and Schoukens 2012).
    """
    if drive.ndim != 3 or drive.shape[0] < 2 or drive.shape[1] < 2:
        raise WorkbenchError("a best linear approximation needs two realisations and two settled periods of each.")
    r = np.fft.rfft(reference, axis=-1)[:, None, lines]
    u, x = (np.fft.rfft(s, axis=-1)[..., lines] / r for s in (drive, position))
    each = x.mean(axis=1) / u.mean(axis=1)
    value = x.mean(axis=(0, 1)) / u.mean(axis=(0, 1))
    periods = drive.shape[1]
    slips = (x - value * u) / u.mean(axis=1, keepdims=True)
    noise = np.sqrt(np.mean(np.var(slips, axis=1, ddof=1), axis=0) / periods)
    return BestLinear(value, noise, np.std(each, axis=0, ddof=1))
