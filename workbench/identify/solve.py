"""Variable projection: bounded linear least squares inside, damped Gauss-Newton over the shape parameters outside."""

from dataclasses import dataclass

import numpy as np

from workbench.identify.problem import LOGARITHMIC, Problem, from_search

ITERATIONS = 25
TOLERANCE = 1e-9  # relative decrease of the cost at which the search stops
WELL_CONDITIONED = 1e8  # of the normal equations: eight digits are left
LARGEST = 1.0  # largest step of a shape parameter on its logarithmic scale


@dataclass(frozen=True, eq=False)
class Solution:
    """theta: shape on the search scale; c: free linear; y, phi: assembled at theta; tangents: d(Phi c - y)/d theta."""

    theta: np.ndarray
    c: np.ndarray
    y: np.ndarray
    phi: np.ndarray
    cost: float
    tangents: np.ndarray

    @property
    def residual(self) -> np.ndarray:
        return self.y - self.phi @ self.c


def scales(phi: np.ndarray) -> np.ndarray:
    """Column norms, one where a column is zero."""
    norms = np.sqrt(np.einsum("ij,ij->j", phi, phi))
    return np.where(norms > 0, norms, 1.0)


def bounded(
    phi: np.ndarray,
    y: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    normal: tuple[np.ndarray, np.ndarray] | None = None,
) -> np.ndarray:
    """Return c of min |phi c - y| with lower <= c <= upper. normal: phi' phi and phi' y, where they are known.

    Normal equations of the scaled columns and their Cholesky factor where these are well conditioned, else QR. Directions
    that the columns do not determine (below 1e-9 of the largest singular value) take the least norm.
    """
    if phi.shape[1] == 0:
        return np.zeros(0)
    gram, moment = normal or (phi.T @ phi, phi.T @ y)
    norms = np.sqrt(np.diag(gram))
    norms = np.where(norms > 0, norms, 1.0)
    scaled = gram / np.outer(norms, norms)
    if np.linalg.cond(scaled) < WELL_CONDITIONED:
        factor = np.linalg.cholesky(scaled)
        r, b = factor.T, np.linalg.solve(factor, moment / norms)
    else:
        q, r = np.linalg.qr(phi / norms)
        b = q.T @ y
    return bounded_small(r, b, lower * norms, upper * norms) / norms


def bounded_small(r: np.ndarray, b: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """The bounded problem on a small square matrix."""
    c = np.linalg.lstsq(r, b, rcond=1e-9)[0]
    if np.all(c >= lower) and np.all(c <= upper):
        return c
    from scipy.optimize import lsq_linear

    c = lsq_linear(r, b, bounds=(lower, upper), method="bvls", tol=1e-12).x
    return np.clip(c, lower, upper)


def cost_at(problem: Problem, theta: np.ndarray) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    """Return (squared residual, c, y, phi) with the linear parameters solved at this shape.

    The squared residual is infinite where an effect has no value on this motion (outside its domain, or grown beyond it).
    """
    y, phi = problem.assemble(theta)
    with np.errstate(all="ignore"):  # what is not finite shows in these sums, and far sooner than in every sample
        gram, moment, power = phi.T @ phi, phi.T @ y, y @ y
    if not (np.isfinite(gram).all() and np.isfinite(moment).all() and np.isfinite(power)):
        return np.inf, np.zeros(phi.shape[1]), y, phi
    c = bounded(phi, y, *problem.bounds, (gram, moment))
    e = y - phi @ c
    return float(e @ e), c, y, phi


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
    first step must promise, else the start is all. most: steps. Raises NoValue where the start has no value.
    """
    theta = problem.start() if theta is None else np.array(theta, dtype=float)
    cost, c, y, phi = cost_at(problem, theta)
    if not np.isfinite(cost):
        raise NoValue
    tangents = slopes(problem, theta, c, y, phi)
    damping = 1e-3
    enough = max(tolerance, least)
    for _ in range(most if theta.size else 0):
        norms, sizes = scales(phi), scales(tangents)
        # joint Gauss-Newton step in (c, theta): the linear part may move along
        joint = np.hstack([phi / norms, tangents / sizes])
        g = joint.T @ (y - phi @ c)
        h = joint.T @ joint
        improved = False
        for _ in range(8):
            damped = h.copy()
            index = np.arange(phi.shape[1], joint.shape[1])
            damped[index, index] += damping
            whole = np.linalg.lstsq(damped, g, rcond=1e-12)[0]
            if whole @ (2.0 * g - h @ whole) <= enough * cost:
                break  # not even the linear model of the residual promises more
            step = limited(problem, theta, whole[phi.shape[1] :] / sizes)
            trial = clipped(problem, theta + step)
            new_cost, new_c, new_y, new_phi = cost_at(problem, trial)
            if new_cost < cost:
                improved = True
                break
            damping *= 10
        if not improved:
            break
        gain, enough = (cost - new_cost) / cost, tolerance
        theta, cost, c, y, phi = trial, new_cost, new_c, new_y, new_phi
        tangents = slopes(problem, theta, c, y, phi)
        damping = max(damping / 10, 1e-9)
        if gain < tolerance:
            break
    return Solution(theta, c, y, phi, cost, tangents)


def limited(problem: Problem, theta: np.ndarray, step: np.ndarray) -> np.ndarray:
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
