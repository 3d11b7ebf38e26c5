"""Candidates of the search for gains at each amplitude, side by side: what each has come to on simulated steps."""

from dataclasses import dataclass

import numpy as np

from workbench.task.stepping import Figures


@dataclass(frozen=True, eq=False)
class Met:
    """What candidates (c,) at amplitudes `rows` (c,) have come to so far: figures (4, scenarios, c), infinite where they were not met."""

    figures: np.ndarray
    rows: np.ndarray
    kp: np.ndarray
    kd: np.ndarray


@dataclass(frozen=True, eq=False)
class Tried:
    """Candidates (c,) and what they came to. dearest: the number of the scenario that alone costs the most."""

    kp: np.ndarray
    kd: np.ndarray
    worst: Figures
    nominal: Figures
    cost: np.ndarray
    dearest: np.ndarray

    def take(self, rows) -> "Tried":
        parts = (Figures(*(v[rows] for v in vars(f).values())) for f in (self.worst, self.nominal))
        return Tried(self.kp[rows], self.kd[rows], *parts, self.cost[rows], self.dearest[rows])

    def or_where(self, other_is_better: np.ndarray, other: "Tried") -> "Tried":
        """Return this with the other's candidates where those are better."""

        def pick(a, b):
            return np.where(other_is_better, b, a)

        parts = (
            Figures(*(pick(v, getattr(g, n)) for n, v in vars(f).items()))
            for f, g in ((self.worst, other.worst), (self.nominal, other.nominal))
        )
        kept = (pick(getattr(self, n), getattr(other, n)) for n in ("cost", "dearest"))
        return Tried(pick(self.kp, other.kp), pick(self.kd, other.kd), *parts, *kept)
