"""Eqs. (1) and (2): plant and controller as printed, the preset that has the printed crossover, and their margins.

Position x and drive u are voltages (0.5 um/V at the vibrometer); friction is a voltage at the plant's input.
"""

from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np
from scipy.linalg import expm

RATE = 12_000.0  # Hz; 83.3 us. "83.3 ms" as printed has a Nyquist frequency of 6 Hz, below the 10 Hz of the test
TS = 1.0 / RATE
K = 1.2052e17
ZEROS = (1.0, 1081.0, 7.3e8)
MODES = ((1.0, 1056.0, 6.964e8), (1.0, 6032.0, 2.527e9))
K0 = K * ZEROS[2] / (MODES[0][2] * MODES[1][2])  # V/(V s^2), of the double integrator at low frequency
FILTER = ((0.9023, 0.9467, 0.7242), (1.0, 0.929, 0.6442))
KP, KD, KI = 0.8, 400e-6, 400.0


@dataclass(frozen=True)
class Preset:
    """kc: gain of eq. (1)."""

    name: str
    kc: float

    def controller(self, omega: np.ndarray) -> np.ndarray:
        """Return C(exp(j w Ts))."""
        z = np.exp(1j * np.asarray(omega) * TS)
        pid = KP + KD * (z - 1.0) / (TS * z) + KI * TS / (z - 1.0)
        return self.kc * pid * np.polyval(FILTER[0], z) / np.polyval(FILTER[1], z)


PRINTED = Preset("printed", 0.0625)
CALIBRATED = Preset("calibrated", 0.27)  # the gain for which the crossover is the printed 945 Hz
WEAK = Preset("weak", 0.02)  # held up by the pivot's stiffness alone


class Plant:
    """K P_res(s)/s^2 with states (mode, mode, v, x). a, b: continuous."""

    def __init__(self):
        self.a, self.b = np.zeros((6, 6)), np.zeros(6)
        scale = [np.sqrt(m[2]) for m in MODES]
        for i, (m, w) in enumerate(zip(MODES, scale, strict=True)):
            self.a[2 * i, 2 * i + 1] = w
            self.a[2 * i + 1, 2 * i : 2 * i + 2] = -w, -m[1]
        # first section: 1 + ((z1 - m1) s + z0 - m0)/(s^2 + m1 s + m0); states p, p'/w of u/(...) times w
        m, w = MODES[0], scale[0]
        self.b[1] = w
        out = np.zeros(6)
        out[0], out[1] = (ZEROS[2] - m[2]) / w**2, (ZEROS[1] - m[1]) / w
        # second section: 1/(s^2 + ...) with unit static gain, driven by the first one
        self.a[3] += scale[1] * out
        self.b[3] = scale[1]
        self.a[4, 2] = K / MODES[1][2]
        self.a[5, 4] = 1.0

    def sampled(self, h: float) -> tuple[np.ndarray, np.ndarray]:
        """Return (A, B) over a step of h s with the drive held."""
        whole = np.zeros((7, 7))
        whole[:6, :6], whole[:6, 6] = self.a, self.b
        found = expm(whole * h)
        return found[:6, :6], found[:6, 6]

    @cached_property
    def held(self) -> tuple[np.ndarray, np.ndarray]:
        return self.sampled(TS)

    def response(self, omega: np.ndarray) -> np.ndarray:
        """Return the pulse response function of the plant behind a zero-order hold, at w (n,)."""
        a, b = self.held
        z = np.exp(1j * np.atleast_1d(omega) * TS)
        return np.linalg.solve(z[:, None, None] * np.eye(6) - a, np.broadcast_to(b[:, None], (z.size, 6, 1)))[:, 5, 0]


PLANT = Plant()


def continuous(omega: np.ndarray) -> np.ndarray:
    """Return K P_res(jw)/(jw)^2."""
    s = 1j * np.asarray(omega, dtype=float)
    return K * np.polyval(ZEROS, s) / (np.polyval(MODES[0], s) * np.polyval(MODES[1], s)) / s**2


def integrator(omega: np.ndarray) -> np.ndarray:
    """Return the pure double integrator K0/s^2 behind a zero-order hold."""
    z = np.exp(1j * np.asarray(omega, dtype=float) * TS)
    return K0 * TS**2 / 2.0 * (z + 1.0) / (z - 1.0) ** 2


@dataclass(frozen=True)
class Margins:
    """crossover Hz, phase margin deg, gain margin dB at Hz, lower gain margin dB (how far the gain may fall), Ms dB."""

    crossover: float
    phase: float
    gain: float
    gain_at: float
    lower: float
    sensitivity: float


def margins(preset: Preset, extra=lambda omega: 1.0, force=0.0) -> Margins:
    """Return the margins of a loop by python-control, from its frequency response.

    extra(omega): a factor of the loop. force: stiffness to ground, V/V, scalar or one value a frequency of `GRID`.
    """
    import control

    p = PLANT.response(GRID)
    loop = preset.controller(GRID) * p / (1.0 + force * p) * extra(GRID)
    frd = control.FrequencyResponseData(loop, GRID, smooth=True)
    gains, phases, _, at, crossings, _ = control.stability_margins(frd, returnall=True)
    # the crossover is the last one: below it friction may hold the loop gain near one
    last = int(np.argmax(crossings)) if len(crossings) else None
    up = [(g, w) for g, w in zip(gains, at, strict=True) if g > 1.0]
    down = [g for g in gains if g < 1.0]
    gain, where = min(up) if up else (np.inf, np.nan)
    return Margins(
        crossings[last] / (2 * pi) if last is not None else np.nan,
        phases[last] if last is not None else np.nan,
        20 * np.log10(gain),
        where / (2 * pi),
        20 * np.log10(max(down)) if down else -np.inf,
        20 * np.log10(np.max(1.0 / np.abs(1.0 + loop))),
    )


GRID = 2 * pi * np.geomspace(20.0, 5990.0, 4000)


def notch() -> dict[str, float]:
    """Return frequency (Hz) and damping ratio of the filter's zeros and poles, read at the sample time."""
    found = {}
    for name, polynomial in zip(("zero", "pole"), FILTER, strict=True):
        s = np.log(np.roots(polynomial)[0]) * RATE
        found[f"{name}_frequency"] = float(abs(s) / (2 * pi))
        found[f"{name}_damping"] = float(-s.real / abs(s))
    return found
