"""Variable projection: bounded linear least squares inside, damped Gauss-Newton over the shape parameters outside."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from workbench.identification.bounded import bounded, scales
from workbench.identification.problem import LOGARITHMIC, Problem, from_search

ITERATIONS = 25
TOLERANCE = 1e-9  # relative decrease of the cost at which the search stops
TRUSTED = 0.5  # of what the linear model promised, that a step must bring for the next one to be damped less
LOADS = 8  # times a load is found anew for a shape, each leaves mu times the error of the one before; and times a shape is for its load
FOLLOWING = 2  # steps at a load found anew, which is near the last one
CARRIED = 1e-6  # of the drive, by which a fit may still move with its load
AT_BOUND = 1e-10  # of the drive, by which a linear parameter may lie off the bound at which it stands
LARGEST = 1.0  # largest step of a shape parameter on its logarithmic scale


@dataclass(frozen=True, eq=False)
class Solution:
    """theta: shape on the search scale; c: free linear; y, phi: assembled at theta. sloping: makes the tangents, once they are asked for: of
    a search whose end alone is wanted, and of starts that led to less, nobody does."""

    theta: np.ndarray
    c: np.ndarray
    y: np.ndarray
    phi: np.ndarray
    cost: float
    sloping: Callable[[], np.ndarray]

    @cached_property
    def tangents(self) -> np.ndarray:
        """d(Phi c - y)/d theta, (N, k)."""
        return self.sloping()

    @cached_property
    def residual(self) -> np.ndarray:
        """What is left, (N,)."""
        return self.y - self.phi @ self.c

    @cached_property
    def columns(self) -> np.ndarray:
        """phi and tangents side by side, (N, m + k): all that the model may give way along, to first order."""
        return np.hstack([self.phi, self.tangents])

    @cached_property
    def gram(self) -> np.ndarray:
        """columns' columns, (m + k, m + k)."""
        return self.columns.T @ self.columns


class At(NamedTuple):
    """A shape with the linear parameters solved there. cost: squared residual, infinite where an effect has no value on this
    motion (outside its domain, or grown beyond it). gram: phi' phi."""

    cost: float
    c: np.ndarray
    y: np.ndarray
    phi: np.ndarray
    gram: np.ndarray


def solved_at(problem: Problem, theta: np.ndarray) -> At:
    """Solve the linear parameters at a shape."""
    y, phi = problem.assemble(theta)
    with np.errstate(all="ignore"):  # what is not finite shows in these sums, and far sooner than in every sample
        gram, moment, power = phi.T @ phi, phi.T @ y, y @ y
    if not (np.isfinite(gram).all() and np.isfinite(moment).all() and np.isfinite(power)):
        return At(np.inf, np.zeros(phi.shape[1]), y, phi, gram)
    c = bounded(phi, y, *problem.bounds, (gram, moment))
    e = y - phi @ c
    return At(float(e @ e), c, y, phi, gram)


class NoValue(ArithmeticError):
    """The start of a search lies where an effect of the plant has no value on these records."""


def slopes(problem: Problem, theta, c, y, phi) -> np.ndarray:
    """Return the tangents, zero where a step of the derivative leaves an effect's domain: that direction is not searched."""
    tangents = problem.tangents(theta, c, y, phi)
    return np.where(np.isfinite(tangents).all(axis=0), tangents, 0.0)


def solve(
    problem: Problem,
    theta: np.ndarray | None = None,
    tolerance: float = TOLERANCE,
    least: float = 0.0,
    most: int = ITERATIONS,
) -> Solution:
    """Minimise over shape and linear parameters from a start; the result is never worse than the start.

    tolerance: relative decrease of the cost at which the search stops, or that a step no longer promises. least: what the
    first step must promise, else the start is all. most: steps. Raises NoValue where the start has no value. Where a force
    follows the load, which is the sum of other forces, it is solved again at the load that was found until that stays.
    """
    found = _searched(problem, theta, tolerance, least, most)
    for _ in range(LOADS if problem.follows_load else 0):
        settled = _settled(problem, found)
        found = _searched(problem, found.theta, tolerance, 0.0, min(most, FOLLOWING))
        if np.linalg.norm(found.phi @ (found.c - settled)) <= CARRIED * np.linalg.norm(found.y):
            break
    if problem.follows_load:
        _ = found.tangents  # made here: another start moves the load
    return found


def _settled(problem: Problem, found: Solution) -> np.ndarray:
    """Return the linear parameters of a solution's shape at the load that they make themselves, which the problem then has."""
    c = found.c
    for _ in range(LOADS):
        problem.carry(c)
        at = solved_at(problem, found.theta)
        moved, c = np.linalg.norm(at.phi @ (at.c - c)), at.c
        if not moved > CARRIED * np.linalg.norm(at.y):
            break
    return c


