"""What an axis of a series may have: a distribution of one number, drawn by its quantile function."""

from dataclasses import dataclass
from math import inf

import numpy as np

from workbench.effects.elementary import exp, log
from workbench.errors import WorkbenchError

UNIFORM, NORMAL, LOG_UNIFORM, FIXED = "uniform", "normal", "log_uniform", "value"
KINDS = (UNIFORM, NORMAL, LOG_UNIFORM, FIXED)
LEAST = 1e-6  # of a normal distribution's probability that its limits must hold


@dataclass(frozen=True)
class Distribution:
    """One number, SI. low, high: its support, both ends inclusive.

    kind: "uniform"; "log_uniform", uniform in the logarithm, low > 0; "normal", of `mean` and `deviation`, truncated to the
    support; "value", always `low`. WorkbenchError for numbers that make none of these.
    """

    kind: str
    low: float
    high: float
    mean: float = 0.0
    deviation: float = 0.0

    def __post_init__(self):
        if not (-inf < self.low <= self.high < inf):
            raise WorkbenchError(
                f"a distribution from {self.low:g} to {self.high:g} has no support; state low, then high."
            )
        if self.kind == LOG_UNIFORM and not self.low > 0.0:
            raise WorkbenchError(f"a log_uniform distribution from {self.low:g} has no logarithm; begin above zero.")
        if self.kind == NORMAL and not self.deviation > 0.0:
            raise WorkbenchError(f"a normal distribution has a deviation of {self.deviation:g}; it must be positive.")
        if self.kind == NORMAL and not np.diff(self._held)[0] > LEAST:
            raise WorkbenchError(
                f"a normal distribution about {self.mean:g} with deviation {self.deviation:g} has next to nothing between "
                f"{self.low:g} and {self.high:g}; widen these limits."
            )

    @property
    def _held(self) -> np.ndarray:
        """Probability below each end of the support, of the normal distribution before it is truncated."""
        from scipy.special import ndtr

        return ndtr((np.array([self.low, self.high]) - self.mean) / self.deviation)

    def at(self, share: np.ndarray) -> np.ndarray:
        """Return the quantiles of shares in 0 to 1: the number below which that share of all axes lies. Any shape."""
        share = np.asarray(share, dtype=float)
        if self.kind == LOG_UNIFORM:
            value = self.low * exp(share * log(self.high / self.low))
        elif self.kind == NORMAL:
            from scipy.special import ndtri

            below, to = self._held
            value = self.mean + self.deviation * ndtri(below + share * (to - below))
        else:
            value = self.low + share * (self.high - self.low)
        return np.clip(value, self.low, self.high)

    def scaled(self, factor: float) -> "Distribution":
        """Return the distribution of the number times a positive factor."""
        return Distribution(
            self.kind, self.low * factor, self.high * factor, self.mean * factor, self.deviation * factor
        )


def uniform(low: float, high: float) -> Distribution:
    return Distribution(UNIFORM, low, high)


def log_uniform(low: float, high: float) -> Distribution:
    return Distribution(LOG_UNIFORM, low, high)


def normal(mean: float, deviation: float, low: float, high: float) -> Distribution:
    return Distribution(NORMAL, low, high, mean, deviation)


def fixed(value: float) -> Distribution:
    return Distribution(FIXED, value, value)
