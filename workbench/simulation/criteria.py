"""By what a response is judged."""

from dataclasses import dataclass
from math import floor

from workbench.errors import WorkbenchError
from workbench.simulation.scenario import Loop


@dataclass(frozen=True)
class Criteria:
    """band: share of the step, for time_1pct and time_own. window: s at the end, for final error and ripple.
    counts, hold: settled is within +-counts of the encoder for hold seconds.
    """

    band: float = 0.01
    window: float = 0.05
    counts: float = 2.0
    hold: float = 0.02

    def __post_init__(self):
        for name, value in vars(self).items():
            if not value > 0.0:
                raise WorkbenchError(f"criteria: {name} is {value:g}; it must be positive.")

    def constants(self, loop: Loop) -> dict[str, float]:
        """Constants of the metrics; hold in samples."""
        return {"hold_band": self.counts * loop.count, "hold": float(floor(self.hold / loop.sample_time + 0.5))}
