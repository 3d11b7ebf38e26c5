"""Log gains at the knots: a least-squares quadratic program with bounded slopes, by OSQP."""

import numpy as np

from workbench.errors import WorkbenchError

CURVATURE = 1e-7  # weight of squared second differences: knots that no data hold lie on a straight line in log-log
EXACT = 1e-6  # largest violation and dual residual that is accepted before the projection
SETTINGS = {
    "eps_abs": 1e-9,
    "eps_rel": 1e-9,
    "eps_prim_inf": 1e-12,  # low enough gains keep every limit, so nothing is infeasible; large multipliers seem so
    "max_iter": 100000,
    "polishing": False,  # prints a line wherever nothing is active
    "scaling": 0,  # the problem is scaled already; OSQP's own scaling stalls above 1e-9 where many bounds are active
    "adaptive_rho_interval": 25,  # counted, not timed: the same steps on every machine
}


def solve(
    rows: np.ndarray,
    target: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    ceiling: np.ndarray,
    start: np.ndarray | None = None,
) -> np.ndarray:
    """Return x (m,) that minimises |rows x - target|^2/n + CURVATURE |second differences|^2, low <= diff(x) <= high.

    rows (n, m), target (n,); low, high (m - 1,). ceiling (n,): where True, rows x <= target also. start (m,): where OSQP begins.
    OSQP's defaults end at 1e-3; here the answer's feasibility and its dual residual are checked, and the steps then clipped, so
    that bounds hold exactly. WorkbenchError where they are not good enough.
    """
    import osqp
    from scipy.sparse import csc_matrix

    m = rows.shape[1]
    hessian, gradient = _quadratic(rows, target)
    limits = np.vstack([np.diff(np.eye(m), axis=0), rows[ceiling]])
    least = np.concatenate([low, np.full(int(ceiling.sum()), -np.inf)])
    most = np.concatenate([high, target[ceiling]])
    problem = osqp.OSQP()
    problem.setup(csc_matrix(np.triu(hessian)), -gradient, csc_matrix(limits), least, most, verbose=False, **SETTINGS)
    if start is not None:
        problem.warm_start(x=start)
    found = problem.solve(raise_error=False)
    x = found.x
    if x is None or not np.isfinite(x).all():
        raise WorkbenchError(f"the quadratic program of {m} gains did not end ({found.info.status}); use fewer knots.")
    dual = hessian @ x - gradient + limits.T @ found.y
    step = np.diff(x)
    wrong = max(np.abs(dual).max(), (low - step).max(), (step - high).max())
    if wrong > EXACT:
        raise WorkbenchError(f"the quadratic program of the gains ended {wrong:.1g} off its optimum; use fewer knots.")
    middle = m // 2
    out = np.concatenate([[0.0], np.cumsum(np.clip(step, low, high))])
    return out - out[middle] + x[middle]


def _quadratic(rows: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (H (m, m), g (m,)) of the objective x' H x/2 - g' x, scaled so that the diagonal of H is about 1."""
    m = rows.shape[1]
    bends = np.diff(np.eye(m), n=2, axis=0)
    share = m / target.size
    return share * rows.T @ rows + m * CURVATURE * bends.T @ bends, share * rows.T @ target


def interpolation(knots: np.ndarray, amplitude: np.ndarray) -> np.ndarray:
    """Return (n, m): weights of the knots at amplitudes within them, linear in amplitude."""
    i = np.clip(np.searchsorted(knots, amplitude, side="right") - 1, 0, knots.size - 2)
    share = np.clip((amplitude - knots[i]) / (knots[i + 1] - knots[i]), 0.0, 1.0)
    out = np.zeros((amplitude.size, knots.size))
    rows = np.arange(amplitude.size)
    out[rows, i], out[rows, i + 1] = 1.0 - share, share
    return out


def fit(knots, amplitude, gain, low: np.ndarray, high: np.ndarray, ceiling: np.ndarray) -> np.ndarray:
    """Return gains at the knots whose interpolation, linear in amplitude, fits the logs of `gain` (n,) at `amplitude` (n,).

    low, high (m - 1,): bounds of the steps of log gain from knot to knot. Gauss-Newton: the log of an interpolated gain is
    linearised at the solution before, beginning from the given gains.
    """
    weights, target = interpolation(knots, amplitude), np.log(gain)
    x = np.interp(np.log(knots), np.log(amplitude), target)
    for _ in range(2):
        level = weights @ np.exp(x)
        rows = weights * np.exp(x) / level[:, None]
        x = solve(rows, target - np.log(level) + rows @ x, low, high, ceiling, x)
    return np.exp(x)
