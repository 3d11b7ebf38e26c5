"""What identification returns."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from workbench.finding import Finding, title
from workbench.notebook import page
from workbench.plant import Plant
from workbench.record import Record


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

    @property
    def title(self) -> str:
        """Name of its effect as it is read."""
        return title(self.effect)


@dataclass(frozen=True)
class Squares:
    """Sums over samples in which errors count: of the squared residual and the squared measured drive, and how many."""

    left: float = 0.0
    measured: float = 0.0
    count: int = 0

    def __add__(self, other: "Squares") -> "Squares":
        return Squares(self.left + other.left, self.measured + other.measured, self.count + other.count)

    @property
    def nrmse(self) -> float:
        """rms of the residual over that of the drive; NaN where there is nothing to compare with."""
        return float(np.sqrt(self.left / self.measured)) if self.measured > 0 else float("nan")

    @property
    def rms(self) -> float:
        return float(np.sqrt(self.left / max(self.count, 1)))


@dataclass(frozen=True, eq=False)
class Series:
    """One record seen through the evaluation filter: time (n,) s, and measured, predicted, residual drive (n,) SI.

    position, velocity: the zero-phase filtered motion. keep: the samples in which errors count; of these the ones in counts (n,)
    where that is not None. role as the record's.
    """

    record: str
    role: str
    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    measured: np.ndarray
    predicted: np.ndarray
    keep: slice
    counts: np.ndarray | None = None

    @property
    def residual(self) -> np.ndarray:
        """measured - predicted, (n,)."""
        return self.measured - self.predicted

    @property
    def squares(self) -> Squares:
        measured, residual = self.measured[self.keep], self.residual[self.keep]
        left = residual if self.counts is None else residual[self.counts[self.keep]]
        return Squares(left @ left, measured @ measured, measured.size)


@dataclass(frozen=True, eq=False)
class Fit:
    """A plant with its parameters fitted to the identification records.

    nrmse: record name -> rms(F(T - That)) / rms(F(T)); identification, validation: the same over all records of a role.
    rms: role -> rms residual, SI. series: record name -> Series. predictions: record name -> unfiltered drive (n,), SI.
    condition: condition number of the scaled columns. spread: "effect@at.parameter", as declared, of what is linear -> (lowest,
    highest) of what each identification record says by itself at the common shape, where two or more determine it.
    records, bandwidth: what was fitted, as measured, and Hz; none where a fit was made of inverse dynamics alone.
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
    records: tuple[Record, ...] = ()
    bandwidth: float = float("nan")

    def _repr_html_(self) -> str:
        """The errors in a sentence, the parameters as a table, and the record that was fitted worst as a drawing."""
        both = f"{self.identification:.2%} of the drive's rms on identification"
        both += f", {self.validation:.2%} on validation" if self.validation == self.validation else ""
        rows = (
            (f"{e.effect}@{e.at}", e.parameter, e.value, e.low, e.high, "held" if e.fixed else "fitted", e.unit)
            for e in self.estimates
        )
        head = ("effect", "parameter", "value", "low", "high", "", "unit")
        return page(f"What the model leaves: {both}.", head, rows, self._draw if self.series else None, graphs=2)

    def _draw(self, axes) -> None:
        worst = max(sorted(self.series), key=lambda name: self.nrmse.get(name, 0.0))
        s, (above, below) = self.series[worst], axes
        above.plot(s.time[s.keep], s.measured[s.keep], color="0.6", label="measured")
        above.plot(s.time[s.keep], s.predicted[s.keep], label="predicted", lw=0.8)
        above.set_title(f"record '{worst}'")
        above.set_ylabel(f"drive, {self.plant.effort}")
        above.legend(loc="upper right", ncols=2)
        below.plot(s.time[s.keep], s.residual[s.keep], color="tab:red", lw=0.8)
        below.set_ylabel("residual")
        below.set_xlabel("time, s")
