"""Blocked cross-validation of a solved problem, from Gram matrices of its blocks.

Each fold leaves out every K-th block of the records, re-estimates the linear parameters and, to first order (a
Gauss-Newton step from the optimum), the shape parameters on the rest, and predicts what was left out. Blocks are
contiguous and longer than the residual's memory, so coloured noise does not leak from one into the other.
"""

from dataclasses import dataclass, replace

import numpy as np

from workbench.identification.bounded import bounded, bounded_small, scales
from workbench.identification.intervals import block_seconds
from workbench.identification.problem import LOGARITHMIC, Problem, to_search
from workbench.identification.solve import Solution, clipped

FOLDS = 6
WORTH = 0.1  # of another model's squared error, that a fit gains on it: from there its folds may be followed
ASTRAY = 0.1  # of that gain, lost on held-out blocks: from there they are
PARTS = (1.0, 0.5, 0.25)  # of that step, which are tried
DETERMINED = 1e-9  # eigenvalue of the scaled normal equations, over the largest, above which a direction counts


@dataclass(frozen=True, eq=False)
class HeldOut:
    """errors: squared held-out residual of each block, (blocks,)."""

    errors: np.ndarray

    @property
    def total(self) -> float:
        return float(self.errors.sum())


class Deviations:
    """How a solved model may give way, to first order: c deviates by d, the residual by -columns d, lower <= d <= upper.

    columns: (N, m + k), of unit length: those of the linear parameters, then the tangents of the shape parameters.
    """

    def __init__(self, problem: Problem, solution: Solution):
        norms = scales(solution.columns)
        self.columns, self.norms = solution.columns / norms, norms
        lower, upper = problem.bounds
        least, most = shape_room(problem, solution.theta)
        self.lower = np.concatenate([np.minimum(lower - solution.c, 0.0), least]) * norms
        self.upper = np.concatenate([np.maximum(upper - solution.c, 0.0), most]) * norms

    def best(self, gram: np.ndarray, moment: np.ndarray) -> np.ndarray:
        """Return d of the least squares with these normal equations; what they do not determine stays."""
        return from_normal(gram, moment, self.lower, self.upper)

    def without(self, residual: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Return the residual (N,) of a fit to the rows that are not `out` (N,) of bool."""
        kept = self.columns[~out]
        return residual - self.columns @ self.best(kept.T @ kept, kept.T @ residual[~out])


def held_out(problem: Problem, solution: Solution, base: float = 0.0, astray: float = ASTRAY) -> HeldOut:
    """Return the held-out squared error of every block.

    Each fold estimates its deviation from the common solution, so that a direction which the rest of the data does not
    determine keeps the common value. Where more than the share `astray` is lost of what the fit gains on `base`, the squared
    error of another model, each fold is followed in earnest.
    """
    model = Deviations(problem, solution)
    columns, target = model.columns, solution.residual
    blocks = problem.blocks(block_seconds(problem))
    grams = np.array([columns[b].T @ columns[b] for b in blocks])
    moments = np.array([columns[b].T @ target[b] for b in blocks])
    powers = np.array([target[b] @ target[b] for b in blocks])
    errors = np.empty(len(blocks))
    steps = []
    for out, rest in folds_of(len(blocks)):
        d = model.best(grams[rest].sum(axis=0), moments[rest].sum(axis=0))
        steps.append(d[solution.c.size :] / model.norms[solution.c.size :])
        for i in out:
            errors[i] = powers[i] - 2 * d @ moments[i] + d @ grams[i] @ d
    gained, lost = base - solution.cost, errors.sum() - solution.cost
    if solution.theta.size and gained > WORTH * base and lost > astray * gained:
        for (out, rest), step in zip(folds_of(len(blocks)), steps, strict=True):
            left = followed(problem, solution, step, np.concatenate([np.r_[blocks[i]] for i in rest]))
            for i in out:
                errors[i] = left[blocks[i]] @ left[blocks[i]]
    return HeldOut(np.maximum(errors, 0.0))


def folds_of(count: int, folds: int = FOLDS) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return (blocks that are left out, the rest) of each fold."""
    number = np.arange(count) % folds
    return [(np.flatnonzero(number == k), np.flatnonzero(number != k)) for k in range(min(folds, count))]


def followed(problem: Problem, solution: Solution, step: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return the residual (N,) of a fit to `rows` whose shape parameters follow a step (k,), as far as those rows bear it out.

    Where shape parameters are hard to tell apart the step is long, and the tangents do not say what it does to the residual.
    """

    def fit(y, phi):
        residual = y - phi @ bounded(phi[rows], y[rows], *problem.bounds)
        return float(residual[rows] @ residual[rows]), residual

    stay = fit(solution.y, solution.phi)
    for part in PARTS:
        y, phi = problem.assemble(clipped(problem, solution.theta + part * step))
        if np.isfinite(phi).all() and np.isfinite(y).all() and (found := fit(y, phi))[0] < stay[0]:
            return found[1]
    return stay[1]


def shape_room(problem: Problem, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return how far each shape parameter may deviate in a fold: to its bounds, and by a factor e at most."""
    least, most = np.full(theta.size, -np.inf), np.full(theta.size, np.inf)
    for k, name in enumerate(problem.free_shape):
        p = problem.parameter(name)
        if p.scale in LOGARITHMIC:
            least[k], most[k] = -1.0, 1.0
        low, high = (
            to_search(replace(p, value=b)) if b > 0 or p.scale not in LOGARITHMIC else -np.inf
            for b in (p.lower, p.upper)
        )
        least[k] = max(least[k], min(low - theta[k], 0.0))
        most[k] = min(most[k], max(high - theta[k], 0.0))
    return least, most


def from_normal(gram: np.ndarray, moment: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Solve the bounded least squares given by normal equations; undetermined directions take the least norm."""
    values, vectors = np.linalg.eigh(gram)
    keep = values > DETERMINED * max(values[-1], 1e-300) if values.size else np.zeros(0, bool)
    root = np.sqrt(values[keep])
    r = root[:, None] * vectors[:, keep].T
    b = (vectors[:, keep].T @ moment) / root
    return bounded_small(r, b, lower, upper)


def gain(base: HeldOut, other: HeldOut) -> tuple[float, float]:
    """Return (g, standard error of g): g = 1 - other/base, the relative reduction of the held-out squared error.

    The error is that of a ratio over blocks (Cochran, Sampling Techniques, 1977): blocks in which little is left count
    little, and an improvement in proportion to what was there has no scatter.
    """
    difference = base.errors - other.errors
    whole = max(base.total, 1e-300)
    g = float(difference.sum()) / whole
    n = difference.size
    if n < 2:
        return g, float("inf")
    spread = difference - g * base.errors
    return g, float(np.sqrt(n / (n - 1) * (spread @ spread))) / whole
