"""Frequency responses of the loop by stepped sines, and what the linear loop without friction would do."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.frequency.amplitude import ClosedLoop, first_harmonic, in_closed_loop

from .loop import PLANT, RATE, TS, Preset, integrator
from .machine import Given, Machine
from .records import MILLI, period_of, sine

STEPPED = tuple(RATE / period_of(f) for f in (5, 7, 10, 14, 20, 28, 40, 50, 60, 70, 80, 100, 120, 150, 200, 300))
SETTLE, LOCKED = 0.6, 0.2  # s of settling and of lock-in a frequency; twice as long changes 0.02 dB


@dataclass(frozen=True, eq=False)
class Stepped:
    """frequency (n,) Hz; amplitude (n,) of x, V; plant (n,): x over the controller's own command; sensitivity (n,):
    error over what disturbs."""

    frequency: np.ndarray
    amplitude: np.ndarray
    plant: np.ndarray
    sensitivity: np.ndarray

    @property
    def omega(self) -> np.ndarray:
        return 2 * np.pi * self.frequency

    @property
    def over_integrator(self) -> np.ndarray:
        """x over u relative to the pure double integrator, dB."""
        return decibel(self.plant / integrator(self.omega))


def decibel(value) -> np.ndarray:
    return 20.0 * np.log10(np.abs(value))


def stepped(
    machine: Machine, amplitude: float, frequencies: Sequence[float] = STEPPED, where: str = "reference"
) -> Stepped:
    """Return the responses to sines of an amplitude (V) at the reference, "output" or "force" (there 1 mV a V).

    Of a force, sensitivity is the error over it, V/V.
    """
    rows = []
    for f in frequencies:
        periods = max(1, int(np.ceil(LOCKED * f)))
        wave, keep = sine(f, amplitude, periods, SETTLE)
        if where == "reference":
            given, size = Given(wave), amplitude
        else:
            size = amplitude if where == "output" else amplitude / MILLI
            given = Given(np.zeros(wave.size), **{where: wave * size / amplitude})
        seen = machine.run(given)
        error = given.reference - seen["x"] - (0.0 if given.output is None else given.output)
        x, u, e = (first_harmonic(s[-keep:], f, TS) for s in (seen["x"], seen["c"], error))
        rows.append((abs(x), x / u, e / size))
    a, p, s = zip(*rows, strict=True)
    return Stepped(np.array(frequencies), np.array(a), np.array(p), np.abs(np.array(s)))


def described(preset: Preset, bank, size: float, frequencies: Sequence[float]) -> ClosedLoop:
    """Return the loop with the describing function of a bank (mV/V), its closed-loop amplitude solved for."""
    omega = 2 * np.pi * np.asarray(frequencies)
    return in_closed_loop(
        PLANT.response(omega), preset.controller(omega), lambda a, w: bank.response(a, w) / MILLI, size, omega
    )


def linear_sensitivity(preset: Preset, frequencies: Sequence[float]) -> np.ndarray:
    """Return |S| of the loop on the plant without friction."""
    omega = 2 * np.pi * np.asarray(frequencies)
    return np.abs(1.0 / (1.0 + preset.controller(omega) * PLANT.response(omega)))
