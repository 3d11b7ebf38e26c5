"""What tuning returns."""

from dataclasses import dataclass

import numpy as np

from workbench.errors import WorkbenchError
from workbench.finding import Finding


@dataclass(frozen=True)
class Gains:
    """PD gains u = Kp (r - y) - Kd vh at each amplitude; arrays (n,), read-only, SI.

    amplitude: A, rad or m. kp: N*m/rad or N/m. kd: N*m*s/rad or N*s/m.
    time: s, until the linear response enters the band and stays. overshoot: of its final value.
    sensitivity_peak: Ms of the exact sampled loop, its peak found between frequencies. spectral_radius: of the same loop,
    stable below 1. gain_margin: ratio; phase_margin: rad; nan where they were not asked for, inf where there is none.
    error_ratio: k_e/(k_e + Kp), the share of a step that stays.
    binding: at each amplitude, the limits that stop the gains ("overshoot", "drive", "speed", "error", "sensitivity",
    "damping" where the axis alone is damped enough and Kd is at its floor).
    """

    amplitude: np.ndarray
    kp: np.ndarray
    kd: np.ndarray
    time: np.ndarray
    overshoot: np.ndarray
    sensitivity_peak: np.ndarray
    spectral_radius: np.ndarray
    gain_margin: np.ndarray
    phase_margin: np.ndarray
    error_ratio: np.ndarray
    binding: tuple[tuple[str, ...], ...]
    findings: tuple[Finding, ...] = ()

    def __post_init__(self):
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                copy = np.array(value, dtype=float)
                copy.flags.writeable = False
                object.__setattr__(self, name, copy)
        check_gains(self.amplitude, self.kp, self.kd)


def check_gains(amplitude: np.ndarray, kp: np.ndarray, kd: np.ndarray) -> None:
    """Raise WorkbenchError unless amplitudes are positive and increase, and gains are finite and not negative."""
    if not (amplitude.ndim == 1 and amplitude.size and amplitude.shape == kp.shape == kd.shape):
        raise WorkbenchError(
            f"gains: amplitude, kp and kd must be arrays of one length; they are {amplitude.shape}, {kp.shape}, {kd.shape}."
        )
    check_amplitude(amplitude)
    for name, values in (("kp", kp), ("kd", kd)):
        wrong = ~(np.isfinite(values) & (values >= 0.0))
        if wrong.any():
            i = int(np.argmax(wrong))
            raise WorkbenchError(
                f"gains: {name} at amplitude {amplitude[i]:g} is {values[i]:g}; gains must be finite and not negative."
            )


def check_amplitude(amplitude: np.ndarray) -> None:
    """Raise WorkbenchError unless amplitudes are finite, positive and increase."""
    if not (np.isfinite(amplitude).all() and (amplitude > 0.0).all()):
        raise WorkbenchError("amplitudes must be finite and positive.")
    falls = np.flatnonzero(np.diff(amplitude) <= 0.0)
    if falls.size:
        i = int(falls[0])
        raise WorkbenchError(
            f"amplitudes must increase: number {i + 2}, {amplitude[i + 1]:g}, is not above {amplitude[i]:g}."
        )
