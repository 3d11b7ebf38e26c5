"""A candidate fitted jointly with the present model, whose own shape parameters move to first order only.

Near its optimum a change of a present shape parameter changes the residual along its tangent. Appended as columns beside the
linear parameters, the tangents let the present model give way to a candidate at the cost of one linear solution; so many
candidates are fitted in earnest, and only those that lead are fitted again with everything free.
"""

from functools import cached_property

import numpy as np

from workbench.definition import FORCE, Effect
from workbench.identification.cross_validation import from_normal, shape_room
from workbench.identification.problem import Name, Problem, read_by
from workbench.identification.solve import Solution, solved_at
from workbench.plant import Plant, reads_load


class Linearised(Problem):
    """The problem of `plant`, an extension of the plant that `base` was solved for, on the same records.

    `free_shape` holds what the extension brings. c ends with the present shape parameters' deviations on their search
    scale, which stay within the room that a fold of the cross-validation has.
    """

    def __init__(self, plant: Plant, base: Problem, solution: Solution):
        super().__init__(_held(plant, base, solution.theta), base.inverses)
        self.base, self.solution = base, solution
        self.room = shape_room(base, solution.theta)
        self.base_scale = base.command_scale(base.with_shape(solution.theta))
        self.beside = _beside(self.plant, base.plant)

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        lower, upper = super().bounds
        least, most = self.room
        return np.concatenate([lower, least]), np.concatenate([upper, most])

    @property
    def follows_load(self) -> bool:
        """As of every problem; beside a present model, whose columns stay as they are, only what the one more force reads counts."""
        return reads_load(self.plant[self.beside[0]]) if self.beside else super().follows_load

    def assemble(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if self.beside:
            return self.with_one_more(theta)
        y, phi = super().assemble(theta)
        beside = self.solution.tangents
        if not beside.shape[1]:
            return y, phi
        scale = self.command_scale(self.with_shape(theta)) / self.base_scale
        return y, np.hstack([phi, beside if scale == 1.0 else beside * scale])

    def with_one_more(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Assemble a force beside a present model, whose own balance and columns stay what they are."""
        own, fixed = self.of_one_more(theta)
        phi = np.empty((fixed.size, own.shape[1] + len(self.at_present)), order="F")
        phi[:, self.at_own], phi[:, self.at_present] = own, self.present_columns
        return self.solution.y - fixed, phi

    @cached_property
    def at_own(self) -> list[int]:
        """Where among all columns those of a force beside the present model stand."""
        return [i for i, n in enumerate(self.free_linear) if n.key in self.beside]

    @cached_property
    def at_present(self) -> list[int]:
        """Where among all columns those of the present model stand: linear ones, then tangents."""
        at = {n: i for i, n in enumerate(self.free_linear)}
        return [at[n] for n in self.base.free_linear if self._stay(n)] + [
            len(at) + k for k in range(len(self.base.free_shape))
        ]

    @cached_property
    def stays(self) -> np.ndarray:
        """Which of the present model's columns stay, (m + k,)."""
        return np.array([self._stay(n) for n in self.base.free_linear] + [True] * len(self.base.free_shape), dtype=bool)

    def _stay(self, name: Name) -> bool:
        """Whether a column of the present model stays: that of a force whose place another takes, or that reads what this gives, does not."""
        return name.key not in self.beside and any(e.key == name.key for e in self.plant.effects)

    @cached_property
    def present_columns(self) -> np.ndarray:
        """The columns of the present model that stay, (N, m + k)."""
        return self.solution.columns if self.stays.all() else self.solution.columns[:, self.stays]

    @cached_property
    def left(self) -> np.ndarray:
        """What the present model leaves without its columns that do not stay, (N,)."""
        solution, gone = self.solution, ~self.stays[: self.solution.c.size]
        return solution.residual + solution.phi[:, gone] @ solution.c[gone] if gone.any() else solution.residual

    def of_one_more(self, theta: np.ndarray, roughly: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Return the columns of the force and of what reads from it (N, free) in the order of their names, and what of it is fixed, (N,).

        roughly: as `InverseDynamics.rough`.
        """
        part = read_by(self.with_shape(theta), *self.beside)
        at = {self.free_linear[i]: k for k, i in enumerate(self.at_own)}
        fixed = np.zeros(self.solution.y.size)
        own = np.zeros((fixed.size, len(at)), order="F")  # a locked load has no balance: its columns stay zero there
        row = 0
        for p, length in zip(self.inverses, self.lengths, strict=True):
            rows = slice(row, row + length)
            for e, name, column in (p.rough if roughly else p).filtered(part, self.beside):
                values = column * self.base_scale
                if (index := at.get(Name(e.key, name))) is not None:
                    own[rows, index] = values
                else:
                    fixed[rows] += (e.parameters[name].value if name else 1.0) * values
            row += length
        return own, fixed

    def cost(self, theta: np.ndarray, roughly: bool = False) -> float:
        """Return the squared residual with the linear parameters solved at a shape: infinite where it has no value.

        Of a force beside a present model from products with that model's columns, none of which is copied, and from how far
        that model gives way: what nothing determines stays. roughly: a force beside a present model, as `InverseDynamics.rough`.
        """
        if not self.beside:
            return solved_at(self, theta).cost
        own, fixed = self.of_one_more(theta, roughly)
        present, left = self.present_columns, self.left - fixed
        with np.errstate(all="ignore"):
            across, gram, moment = present.T @ own, own.T @ own, np.concatenate([present.T @ left, own.T @ left])
        if not (np.isfinite(gram).all() and np.isfinite(across).all() and np.isfinite(moment).all()):
            return np.inf
        whole = np.block([[self.solution.gram[np.ix_(self.stays, self.stays)], across], [across.T, gram]])
        norms = np.sqrt(np.diag(whole))
        norms = np.where(norms > 0.0, norms, 1.0)
        lower, upper = self.room_of_one_more
        d = from_normal(whole / np.outer(norms, norms), moment / norms, lower * norms, upper * norms) / norms
        left = left - present @ d[: present.shape[1]] - own @ d[present.shape[1] :]
        return float(left @ left)

    @cached_property
    def room_of_one_more(self) -> tuple[np.ndarray, np.ndarray]:
        """By how much the present model may give way, and what a force beside it may be: columns in that order."""
        order = [*self.at_present, *self.at_own]
        lower, upper = (bound[order] for bound in self.bounds)
        solved = np.zeros(len(order))
        kept = self.solution.c[self.stays[: self.solution.c.size]]
        solved[: kept.size] = kept
        return np.minimum(lower - solved, 0.0), np.maximum(upper - solved, 0.0)

    @property
    def free(self) -> Problem:
        """The problem with everything free."""
        return Problem(_freed(self.plant, self.base), self.inverses)

    def free_start(self, found: Solution) -> np.ndarray:
        """Return where `found` says that the search with everything free should start."""
        deviation = found.c[len(self.free_linear) :]
        start = dict(zip(self.base.free_shape, self.solution.theta + deviation, strict=True))
        start |= dict(zip(self.free_shape, found.theta, strict=True))
        return np.array([start[n] for n in self.free.free_shape])


def _beside(plant: Plant, base: Plant) -> tuple[str, ...]:
    """Return the key of the one force that `plant` has and `base` has not, then those of forces that read what it gives; empty where
    more than a force beside the others differs.

    It may take the place of forces that are what their free linear parameters make of columns that stay.
    """
    known, kept = {e.key for e in base.effects}, {e.key for e in plant.effects}
    more, gone = [e for e in plant.effects if e.key not in known], [e for e in base.effects if e.key not in kept]
    if len(more) != 1:
        return ()
    (new,) = more
    given = {(s, e.at) for e in (new, *gone) for s in e.provides}
    readers = [e for e in plant.effects if e is not new and any((s, e.at) in given for s in e.reads)]
    if any(e.port != FORCE for e in (new, *gone, *readers)) or not all(_linear(e) for e in (*gone, *readers)):
        return ()
    return tuple(e.key for e in (new, *readers))


def _linear(effect: Effect) -> bool:
    """Whether a force is what its free linear parameters make of columns of its own."""
    return bool(effect.linear) and not any(effect.parameters[n].fixed for n in effect.linear)


def _held(plant: Plant, base: Problem, theta: np.ndarray) -> Plant:
    """Return `plant` with the shape parameters that `base` searched fixed at `theta`."""
    solved = base.with_shape(theta)
    for n in base.free_shape:
        value = solved[n.key].parameters[n.parameter].value
        plant = plant.swap(plant[n.key](fixed=True, **{n.parameter: value}))
    return plant


def _freed(plant: Plant, base: Problem) -> Plant:
    """Return `plant` with the shape parameters that `base` searched free again."""
    for n in base.free_shape:
        plant = plant.swap(plant[n.key].free(n.parameter))
    return plant
