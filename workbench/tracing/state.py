"""A plant solved on records: its residual, what it can absorb, and its errors on data that a fold did not see."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isclose

import numpy as np

from workbench.identification.bounded import scales
from workbench.identification.cross_validation import HeldOut, held_out
from workbench.identification.problem import Problem
from workbench.identification.solve import ITERATIONS, solve
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.residual.noise_floor import stationary_rms

ALIKE_RATES = 1e-6  # relative difference of two sample times that are one: a record's comes from its stamps
POLISHED = 3  # steps from a fit that led to one that others are judged beside
SETTLED = 1e-6  # relative decrease of the cost at which a fit is as good as others are judged beside it


class State:
    """A plant with its solution on the decimated identification records, and its held-out errors.

    theta: where the search starts. solved: it has ended there before, and only its columns are wanted again. base: squared
    error of the model that this one is compared with. most: steps of the search. tolerance: relative decrease of the cost at
    which it stops.
    """

    def __init__(
        self,
        plant: Plant,
        inverses: Sequence[InverseDynamics],
        theta: np.ndarray | None = None,
        *,
        solved: bool = False,
        base: float = 0.0,
        most: int = ITERATIONS,
        tolerance: float = SETTLED,
    ):
        self.inverses = inverses
        self.problem = Problem(plant, inverses)
        self.solution = solve(self.problem, theta, tolerance, most=0 if solved else most)
        self.plant = self.problem.at(self.solution.theta, self.solution.c)
        self.errors: HeldOut = held_out(self.problem, self.solution, base)

    @cached_property
    def power(self) -> float:
        """Sum of squares of the measured drive behind the filter, where errors count."""
        return sum(float(np.sum(p.motion.filter(p.motion.u)[p.motion.keep] ** 2)) for p in self.inverses)

    @property
    def freedom(self) -> int:
        """Free parameters."""
        return len(self.problem.free_linear) + len(self.problem.free_shape)

    @cached_property
    def absorbed(self) -> np.ndarray:
        """Orthonormal columns (N, r): what this model can absorb, to first order in its shape parameters."""
        columns = self.solution.columns / scales(self.solution.columns)
        left, singular, _ = np.linalg.svd(columns, full_matrices=False)
        return left[:, singular > 1e-7 * max(singular[:1], default=0.0)]

    @property
    def steady(self) -> float:
        """Rms of the residual's steady part."""
        first = self.inverses[0].motion
        parts = zip(self.inverses, self.problem.drive_part(self.solution.residual), strict=True)
        return stationary_rms(
            [r for p, r in parts if isclose(p.motion.dt, first.dt, rel_tol=ALIKE_RATES)],
            first.dt,
            first.filter.bandwidth,
        )

    @cached_property
    def residuals(self) -> list[np.ndarray]:
        """Residual of the drive in each identification record (n,), zero in the trimmed ends."""
        return self._whole(self.problem.drive_part(self.solution.residual))

    def left_at(self, place: str) -> list[np.ndarray]:
        """Return the residuals in which an effect at a place shows: of the drive, or behind the joint and in it of the load. What acts on the load
        is in no drive; an error of the angle between two encoders is, beside what the motor's mass makes of it."""
        return self.of_loads if place in ("load", "joint") else self.residuals

    @cached_property
    def of_loads(self) -> list[np.ndarray]:
        """Residual of the load's balance in each record (n,), zero in the trimmed ends; of the drive where a record has no such balance."""
        residual = self.solution.residual
        parts = zip(self.problem.load_rows, self.problem.drive_part(residual), strict=True)
        return self._whole([residual[rows] if residual[rows].size else drive for rows, drive in parts])

    def _whole(self, parts: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Return the kept samples of each record within all of them."""
        found = []
        for p, part in zip(self.inverses, parts, strict=True):
            full = np.zeros(p.motion.u.size)
            full[p.motion.keep] = part
            found.append(full)
        return found


@dataclass(frozen=True, eq=False)
class Refitted:
    """A fit with everything free, without its columns, which are many megabytes. theta: on the search scale; c: free linear."""

    problem: Problem
    theta: np.ndarray
    c: np.ndarray

    @property
    def plant(self) -> Plant:
        """The plant with the values that were found."""
        return self.problem.at(self.theta, self.c)

    @property
    def inverses(self) -> Sequence[InverseDynamics]:
        """The records that it was fitted on."""
        return self.problem.inverses

    @property
    def state(self) -> State:
        """The state of this fit, which only led, brought to where others are judged beside it."""
        return State(self.problem.plant, self.problem.inverses, self.theta, most=POLISHED)
