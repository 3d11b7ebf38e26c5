"""What a motion tells of each parameter: the covariance of the estimates that its record would give.

With the columns C of all free parameters behind the evaluation filter, the estimate's covariance is
(C'C)^-1 C'SC (C'C)^-1, S the covariance of drive noise and encoder counts. Both matrices add up over motions.
"""

from dataclasses import dataclass

import numpy as np

from workbench.identification.problem import LOGARITHMIC, Name, Problem
from workbench.identification.solve import slopes
from workbench.inverse.dynamics import InverseDynamics
from workbench.planning.envelope import Sensing
from workbench.plant import Plant


@dataclass(frozen=True, eq=False)
class Information:
    """gram: C'C, scatter: C'SC, (p, p), of parameters in their own units."""

    gram: np.ndarray
    scatter: np.ndarray

    def __add__(self, other: "Information") -> "Information":
        return Information(self.gram + other.gram, self.scatter + other.scatter)

    def covariance(self, sizes: np.ndarray) -> np.ndarray:
        """Return the covariance (p, p). sizes (p,): what a unit of each parameter is measured in.

        A direction that no motion has shown has a variance of 1e12 sizes^2.
        """
        values, vectors = np.linalg.eigh(self.gram * np.outer(sizes, sizes))
        shown = values > 1e-12 * max(values[-1], 1e-300)
        inverse = (vectors[:, shown] / values[shown]) @ vectors[:, shown].T
        unseen = vectors[:, ~shown]
        scaled = inverse @ (self.scatter * np.outer(sizes, sizes)) @ inverse + 1e12 * unseen @ unseen.T
        return scaled * np.outer(sizes, sizes)


def names_of(plant: Plant) -> list[Name]:
    """Return the free parameters in the order of the matrices: linear ones, then shapes."""
    problem = Problem(plant, ())
    return [*problem.free_linear, *problem.free_shape]


def information(inverse: InverseDynamics, plant: Plant, sensing: Sensing) -> Information | None:
    """Return what a record of this motion tells of the free parameters at their values; None where an effect has no value."""
    problem = Problem(plant, (inverse,))
    theta = problem.start()
    y, phi = problem.assemble(theta)
    c = np.array([problem.parameter(n).value for n in problem.free_linear])
    if not (np.isfinite(y).all() and np.isfinite(phi).all()):
        return None
    shapes = [problem.parameter(n) for n in problem.free_shape]
    per_unit = np.array([1.0 / p.value if p.scale in LOGARITHMIC else 1.0 for p in shapes])  # d/dp = (d/dlog p)/p
    columns = np.hstack([phi, slopes(problem, theta, c, y, phi) * per_unit])
    return Information(columns.T @ columns, sensing.scatter(columns, plant))
