"""What identification returns."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from workbench.finding import Finding
from workbench.plant import Plant


@dataclass(frozen=True)
class Estimate:
    """One parameter as it is written outside (SI): value, 95 % interval, unit, and whether it was fitted."""

    effect: str
    at: str
    parameter: str
    value: float
    low: float
    high: float
    unit: str
    meaning: str
    fixed: bool


@dataclass(frozen=True, eq=False)
class Series:
    """One record seen through the evaluation filter: time (n,) s, and measured, predicted, residual drive (n,) SI.

    position, velocity: the zero-phase filtered motion. keep: the samples in which errors count. role as the record's.
    """

    record: str
    role: str
    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    measured: np.ndarray
    predicted: np.ndarray
    keep: slice

    @property
    def residual(self) -> np.ndarray:
        """measured - predicted, (n,)."""
        return self.measured - self.predicted


@dataclass(frozen=True, eq=False)
class Fit:
    """A plant with its parameters fitted to the identification records.

    nrmse: record name -> rms(F(T - That)) / rms(F(T)); identification, validation: the same over all records of a role.
    rms: role -> rms residual, SI. series: record name -> Series. predictions: record name -> unfiltered drive (n,), SI.
    condition: condition number of the scaled columns. spread: "effect@at.parameter", as declared, of what is linear -> (lowest,
    highest) of what each identification record says by itself at the common shape, where two or more determine it.
    """

    plant: Plant
    estimates: tuple[Estimate, ...]
    identification: float
    validation: float
    nrmse: Mapping[str, float]
    rms: Mapping[str, float]
    series: Mapping[str, Series]
    predictions: Mapping[str, np.ndarray]
    findings: tuple[Finding, ...] = ()
    condition: float = float("nan")
    details: Mapping[str, object] = field(default_factory=dict)
    spread: Mapping[str, tuple[float, float]] = field(default_factory=dict)
