"""Intervals that hold under coloured residuals, and what the data do not determine.

Covariance is cluster-robust (Liang and Zeger 1986): residuals may be correlated within a block of the record, blocks
are taken as independent. It is the jackknife's, (B - 1)/B times the sum over B blocks of the squared changes of the values when a
block is left out, with Student's quantile of B - 1 degrees of freedom, which holds for few blocks, too (MacKinnon, Nielsen, Webb
2023, where it is CV3). Over 200 simulated sets each, with residuals whose memory is 50 ms to 2 s and records of 2 to 18 s, such an interval
held the truth in 88 to 100 % (tests/identification/test_coverage.py repeats a part): it is a little too wide where the memory is longer
than the motion's period, since scores of neighbouring blocks then oppose each other. (Scaled by B/(B - p), with Student's quantile of B - p,
six blocks and five parameters gave a smart servo's back-EMF a third of its value, which foretold the drive of other blocks to 4 %.)
"""

from collections.abc import Mapping, Sequence

import numpy as np

from workbench.definition import Effect
from workbench.identification.bounded import scales
from workbench.identification.problem import LOGARITHMIC, Name, Problem
from workbench.identification.result import Estimate
from workbench.identification.solve import Solution
from workbench.units import effect_unit

BLOCKS = 48  # wanted; a block is not shorter than SHORTEST, but where fewer than FEW of those are to be had
SHORTEST = 0.5  # s
# Blocks that short records are given as well, and periods of the band that each of them lasts, if that is not beyond SHORTEST. Of six measured axes of
# 0.5 to 6 s neither half nor twice as many change a verdict; half the periods change a second cause on two, twice as many refuse one of 1.3 s
FEW, PERIODS = 12, 4.0
CORRELATED = 0.98
AT_BOUND = 1e-9  # relative distance at which a value counts as lying on its bound


def seconds(problem: Problem) -> float:
    """Length of the records in s, their ends left out that do not count."""
    return sum((p.motion.keep.stop - p.motion.keep.start) * p.motion.dt for p in problem.inverses)


def block_seconds(problem: Problem) -> float:
    """Length of a block in s: of short records FEW blocks, where these last PERIODS of the band, by which a residual's memory has faded."""
    total = seconds(problem)
    band = min(p.motion.filter.bandwidth for p in problem.inverses)
    return max(min(SHORTEST, max(total / FEW, PERIODS / band)), total / BLOCKS)


def freedom(problem: Problem) -> int:
    """Degrees of freedom of the covariance: blocks less one, one at least."""
    return max(len(problem.blocks(block_seconds(problem))) - 1, 1)


def on_bound(value: float, lower: float, upper: float) -> bool:
    size = max(abs(value), 1e-300)
    return abs(value - lower) <= AT_BOUND * size or abs(value - upper) <= AT_BOUND * size or value in (lower, upper)


def covariance(problem: Problem, solution: Solution) -> tuple[list[Name], np.ndarray, float, float]:
    """Return (names, covariance, t, condition) of the free parameters that lie inside their bounds, in natural units.

    t: Student's 97.5 % quantile. condition: of the columns scaled to unit length.
    """
    from scipy.special import stdtrit

    inside, a = _inside(problem, solution)
    if not inside:
        return [], np.zeros((0, 0)), 2.0, 1.0
    norms = scales(a)
    scaled = a / norms
    singular = np.linalg.svd(scaled.T @ scaled, compute_uv=False)
    condition = float(np.sqrt(singular[0] / max(singular[-1], 1e-300)))
    blocks = problem.blocks(block_seconds(problem))
    scores = np.array([scaled[b].T @ solution.residual[b] for b in blocks])
    without = scaled.T @ scaled - np.array([scaled[b].T @ scaled[b] for b in blocks])
    changes = np.einsum("bij,bj->bi", np.linalg.pinv(without, rcond=1e-14, hermitian=True), scores)
    cov = changes.T @ changes * (1.0 - 1.0 / max(len(blocks), 2))
    return inside, cov / np.outer(norms, norms), float(stdtrit(freedom(problem), 0.975)), condition


