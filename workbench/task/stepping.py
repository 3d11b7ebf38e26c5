"""Steps of the nonlinear sampled loop by their own trajectories: rise, entry into the band, overshoot, error.

A step under PD gains leaves what friction holds, so time and overshoot are about the response's own final value, and the error
against the command stands beside them.
"""

from dataclasses import dataclass

import numpy as np

RISE = (0.1, 0.9)  # shares of the way to the final value
SETTLED = 0.85  # of the record: a response that is outside its band later has not come to rest
FIGURES = ("time", "rise", "overshoot", "error")


@dataclass(frozen=True, eq=False)
class Figures:
    """Arrays over steps, SI. time: into the band about the own final value, to stay; infinite where it is not at rest.
    rise: from 10 to 90 %. overshoot: beyond the final value, share of the way. error: |final - target|."""

    time: np.ndarray
    rise: np.ndarray
    overshoot: np.ndarray
    error: np.ndarray

    def worst(self, scenarios: int) -> "Figures":
        """Return the worst over each group of scenarios that lie one after the other."""
        return Figures(*(np.max(getattr(self, n).reshape(-1, scenarios), axis=1) for n in FIGURES))


def figures_of(q: np.ndarray, start: np.ndarray, target: np.ndarray, dt: float, band: float = 0.01) -> Figures:
    """Return the figures of positions q (samples, n) that go from start (n,) to target (n,), rad or m, sampled every dt s."""
    with np.errstate(all="ignore"):
        way = q[-1] - start
        gone = (q - start) / np.where(way == 0.0, np.nan, way)
        left = np.abs(gone - 1.0)
        samples, each = len(q), np.arange(q.shape[1])
        last = samples - 1 - np.argmax((left > band)[::-1], axis=0)
        after = np.minimum(last + 1, samples - 1)
        outer, inner = left[last, each], left[after, each]
        time = (last + (outer - band) / np.maximum(outer - inner, 1e-300)) * dt
        rise = (np.argmax(gone >= RISE[1], axis=0) - np.argmax(gone >= RISE[0], axis=0)) * dt
        forth = way * (target - start) > 0.0
        fine = np.isfinite(q).all(axis=0) & forth & (last < SETTLED * samples)
        values = (time, rise, np.maximum(gone.max(axis=0) - 1.0, 0.0), np.abs(target - q[-1]))
    return Figures(*(np.where(fine, v, np.inf) for v in values))
