"""The bank: an operator with its weights; run along a motion, described over amplitude and frequency, and undone."""

from collections.abc import Sequence
from dataclasses import dataclass

import numba
import numpy as np

from workbench.definition import Effect, find
from workbench.description.bank import bank_equivalent
from workbench.effects.creep import creep
from workbench.effects.hysteresis import maxwell_slip
from workbench.errors import WorkbenchError

ARRAYS = ("radii", "springs", "rates", "creeps")


@dataclass(frozen=True, eq=False)
class Bank:
    """stiffness k0, F/x. radii r (n,), x, increasing, and springs k (n,), F/x. rates (m,), 1/s, and creeps c (m,), F/x.

    Any unit of force F and displacement x; read-only copies. WorkbenchError where lengths differ or a radius or rate is
    not above 0.
    """

    stiffness: float
    radii: np.ndarray
    springs: np.ndarray
    rates: np.ndarray
    creeps: np.ndarray

    def __post_init__(self):
        for name in ARRAYS:
            value = np.array(getattr(self, name), dtype=float).ravel()
            value.flags.writeable = False
            object.__setattr__(self, name, value)
        if self.radii.size != self.springs.size or self.rates.size != self.creeps.size:
            raise WorkbenchError(
                f"a bank has {self.radii.size} radii for {self.springs.size} springs and {self.rates.size} rates for "
                f"{self.creeps.size} creep elements; give as many of each."
            )
        if not (np.all(self.radii > 0.0) and np.all(self.rates > 0.0)):
            raise WorkbenchError("radii and rates of a bank must be above 0; a spring without either is its stiffness.")

    @classmethod
    def of_plays(cls, a: float, radii, plays, rates=(), creeps=()) -> "Bank":
        """Return the bank of F = a x + sum wb_i play_i[x] + sum wc_j l_j[x]."""
        plays, creeps = np.asarray(plays, dtype=float), np.asarray(creeps, dtype=float)
        return cls(a + plays.sum() + creeps.sum(), radii, -plays, rates, -creeps)

    @property
    def plays(self) -> tuple[float, np.ndarray, np.ndarray]:
        """(a, wb, wc) of the same operator written with plays and creep operators."""
        return float(self.stiffness + self.springs.sum() + self.creeps.sum()), -self.springs, -self.creeps

    @property
    def passive(self) -> bool:
        """Whether each element takes up energy on every closed path: all weights at or above 0 (sufficient)."""
        return self.stiffness >= 0.0 and not (np.any(self.springs < 0.0) or np.any(self.creeps < 0.0))

    @property
    def slopes(self) -> np.ndarray:
        """Stiffness (n + 1,) of a fast motion beyond none, the first, ... all radii; all above 0: monotone, with an inverse."""
        order = np.argsort(self.radii)
        return self.plays[0] - np.concatenate([[0.0], np.cumsum(self.springs[order])])

    def times(self, factor: float) -> "Bank":
        """Return the bank with all of its force times a factor."""
        return Bank(self.stiffness * factor, self.radii, self.springs * factor, self.rates, self.creeps * factor)

    def run(self, x: np.ndarray, dt: float, plays=None, feet=None) -> np.ndarray:
        """Return F (n,) along x (n,), a sample every dt s, straight between samples.

        plays (radii,), feet (rates,): initial p_0 of each play (clipped to x[0] +- r) and l_0 of each creep operator; where
        absent all start unstrained at x[0].
        """
        x = np.ascontiguousarray(x, dtype=float)
        plays = np.full(self.radii.size, x[0]) if plays is None else np.asarray(plays, dtype=float)
        feet = np.full(self.rates.size, x[0]) if feet is None else np.asarray(feet, dtype=float)
        start = np.clip(plays, x[0] - self.radii, x[0] + self.radii)
        out = np.empty(x.size)
        turned = self.rates * dt
        _run(
            x, self.stiffness, self.radii, self.springs, start, np.exp(-turned), -np.expm1(-turned) / turned,
            self.creeps, x[0] - feet, out,
        )  # fmt: skip
        return out

    def response(self, amplitude, omega) -> np.ndarray:
        """Return the describing function (n,), F/x, of A cos(w t) at amplitude A (n,) and w (n,) rad/s: real part stiffness,
        imaginary part loss. Exact: plays answer with the amplitude alone, creep elements with the frequency alone."""
        amplitude, omega = np.broadcast_arrays(
            np.atleast_1d(np.asarray(amplitude, dtype=float)), np.asarray(omega, dtype=float)
        )
        slipping = bank_equivalent(self.springs, self.radii, amplitude)
        s = 1j * omega[:, None]
        return self.stiffness + slipping.stiffness + 1j * slipping.loss + (s / (s + self.rates)) @ self.creeps

    def effects(self, at: str = "axis") -> tuple[Effect, ...]:
        """Return the same force as effects of the catalogue: a spring, a Maxwell-slip bank, and a creep element a rate."""
        found = []
        if self.stiffness:
            found.append(find("linear_stiffness")(stiffness=self.stiffness, at=at))
        if self.radii.size:
            order = np.argsort(self.radii)
            springs = {f"k{i}": v for i, v in enumerate(self.springs[order].tolist(), 1)}
            found.append(maxwell_slip(tuple(self.radii[order].tolist()))(at=at, **springs))
        for j, (rate, weight) in enumerate(zip(self.rates.tolist(), self.creeps.tolist(), strict=True), 1):
            found.append(creep(1)(at=at, label=f"rate{j}", rate=rate, k1=weight))
        return tuple(found)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _run(x, stiffness, radii, springs, plays, keep, gained, creeps, strained, out):
    before = x[0]
    for n in range(x.size):
        at = x[n]
        total = stiffness * at
        for i in range(radii.size):
            p = max(at - radii[i], min(at + radii[i], plays[i]))
            plays[i] = p
            total += springs[i] * (at - p)
        for j in range(keep.size):
            strained[j] = keep[j] * strained[j] + gained[j] * (at - before)
            total += creeps[j] * strained[j]
        before = at
        out[n] = total


