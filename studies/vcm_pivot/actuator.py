"""Fig. 1 again: K and P_res out of a frequency response of the simulated actuator, by the workbench's own modal fit.

The analyser shakes the loop at its input at 48 kHz, because at 12 kHz the second mode lies beyond the band.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from workbench.frequency.amplitude import multisine
from workbench.frequency.modes import Modes, fit_modes
from workbench.frequency.response import Response, response_of
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION
from workbench.simulation.recorded import record_of

from .loop import K0, MODES, ZEROS, Preset
from .machine import Given, Machine

FAST = 48_000.0
PERIOD, PERIODS = 0.1, 8  # s; the first is left out
LOWEST, HIGHEST = 300.0, 18_000.0  # Hz of the lines
SHAKEN = 1.0  # V rms
ANALYSER = Preset("analyser", 0.1)  # a soft loop that holds the head meanwhile


@dataclass(frozen=True, eq=False)
class Actuator:
    """response: acceleration over drive. modes: as fitted. gain: K0, V/(V s^2). zero: (Hz, damping ratio)."""

    response: Response
    modes: Modes
    gain: float
    zero: tuple[float, float]


def measured(windage: float, sensor: float) -> Actuator:
    """Return what a noisy frequency response of the actuator says of eq. (2)."""
    n = round(PERIOD * FAST)
    wave = multisine(np.arange(round(LOWEST * PERIOD), round(HIGHEST * PERIOD)), n, SHAKEN, 1)
    push = np.tile(wave, PERIODS)
    machine = Machine(ANALYSER, windage=windage, sensor=sensor, rate=FAST)
    seen = machine.run(Given(np.zeros(push.size), force=push))
    time = np.arange(push.size) / FAST
    record = record_of(
        "analyser", IDENTIFICATION, Plant(ONE_MASS, rotary=False), time,
        {"force": seen["u"] + push, "position": seen["y"]}, {}, f"{PERIOD:g} s multisine at the actuator's input",
    )  # fmt: skip
    response = response_of(record)
    response = response.where((response.frequency >= LOWEST) & (response.frequency < HIGHEST))
    modes = fit_modes(response)
    return Actuator(response, modes, float(abs(modes.at(np.array([LOWEST]))[0])), zero_of(modes))


def zero_of(modes: Modes) -> tuple[float, float]:
    """Return frequency (Hz) and damping ratio of the zero next to the first mode."""
    near = min(modes.modes, key=lambda m: m.frequency)
    numerator = np.zeros(1)
    for k in range(len(modes.poles)):
        term = np.append(modes.residues[2 * k : 2 * k + 2], 0.0)
        for j, (w, z) in enumerate(modes.poles):
            term = np.polymul(term, [1.0, 2 * z * w, w * w]) if j != k else term
        numerator = np.polyadd(numerator, term)
    whole = np.array([modes.residues[-1]])
    for w, z in modes.poles:
        whole = np.polymul(whole, [1.0, 2 * z * w, w * w])
    roots = np.roots(np.polyadd(numerator, whole))
    s = min(roots, key=lambda r: abs(abs(r) / (2 * pi) - near.frequency))
    return float(abs(s) / (2 * pi)), float(-s.real / abs(s))


def expected() -> dict[str, float]:
    """Return what eq. (2) says: frequencies in Hz, damping ratios, and K0."""
    found = {"gain": K0}
    for name, polynomial in (("first", MODES[0]), ("second", MODES[1]), ("zero", ZEROS)):
        w = float(np.sqrt(polynomial[2]))
        found |= {f"{name}_frequency": w / (2 * pi), f"{name}_damping": polynomial[1] / (2 * w)}
    return found
