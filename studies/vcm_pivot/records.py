"""Records of the loop under sines: periods averaged, and the friction got out of them.

f = u - u_a with u_a = x divided by the plant behind its zero-order hold, on whole periods and within a band. Differencing
x twice would leave errors of twice the friction.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.hysteresis.fit import Periodic

from .loop import CALIBRATED, PLANT, RATE, TS
from .machine import Given, Machine

MILLI = 1e3  # mV a V: forces are in mV and their gains in mV/V, as the printed weights only make sense
PEAK_TO_PEAK = ((10.0, 0.25), (10.0, 0.5), (10.0, 1.5))  # (Hz, V zero to peak): 0.5, 1, 3 V read peak to peak
AMPLITUDE = ((10.0, 0.5), (10.0, 1.0), (10.0, 3.0))
MANY = tuple((f, a) for f in (2.0, 10.0, 40.0, 100.0) for a in (0.1, 0.25, 0.6, 1.5))
HELD_OUT = ((50.0, 1.0), (10.0, 1.0), (25.0, 0.35), (5.0, 0.7), (80.0, 0.3), (10.0, 3.0))
BAND, HARMONICS = 250.0, 5.0  # Hz; of faster motions as many harmonics, and no frequency beyond 2 kHz is near
POINTS = 120  # a period of what is fitted: 60 harmonics
SETTLE = 1.0  # s before anything is kept: three times the slowest creep


@dataclass(frozen=True)
class Noise:
    """windage, sensor: standard deviations, V. averages: periods a record has. count: of the converters, V, or 0."""

    windage: float = 0.0
    sensor: float = 0.0
    averages: int = 3
    count: float = 0.0


@dataclass(frozen=True, eq=False)
class Extracted:
    """record: x in V, f in mV as got out. true: f in mV of the pivot itself, same band and points."""

    frequency: float
    amplitude: float
    record: Periodic
    true: np.ndarray


def period_of(frequency: float) -> int:
    """Return the samples of a period, so that it is whole."""
    return round(RATE / frequency)


def sine(frequency: float, amplitude: float, periods: int, settle: float = SETTLE) -> tuple[np.ndarray, int]:
    """Return (reference (n,), samples that count at its end): whole periods after whole periods of settling."""
    p = period_of(frequency)
    before = int(np.ceil(settle * RATE / p)) * p
    k = np.arange(before + periods * p)
    return amplitude * np.sin(2 * np.pi * k / p), periods * p


def settled(machine: Machine, frequency: float, amplitude: float, periods: int) -> dict[str, np.ndarray]:
    """Return the signals of the loop over settled periods, (periods, n) each."""
    reference, keep = sine(frequency, amplitude, periods)
    found = machine.run(Given(reference)) | {"r": reference}
    return {n: v[-keep:].reshape(periods, -1) for n, v in found.items()}


def extract(seen: dict[str, np.ndarray], band: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (x V, f mV, true f mV), (POINTS,) each, of averaged periods (p, n), up to `band` Hz."""
    x, u, f = (np.fft.rfft(seen[n].mean(axis=0)) for n in ("y", "u", "f"))
    n = seen["y"].shape[1]
    frequency = np.fft.rfftfreq(n, TS)
    inside = (frequency > 0.0) & (frequency <= band)
    got = np.zeros_like(x)
    got[inside] = u[inside] - x[inside] / PLANT.response(2 * np.pi * frequency[inside])

    def points(spectrum, scale=1.0):
        spectrum = np.where(inside, spectrum, 0.0)[: POINTS // 2 + 1]
        spectrum = np.pad(spectrum, (0, POINTS // 2 + 1 - spectrum.size))
        return scale * POINTS / n * np.fft.irfft(spectrum, POINTS)

    return points(x), points(got, MILLI), points(f, MILLI)


def measured(
    conditions: Sequence[tuple[float, float]], noise: Noise, machine: Machine | None = None
) -> list[Extracted]:
    """Return what is got out of a record of each condition (Hz, V)."""
    base = machine or Machine(CALIBRATED)
    found = []
    for k, (frequency, amplitude) in enumerate(conditions):
        m = Machine(
            base.preset,
            base.pivot,
            base.compensation,
            base.observer,
            noise.windage,
            noise.sensor,
            noise.count,
            seed=k + 1,
        )
        exact = RATE / period_of(frequency)
        band = min(max(BAND, HARMONICS * exact), 0.5 * POINTS * exact - exact)
        x, f, true = extract(settled(m, frequency, amplitude, noise.averages), band)
        found.append(Extracted(exact, amplitude, Periodic(x, f, 1.0 / (exact * POINTS), band), true))
    return found


def floor(found: Sequence[Extracted]) -> float:
    """Return the energy gain of the extraction's own error, mV/V: no model can be asked to leave less."""
    left = sum(np.sum((e.record.f - e.true) ** 2) for e in found)
    return float(np.sqrt(left / sum(np.sum(e.record.x**2) for e in found)))


def against_true(bank, found: Sequence[Extracted]) -> float:
    """Return the energy gain of a bank (mV/V) against the pivot itself."""
    weights = np.concatenate([[bank.stiffness], bank.springs, bank.creeps])
    left = sum(np.sum((e.true - e.record.columns(bank.radii, bank.rates) @ weights) ** 2) for e in found)
    return float(np.sqrt(left / sum(np.sum(e.record.x**2) for e in found)))
