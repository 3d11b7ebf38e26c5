"""The fits that the paper made: a simplex search over weights and rates, and the preload and two-slope model."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.hysteresis import Bank
from workbench.hysteresis.fit import Periodic, gains, stacked

RADII = (0.25, 0.5, 1.5)  # V, eq. (14)
EVALUATIONS = 2000
RANK = 1e-6
LOGARITHMS = (-5.0, 12.0)  # of a rate in 1/s: beyond them an element is nothing, or a spring
PRINTED = {"a": 9.0024, "wb": (-1.5783, 0.1667, -0.0655), "wc": (-0.1431, -7.3341, 0.4403)}  # mV/V
OUR_RATES = (5.0, 1000.0, 1000.0)  # 1/s: not printed, and one steady frequency cannot tell them


def printed(rates: Sequence[float] = OUR_RATES) -> Bank:
    """Return the operator with the printed weights, mV/V, and rates that are our choice."""
    return Bank.of_plays(PRINTED["a"], RADII, PRINTED["wb"], rates, PRINTED["wc"])


@dataclass(frozen=True, eq=False)
class Simplex:
    """bank and gain where a search stopped; evaluations it made; whether its tolerances were met."""

    bank: Bank
    gain: float
    evaluations: int
    converged: bool


def simplex(records: Sequence[Periodic], start: np.ndarray, most: int = EVALUATIONS) -> Simplex:
    """Return where a Nelder-Mead search over (a, wb, wc, log rates) (10,) stops after `most` evaluations."""
    from scipy.optimize import minimize

    fixed, f = stacked(records, RADII, ())
    x, plays = fixed[:, 0], fixed[:, :1] - fixed[:, 1:]
    power = np.sum(x**2)
    n = records[0].x.size
    spectra = np.fft.rfft(x.reshape(-1, n))
    s = 2j * np.pi * np.stack([np.fft.rfftfreq(n, r.dt) for r in records])

    def feet(rates):
        return np.fft.irfft(spectra[..., None] * rates / (s[..., None] + rates), n, axis=1).reshape(x.size, -1)

    def residual(theta):
        rates = np.exp(np.clip(theta[7:], *LOGARITHMS))
        return f - (x * theta[0] + plays @ theta[1:4] + feet(rates) @ theta[4:7])

    def gain(theta):
        left = residual(theta)
        return float(np.sqrt(left @ left / power))

    options = {"maxfev": most, "maxiter": most, "xatol": 1e-4, "fatol": 1e-4}
    done = minimize(gain, start, method="Nelder-Mead", options=options)
    t = done.x
    bank = Bank.of_plays(t[0], RADII, t[1:4], np.exp(np.clip(t[7:], *LOGARITHMS)), t[4:7])
    return Simplex(bank, float(done.fun), int(done.nfev), bool(done.success))


def starts(count: int, seed: int = 1) -> list[np.ndarray]:
    """Return random starts: weights of a few mV/V of any sign, rates from 3 to 3000 1/s; none is printed."""
    random = np.random.default_rng(seed)
    return [
        np.concatenate([[10.0 * random.random()], 3.0 * random.standard_normal(6), np.log(3.0) + np.log(1e3) * random.random(3)])
        for _ in range(count)
    ]  # fmt: skip


@dataclass(frozen=True)
class Preload:
    """f = kv v + ks sgn(v) + ka clip(x, -s, s) + kb (x - clip(x, -s, s)), mV, V, s: eq. (15), the second branch with the
    sign of x that the print lacks."""

    viscous: float
    preload: float
    inner: float
    outer: float
    knee: float

    def run(self, record: Periodic) -> np.ndarray:
        return preload_columns(record, self.knee) @ (self.viscous, self.preload, self.inner, self.outer)

    def response(self, amplitude, omega) -> np.ndarray:
        """Return its describing function, mV/V."""
        amplitude = np.asarray(amplitude, dtype=float)
        g = np.minimum(self.knee / amplitude, 1.0)
        clipped = 2.0 / np.pi * (np.arcsin(g) + g * np.sqrt(1.0 - g * g))
        stiff = self.outer + (self.inner - self.outer) * clipped
        return stiff + 1j * (self.viscous * omega + 4.0 * self.preload / (np.pi * amplitude))


def preload_columns(record: Periodic, knee: float) -> np.ndarray:
    """Return (n, 4): v, sgn(v), the position within the knee and beyond it."""
    s = 2j * np.pi * np.fft.rfftfreq(record.x.size, record.dt)
    v = np.fft.irfft(s * np.fft.rfft(record.x), record.x.size)
    near = np.clip(record.x, -knee, knee)
    return np.stack([v, np.sign(v), near, record.x - near], axis=1)


def fit_preload(records: Sequence[Periodic]) -> Preload:
    """Return the preload and two-slope model of least squares, its knee searched."""
    f = np.concatenate([r.f for r in records])
    best = (np.inf, None)
    for knee in max(np.abs(r.x).max() for r in records) * np.geomspace(0.02, 0.98, 80):
        a = np.concatenate([preload_columns(r, knee) for r in records])
        norms = np.linalg.norm(a, axis=0)
        weights = np.linalg.lstsq(a / norms, f, rcond=1e-10)[0]
        left = float(np.sum((f - a @ (weights / norms)) ** 2))
        best = min(best, (left, (*(weights / norms), knee)), key=lambda b: b[0])
    return Preload(*(float(v) for v in best[1]))


def preload_gain(model: Preload, records: Sequence[Periodic]) -> float:
    """Return the energy gain of a preload and two-slope model, mV/V."""
    left = sum(np.sum((r.f - model.run(r)) ** 2) for r in records)
    return float(np.sqrt(left / sum(np.sum(r.x**2) for r in records)))


def held_out(bank: Bank, tests) -> list[float]:
    """Return the energy gain (mV/V) of a bank on each record that was not fitted, noise-free."""
    return [gains(bank, [t.record])[0] for t in tests]


def identifiable(conditions: Sequence[tuple[float, float]], bank: Bank) -> tuple[int, float]:
    """Return (rank, condition) of the paper's ten parameters under settled sines of (Hz, V): d f/d(a, wb, wc, rates).

    Columns are of unit length, but those that are zero; rank counts singular values above 1e-6 of the largest.
    """
    records = [Periodic(v * np.sin(np.linspace(0.0, 2 * np.pi, 480, endpoint=False)), np.zeros(480), 1.0 / (480 * f))
               for f, v in conditions]  # fmt: skip
    fixed, _ = stacked(records, bank.radii, bank.rates)
    x = fixed[:, :1]
    n = 1 + bank.radii.size
    step = 1e-4
    moved, still = (stacked(records, (), bank.rates * r)[0][:, 1:] for r in (1.0 + step, 1.0 - step))
    a = np.concatenate([x, x - fixed[:, 1:n], x - fixed[:, n:], (moved - still) / (2 * step)], axis=1)
    norms = np.linalg.norm(a, axis=0)
    values = np.linalg.svd(a / np.where(norms > 0.0, norms, 1.0), compute_uv=False)
    return int(np.sum(values > RANK * values[0])), float(values[0] / max(values[-1], 1e-300))
