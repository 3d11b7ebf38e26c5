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
