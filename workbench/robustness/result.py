"""All that is found of a series of axes."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from workbench.robustness.cases import Cases
from workbench.robustness.influence import Influence
from workbench.robustness.perspective import Perspectives, Share
from workbench.robustness.workload import Columns, Work
from workbench.robustness.worst import Case


@dataclass(frozen=True, eq=False)
class OfGrid:
    """errors, times: controller -> (frictions, inertias): final error and 1 % time, the worst of the encoder phases."""

    inertias: tuple[float, ...]
    frictions: tuple[float, ...]
    errors: Mapping[str, np.ndarray]
    times: Mapping[str, np.ndarray]

    @property
    def title(self) -> str:
        return f"the {len(self.frictions)} × {len(self.inertias)} grid of friction and inertia"


@dataclass(frozen=True, eq=False)
class Series:
    """Everything by controller's name. of_grid, of_draws: both perspectives. shares: controller -> metric -> Share.

    worst: cases kept, the worst first. confidence: of each share by itself. seed: of the draws.
    """

    work: Work
    cases: Cases
    columns: Columns
    grid: OfGrid
    of_grid: Mapping[str, Perspectives]
    of_draws: Mapping[str, Perspectives]
    shares: Mapping[str, Mapping[str, Share]]
    influences: Mapping[str, tuple[Influence, ...]]
    worst: tuple[Case, ...]
    confidence: float
    seed: int

    @property
    def title(self) -> str:
        return f"{self.cases.count} drawn axes"

    def figures(self, name: str) -> dict[str, float]:
        """Return the figures by which one controller may be judged, SI."""
        of_grid, of_draws = self.of_grid[name], self.of_draws[name]
        return {
            "grid_error": of_grid.maximum,
            "grid_error_spread": of_grid.spread,
            "grid_time": float(self.grid.times[name].max()),
            "drawn_error": of_draws.maximum,
            "drawn_error_spread": of_draws.spread,
            "drawn_error_99_percent": of_draws.high,
            **{f"share_beyond_{metric}": share.upper for metric, share in self.shares[name].items()},
        }

    @property
    def as_dict(self) -> dict[str, object]:
        """The series as results.json holds it."""
        return {
            "draws": self.cases.count,
            "seed": self.seed,
            "varied": [
                {"name": v.name, "unit": v.unit, "relative": v.relative, **vars(v.distribution)}
                for v in self.cases.varied
            ],
            "grid": {
                "inertias": self.grid.inertias,
                "frictions": self.grid.frictions,
                "final_error": self.grid.errors,
                "time_1pct": self.grid.times,
            },
            "perspectives": {n: {"grid": vars(self.of_grid[n]), "draws": vars(self.of_draws[n])} for n in self.columns},
            "shares": {n: {k: vars(s) for k, s in of.items()} for n, of in self.shares.items()},
            "influences": {n: [vars(i) for i in of] for n, of in self.influences.items()},
        }