def columns(x: np.ndarray, dt: float, radii: Sequence[float], rates: Sequence[float]) -> np.ndarray:
    """Return (n, 1 + radii + rates): x, x - play and x - l of whole periods of a motion that has settled.

    A play is settled once it has met the largest and the smallest x; one that the motion does not fill stays in its
    middle, where a motion that grew from rest left it. Creep is solved line by line of the spectrum.
    """
    x = np.ascontiguousarray(x, dtype=float)
    found = np.empty((x.size, 1 + len(radii) + len(rates)))
    found[:, 0] = x
    start = np.argmax(x)
    turned = np.roll(x, -start)
    middle = 0.5 * (x.max() + x.min())
    radii = np.asarray(radii, dtype=float)
    plays = np.where(radii < 0.5 * np.ptp(x), x.max() - radii, middle)
    _columns(turned, radii, plays, np.empty((x.size, radii.size)))  # once round: plays are then where they return to
    held = np.empty((x.size, radii.size))
    _columns(turned, radii, plays, held)
    found[:, 1 : 1 + radii.size] = np.roll(held, start, axis=0)
    spectrum = np.fft.rfft(x)
    s = 2j * np.pi * np.fft.rfftfreq(x.size, dt)[:, None]
    share = s / (s + np.asarray(rates, dtype=float))
    if x.size % 2 == 0:
        share[-1] = share[-1].real
    found[:, 1 + radii.size :] = np.fft.irfft(spectrum[:, None] * share, x.size, axis=0)
    return found


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _columns(x, radii, plays, out):
    for n in range(x.size):
        for i in range(radii.size):
            p = max(x[n] - radii[i], min(x[n] + radii[i], plays[i]))
            plays[i] = p
            out[n, i] = x[n] - p
