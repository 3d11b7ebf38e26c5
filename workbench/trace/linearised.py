"""A candidate fitted jointly with the present model, whose own shape parameters move to first order only.

Near its optimum a change of a present shape parameter changes the residual along its tangent. Appended as columns beside the
linear parameters, the tangents let the present model give way to a candidate at the cost of one linear solution; so many
candidates are fitted in earnest, and only those that lead are fitted again with everything free.
"""

import numpy as np

from workbench.identify.problem import Problem
from workbench.identify.solve import Solution
from workbench.plant import Plant
from workbench.trace.score import shape_room


class Linearised(Problem):
    """The problem of `plant`, an extension of the plant that `base` was solved for, on the same records.

    `free_shape` holds what the extension brings. c ends with the present shape parameters' deviations on their search
    scale, which stay within the room that a fold of the cross-validation has.
    """

    def __init__(self, plant: Plant, base: Problem, solution: Solution):
        super().__init__(held(plant, base, solution.theta), base.passes)
        self.base, self.solution = base, solution
        self.room = shape_room(base, solution.theta)
        self.base_scale = base.command_scale(base.with_shape(solution.theta))

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        lower, upper = super().bounds
        least, most = self.room
        return np.concatenate([lower, least]), np.concatenate([upper, most])

    def assemble(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        y, phi = super().assemble(theta)
        beside = self.solution.tangents
        if not beside.shape[1]:
            return y, phi
        scale = self.command_scale(self.with_shape(theta)) / self.base_scale
        return y, np.hstack([phi, beside if scale == 1.0 else beside * scale])

    def whole(self, found: Solution) -> tuple[Problem, np.ndarray]:
        """Return the problem with everything free, and where `found` says that its search should start."""
        free = Problem(freed(self.plant, self.base), self.passes)
        deviation = found.c[len(self.free_linear) :]
        start = dict(zip(self.base.free_shape, self.solution.theta + deviation, strict=True))
        start |= dict(zip(self.free_shape, found.theta, strict=True))
        return free, np.array([start[n] for n in free.free_shape])


def held(plant: Plant, base: Problem, theta: np.ndarray) -> Plant:
    """Return `plant` with the shape parameters that `base` searched fixed at `theta`."""
    solved = base.with_shape(theta)
    for n in base.free_shape:
        value = solved[n.key].parameters[n.parameter].value
        plant = plant.swap(plant[n.key](fixed=True, **{n.parameter: value}))
    return plant


def freed(plant: Plant, base: Problem) -> Plant:
    """Return `plant` with the shape parameters that `base` searched free again."""
    for n in base.free_shape:
        plant = plant.swap(plant[n.key].free(n.parameter))
    return plant
