"""The synthetic pivot in its loop: 48 kHz inside 12 kHz, by pivot.json, and nothing of it shared with the workbench.

f = k0 x + k3 x^3 + c v + sum_j w_j (x - l_j) + sum_i k_i (x - play_(r_i h)[x]), h = 1 + gain ln(1 + |v|/velocity).
It is not in any class that is fitted: limits that grow with speed, a cubic, a viscous part, ten creep rates. Its figures
are a property of this choice; the measured pivot is not available.
"""

import json
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

import numpy as np

from .kernel import SUBSTEPS, run
from .loop import FILTER, K0, KD, KI, KP, PLANT, RATE, TS, Preset

WINDAGE = 500.0  # Hz, of its low pass
MEASURED, REFERENCE = 0, 1  # what drives the compensation


@dataclass(frozen=True)
class Pivot:
    """The law's numbers in V and s. law: k0, k3, viscous, rate_gain, rate_velocity. slipping factors scale it."""

    law: np.ndarray
    radii: np.ndarray
    springs: np.ndarray
    rates: np.ndarray
    weights: np.ndarray

    def scaled(self, force: float = 1.0, breakaway: float = 1.0) -> "Pivot":
        """Return the pivot with all of its force, or its break-away displacements, times a factor."""
        law = self.law.copy()
        law[:3] *= force
        return Pivot(law, self.radii * breakaway, self.springs * force, self.rates, self.weights * force)


@cache
def pivot() -> Pivot:
    """Return the pivot of pivot.json."""
    d = json.loads((Path(__file__).parent / "pivot.json").read_text(encoding="utf-8"))
    law = [1e-3 * d["k0_mV_per_V"], 1e-3 * d["k3_mV_per_V3"], 1e-3 * d["c_mV_s_per_V"], d["rate_gain"]]
    return Pivot(
        np.array([*law, d["rate_velocity_V_per_s"]]),
        np.array(d["breakaway_V"]),
        1e-3 * np.array(d["stiffness_mV_per_V"]),
        np.array(d["creep_rate_per_s"]),
        1e-3 * np.array(d["creep_weight_mV_per_V"]),
    )


NOTHING = Pivot(np.array([0.0, 0.0, 0.0, 0.0, 1.0]), *(np.zeros(0),) * 4)  # the bare double integrator


@dataclass(frozen=True)
class Compensation:
    """F of a bank (V/V), times `gain`, `delay` samples late, behind a low pass of `cut` Hz (none where 0); its source."""

    bank: object
    gain: float = 1.0
    delay: int = 0
    cut: float = 0.0
    source: int = MEASURED

    def but(self, **changes) -> "Compensation":
        return replace(self, **changes)


@dataclass(frozen=True)
class Given:
    """What enters the loop, a value a sample, V: reference, at the input, at the output (seen by the loop alone)."""

    reference: np.ndarray
    force: np.ndarray | None = None
    output: np.ndarray | None = None


@dataclass(frozen=True)
class Machine:
    """windage, sensor: standard deviations of noise in V. count: of the converters, V (none where 0). observer: of
    disturbances, its bandwidth in Hz (none where 0). bias: flex cable, (stiffness V/V, rest V).
    rate: of the control, Hz; at another than 12 kHz the filter, which belongs to that, is left out."""

    preset: Preset
    pivot: Pivot = field(default_factory=pivot)
    compensation: Compensation | None = None
    observer: float = 0.0
    windage: float = 0.0
    sensor: float = 0.0
    count: float = 0.0
    bias: tuple[float, float] = (0.0, 0.0)
    seed: int = 1
    rate: float = RATE

    def run(self, given: Given) -> dict[str, np.ndarray]:
        """Return x, y (as read), u (whole drive), c (of the controller alone), f (mean over the sample), each (n,) V."""
        n = given.reference.size
        nothing = np.zeros(n)
        noise = np.random.default_rng(self.seed)
        sensed = self.sensor * noise.standard_normal(n) if self.sensor else nothing
        pushed = nothing if given.force is None else given.force
        if self.windage:
            pushed = pushed + windage(n, self.windage, noise)
        out = np.empty((5, n))
        p = self.pivot
        dt = 1.0 / self.rate
        notch = (*FILTER[0], *FILTER[1][1:]) if self.rate == RATE else (1.0, 0.0, 0.0, 0.0, 0.0)
        run(
            given.reference, pushed, nothing if given.output is None else given.output, sensed,
            *PLANT.sampled(dt / SUBSTEPS), np.append(p.law, self.bias), p.radii, p.springs, p.rates, p.weights,
            np.array([self.preset.kc, KP, KD / dt, KI * dt, *notch]), *_compensator(self.compensation),
            _observer(self.observer), self.count, dt, out,
        )  # fmt: skip
        return dict(zip(("x", "y", "u", "c", "f"), out, strict=True))


def windage(n: int, deviation: float, noise: np.random.Generator) -> np.ndarray:
    """Return (n,) of white noise behind a first-order low pass, V, of this standard deviation from the start."""
    from scipy.signal import lfilter

    e = np.exp(-2 * np.pi * WINDAGE * TS)
    white = noise.standard_normal(n)
    white[0] /= np.sqrt(1.0 - e**2)
    return deviation * np.sqrt(1.0 - e**2) * lfilter([1.0], [1.0, -e], white)


def _compensator(c: Compensation | None):
    if c is None:
        return (*(np.zeros(0),) * 4, np.array([0.0, 0.0, 0.0, 1.0]), 0, MEASURED)
    smooth = 1.0 - np.exp(-2 * np.pi * c.cut * TS) if c.cut else 1.0
    b = c.bank
    return b.radii, b.springs, b.rates, b.creeps, np.array([b.stiffness, c.gain, 0.0, smooth]), c.delay, c.source


def _observer(bandwidth: float) -> np.ndarray:
    """Return Tustin's coefficients of Q = w^2/(s^2 + 1.414 w s + w^2), and of Q s^2/K0: (b of Q, b of Q s^2/K0, a)."""
    from scipy.signal import bilinear

    if not bandwidth:
        return np.zeros(0)
    w = 2 * np.pi * bandwidth
    q, a = bilinear([w**2], [1.0, np.sqrt(2.0) * w, w**2], 1.0 / TS)
    second, _ = bilinear([w**2 / K0, 0.0, 0.0], [1.0, np.sqrt(2.0) * w, w**2], 1.0 / TS)
    return np.concatenate([q, second, a[1:]])