def _searched(problem: Problem, theta: np.ndarray | None, tolerance: float, least: float, most: int) -> Solution:
    """Return what `solve` does, at the load that the problem's values make."""
    theta = problem.start() if theta is None else np.array(theta, dtype=float)
    at = solved_at(problem, theta)
    if not np.isfinite(at.cost):
        raise NoValue
    damping = 1e-3
    enough = max(tolerance, least)
    tangents = None  # where the search stands, once it has asked for them
    compared = tolerance > TOLERANCE  # only so: a fit that is reported is searched to its last digit, by every step
    for _ in range(most if theta.size else 0):
        tangents = slopes(problem, theta, at.c, at.y, at.phi)
        moving = _moving(problem, at) if compared else np.ones(at.c.size, dtype=bool)
        g, h, sizes = _normal_equations(at, tangents, moving)
        linear = g.size - sizes.size
        new = None
        for _ in range(8):
            damped = h.copy()
            index = np.arange(linear, len(h))
            damped[index, index] += damping
            whole = np.linalg.lstsq(damped, g, rcond=1e-12)[0]
            promised = whole @ (2.0 * g - h @ whole)
            if promised <= enough * at.cost:
                break  # not even the linear model of the residual promises more
            step = _limited(problem, theta, whole[linear:] / sizes)
            trial = clipped(problem, theta + step)
            tried = solved_at(problem, trial)
            if tried.cost < at.cost:
                new = tried
                break
            as_promised = compared and np.array_equal(trial, theta + whole[linear:] / sizes)
            if as_promised and _best_between(2.0 * (whole @ g), tried.cost - at.cost) <= enough * at.cost:
                break  # nor does what the step came to leave more to a shorter one
            damping *= 10
        if new is None:
            break
        gained, enough = at.cost - new.cost, tolerance
        if gained > TRUSTED * promised:  # else the next step would be as long as one that was refused
            damping = max(damping / 10, 1e-9)
        done = gained < tolerance * at.cost
        theta, at, tangents = trial, new, None
        if done:
            break
    known = (lambda: tangents) if tangents is not None else partial(slopes, problem, theta, at.c, at.y, at.phi)
    return Solution(theta, at.c, at.y, at.phi, at.cost, known)


def _best_between(slope: float, rise: float) -> float:
    """Return by how much the cost falls at most along a step, of the parabola with the slope at its start by which it should fall, and its rise at
    the end: slope^2/(4 (rise + slope)). Without an end, what a shorter step brings is open.

    Where the derivative of a leap (a wave's edge, a friction that turns between two samples) points uphill, every shorter step rises, too.
    """
    return slope**2 / (4.0 * (rise + slope)) if np.isfinite(rise) else np.inf


def _moving(problem: Problem, at: At) -> np.ndarray:
    """Return which linear parameters may move to where the cost falls, (m,) of bool: not those that a bound holds (Bertsekas 1982, projected Newton).

    A step that lets go of a bound promises what no step brings.
    """
    lower, upper = problem.bounds
    slope = at.phi.T @ (at.y - at.phi @ at.c)
    small = AT_BOUND * np.linalg.norm(at.y) / np.sqrt(np.maximum(np.diag(at.gram), 1e-300))
    return ~((at.c - lower <= small) & (slope <= 0.0) | (upper - at.c <= small) & (slope >= 0.0))


def _normal_equations(at: At, tangents: np.ndarray, moving: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (g, h, sizes) of a joint Gauss-Newton step in (c[moving], theta), the linear part may move along: h step = g.

    Columns are of unit length; sizes (k,) are the tangents' own.
    """
    gram = at.gram[np.ix_(moving, moving)]
    norms, sizes = np.sqrt(np.diag(gram)), scales(tangents)
    norms = np.concatenate([np.where(norms > 0.0, norms, 1.0), sizes])
    e, across = at.y - at.phi @ at.c, (at.phi.T @ tangents)[moving]
    h = np.block([[gram, across], [across.T, tangents.T @ tangents]])
    return np.concatenate([(at.phi.T @ e)[moving], tangents.T @ e]) / norms, h / np.outer(norms, norms), sizes


def _limited(problem: Problem, theta: np.ndarray, step: np.ndarray) -> np.ndarray:
    """Shorten a step so that no logarithmic parameter moves by more than a factor e."""
    logs = [problem.parameter(n).scale in LOGARITHMIC for n in problem.free_shape]
    largest = max((abs(s) for s, is_log in zip(step, logs, strict=True) if is_log), default=0.0)
    return step * min(1.0, LARGEST / largest) if largest > 0 else step


def clipped(problem: Problem, theta: np.ndarray) -> np.ndarray:
    """Keep shape parameters within their bounds."""
    result = theta.copy()
    for k, name in enumerate(problem.free_shape):
        p = problem.parameter(name)
        value = from_search(p, theta[k])
        result[k] = np.log(value) if p.scale in LOGARITHMIC else value
    return result