def _inside(problem: Problem, solution: Solution) -> tuple[list[Name], np.ndarray]:
    """Return the free parameters that lie inside their bounds and have a part in the drive, and their columns (m, p) in natural units."""
    names, a = [*problem.free_linear, *problem.free_shape], solution.columns
    shaped = problem.with_shape(solution.theta)
    values = np.concatenate([solution.c, [shaped[n.key].parameters[n.parameter].value for n in problem.free_shape]])
    declared = [problem.parameter(n) for n in names]
    inside = [k for k, p in enumerate(declared) if not on_bound(values[k], p.lower, p.upper) and np.any(a[:, k])]
    # a shape parameter searched on a logarithmic scale: d/dp = (d/dtheta)/p
    logarithmic = [k >= len(problem.free_linear) and declared[k].scale in LOGARITHMIC for k in inside]
    natural = np.array([1.0 / values[k] if log else 1.0 for k, log in zip(inside, logarithmic, strict=True)])
    return [names[k] for k in inside], a[:, inside] * natural


def estimates(plant, names: list[Name], cov: np.ndarray, t: float) -> tuple[Estimate, ...]:
    """Return every parameter as it is written outside, with its interval (value itself where held or on a bound)."""
    at = {(n.key, n.parameter): i for i, n in enumerate(names)}
    found = []
    for e in plant.effects:
        inside = {n: p.value for n, p in e.parameters.items()}
        index = [at.get((e.key, n)) for n in e.parameters]
        free = [i for i in index if i is not None]
        for name, p in e.outside.items():
            slope = outward_slope(e, name, inside)
            g = np.array([s for s, i in zip(slope, index, strict=True) if i is not None])
            half = t * float(np.sqrt(max(g @ cov[np.ix_(free, free)] @ g, 0.0))) if free else 0.0
            fixed = all(e.parameters[n].fixed for n, s in zip(e.parameters, slope, strict=True) if s != 0.0)
            found.append(
                Estimate(
                    e.named, e.at, name, p.value, p.value - half, p.value + half,
                    effect_unit(p.unit, plant.rotary, inside), p.meaning, fixed,
                )
            )  # fmt: skip
    return tuple(found)


def outward_slope(effect: Effect, name: str, inside: Mapping[str, float]) -> np.ndarray:
    """Return d(outside parameter)/d(inside parameters), by central differences where there is a border."""
    if effect.border is None:
        return np.array([1.0 if n == name else 0.0 for n in inside])
    slope = []
    for n, value in inside.items():
        step = 1e-6 * max(abs(value), 1e-9)
        up, down = (effect.border.outward({**inside, n: value + s})[name] for s in (step, -step))
        slope.append((up - down) / (2 * step))
    return np.array(slope)


def at_bounds(problem: Problem, names: Sequence[Name]) -> list[Name]:
    """Return the free parameters that came out on a bound or without any effect. names: those that lie inside."""
    inside = set(names)
    return [n for n in (*problem.free_linear, *problem.free_shape) if n not in inside]


def wider_than_value(found: Sequence[Estimate]) -> list[Estimate]:
    """Return the free estimates whose 95 % interval is wider than their value."""
    return [e for e in found if not e.fixed and e.high - e.value > abs(e.value) and e.high - e.value > 0]


def known_together(cov: np.ndarray) -> list[tuple[list[int], float]]:
    """Return groups of parameters linked by correlations above CORRELATED, each with its largest one."""
    deviations = np.sqrt(np.maximum(np.diag(cov), 1e-300))
    r = np.clip(np.abs(cov / np.outer(deviations, deviations)), 0.0, 1.0)
    groups: list[tuple[list[int], float]] = []
    left = set(range(len(r)))
    while left:
        group, reach = set(), {min(left)}
        while reach:
            group |= reach
            reach = {j for i in reach for j in left - group if r[i, j] > CORRELATED}
        left -= group
        if len(group) > 1:
            members = sorted(group)
            groups.append((members, max(float(r[i, j]) for i in members for j in members if i != j)))
    return groups
