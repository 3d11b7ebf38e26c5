"""The smallest effect of a kind that the records could have shown.

An effect counts from SHARE of the residual's power. Beside what the model can absorb, a parameter of size x changes the
residual by x s, s the length of its projected column; so x = sqrt(SHARE) |r| / s would just have counted.
"""

from dataclasses import dataclass

import numpy as np

from workbench.finding import title
from workbench.identification.problem import LOGARITHMIC, Problem
from workbench.identification.solve import Solution
from workbench.units import effect_unit


@dataclass(frozen=True)
class Smallest:
    """value: of the parameter that shows the effect best; change: whether of a declared value, else of the effect itself."""

    effect: str
    at: str
    parameter: str
    value: float
    unit: str
    change: bool

    @property
    def title(self) -> str:
        """Name of its effect as it is read."""
        return title(self.effect)


def smallest(
    key: str, change: bool, problem: Problem, solution: Solution, model: np.ndarray, share: float
) -> Smallest | None:
    """Return the smallest effect `key` that would have counted, or None where no size can be stated.

    problem, solution: with the effect. model: (N, r) orthonormal, what the model without it can absorb. share: of the
    residual's power from which an effect counts.
    """
    columns = []
    own = [n for n in problem.free_linear if n.key == key]
    for n in own:
        columns.append((n, solution.phi[:, problem.free_linear.index(n)]))
    if not own:
        for k, n in enumerate(problem.free_shape):
            p = problem.parameter(n)
            if n.key == key and p.scale not in LOGARITHMIC:
                columns.append((n, solution.tangents[:, k]))
    best = None
    for n, column in columns:
        seen = column - model @ (model.T @ column)
        length = float(np.sqrt(seen @ seen))
        if length > 1e-9 * float(np.sqrt(column @ column)) > 0.0 and (best is None or length > best[1]):
            best = n, length
    if best is None:
        return None
    name, length = best
    left = solution.y - solution.phi @ solution.c
    value = float(np.sqrt(share * (left @ left))) / length
    effect = problem.plant[key]
    outside = effect.outside
    one = effect.border is None or name.parameter in outside
    parameter = name.parameter if one else next(iter(outside))
    p = effect.parameters[name.parameter]
    powers = {n: q.value for n, q in effect.parameters.items()}
    return Smallest(
        effect.named, effect.at, parameter, value, effect_unit(p.unit, problem.plant.rotary, powers), change
    )
