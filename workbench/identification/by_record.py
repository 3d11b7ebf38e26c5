"""What each identification record says by itself: linear parameters at the common shape, one record at a time.

A record's own estimate is the common one plus (Phi_k' Phi_k)^-1 Phi_k' e_k, with the residual e_k of the common fit; only
small matrices are made. Its variance is cluster-robust over blocks of that record alone, by scores: a record
may have too few of them for a jackknife.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, remainder

import numpy as np

from workbench.definition import Effect
from workbench.identification.bounded import scales
from workbench.identification.intervals import BLOCKS, SHORTEST, outward_slope
from workbench.identification.problem import Name, Problem
from workbench.identification.solve import Solution
from workbench.parameter import Parameter
from workbench.plant import Plant

SHARE = 0.01  # of what all records together know of a parameter: a record that knows less has no say in it
DETERMINED = 1e-10  # eigenvalue of a record's scaled Gram matrix over the largest, above which a direction counts


@dataclass(frozen=True, eq=False)
class Own:
    """One record's own estimates. value, deviation (p,): NaN where the record does not determine the parameter.

    deviation: standard error, in the parameter's unit; NaN too where the record is too short for one. freedom: of it.
    """

    record: str
    value: np.ndarray
    deviation: np.ndarray
    freedom: int


def own_estimates(problem: Problem, solution: Solution, names: Sequence[Name]) -> tuple[Own, ...]:
    """Return one Own a record, of the parameters `names` (free and linear); all others stay as fitted."""
    index = [problem.free_linear.index(n) for n in names]
    norms = scales(solution.phi[:, index])
    phi, residual, common = solution.phi[:, index] / norms, solution.residual, solution.c[index]
    information = _known(phi.T @ phi)[1]
    found, row = [], 0
    for p, length in zip(problem.inverses, problem.lengths, strict=True):
        rows = p.rows(problem.plant)
        seconds = length // rows * p.motion.dt
        # every record has its own count of blocks, so that a short one is not left with one or two
        count = max(1, min(BLOCKS, round(seconds / SHORTEST)))
        edges = row + rows * np.linspace(0, length // rows, count + 1).astype(int)
        part = phi[row : row + length]
        inverse, own = _known(part.T @ part)
        scores = np.array([phi[a:b].T @ residual[a:b] for a, b in zip(edges[:-1], edges[1:], strict=True)])
        scores = scores.reshape(count, len(index))
        step = inverse @ scores.sum(axis=0)
        # scores about the record's own estimate: what is left of them is scatter, not the record's difference
        grams = [phi[a:b].T @ (phi[a:b] @ step) for a, b in zip(edges[:-1], edges[1:], strict=True)]
        left = scores - np.array(grams).reshape(scores.shape)
        freedom = count - len(index)
        scale = count / freedom if freedom > 0 else np.nan
        deviation = np.sqrt(np.maximum(np.diag(inverse @ (left.T @ left) @ inverse), 0.0) * scale)
        says = own >= SHARE * information
        value = np.where(says, common + step / norms, np.nan)
        found.append(Own(p.motion.record.name, value, np.where(says, deviation / norms, np.nan), max(freedom, 0)))
        row += length
    return tuple(found)


def _known(gram: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (inverse, information (p,)) of a Gram matrix: the inverse of the inverse's diagonal, zero if undetermined."""
    if not gram.size:
        return gram, np.zeros(0)
    norms = np.sqrt(np.diag(gram))
    norms = np.where(norms > 0.0, norms, 1.0)
    values, vectors = np.linalg.eigh(gram / np.outer(norms, norms))
    good = values > DETERMINED * max(values[-1], 0.0)
    inverse = (vectors[:, good] / values[good]) @ vectors[:, good].T / np.outer(norms, norms)
    # a parameter in an undetermined direction is not known, however large the rest of its part
    lost = np.sum(vectors[:, ~good] ** 2, axis=1) > 1e-6
    diagonal = np.diag(inverse)
    return inverse, np.where(lost | (diagonal <= 0.0), 0.0, 1.0 / np.where(diagonal > 0.0, diagonal, 1.0))


def outside_of(plant: Plant, names: Sequence[Name], own: Own) -> dict[tuple[str, str], float]:
    """Return (effect key, outside parameter) -> one record's own estimate, of those that it determines.

    plant: as fitted. A phase is the one nearest to the common value.
    """
    found = {}
    for e in plant.effects:
        inside = {n: p.value for n, p in e.parameters.items()}
        says = {n.parameter: v for n, v in zip(names, own.value.tolist(), strict=True) if n.key == e.key}
        moved = inside | {n: v for n, v in says.items() if np.isfinite(v)}
        outside = e.border.outward(moved) if e.border else moved
        for name, p in e.outside.items():
            own_part = [says[n] for n in depends(e, name) if n in says]
            if own_part and np.isfinite(own_part).all():
                value = float(outside[name])
                found[e.key, name] = p.value + remainder(value - p.value, 2 * pi) if p.unit == "rad" else value
    return found


def held(effect: Effect) -> dict[str, Parameter]:
    """Return the parameters that an effect holds of those that a campaign writes: of which nothing inside is free, beside others or not."""
    fixed = {n: [effect.parameters[i].fixed for i in depends(effect, n)] for n in effect.outside}
    return {n: p for n, p in effect.outside.items() if (all(fixed[n]) if fixed[n] else p.fixed)}


def depends(effect: Effect, name: str) -> set[str]:
    """Return the inside parameters that an outside one depends on."""
    inside = {n: p.value for n, p in effect.parameters.items()}
    return {n for n, s in zip(inside, outward_slope(effect, name, inside), strict=True) if s != 0.0}


def spread(plant: Plant, names: Sequence[Name], owns: Sequence[Own]) -> dict[str, tuple[float, float]]:
    """Return outside parameter -> (lowest, highest) own estimate, where two records or more determine it."""
    each = [outside_of(plant, names, o) for o in owns]
    found = {}
    for key in dict.fromkeys(k for one in each for k in one):
        values = [one[key] for one in each if key in one]
        if len(values) > 1:
            found[".".join(key)] = (min(values), max(values))
    return found
