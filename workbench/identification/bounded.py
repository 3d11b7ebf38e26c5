"""Linear least squares within bounds, from normal equations where these are well conditioned."""

import numpy as np

WELL_CONDITIONED = 1e8  # of the normal equations: eight digits are left
CORRECTED = 1e13  # of the normal equations, up to which one correction brings what they have lost
# Of the largest singular value, with which a bounded fit holds a direction that its rows do not determine: far below what counts
# as determined (3e-5 in a fold), far above rounding (1e-16 over its square is what rounding may move)
LEAST_NORM = 1e-7


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

    Normal equations of the scaled columns and their Cholesky factor, with one correction from the residual where these are
    not well conditioned (Bjorck 1987, the corrected seminormal equations); QR where the factor is lost. Directions that the
    columns do not determine (below 1e-9 of the largest singular value) take the least norm.
    """
    gram, moment = normal or (phi.T @ phi, phi.T @ y)
    seen = np.diag(gram) > 0.0  # a column of zeros says nothing, and its parameter stays as small as its bounds let it
    c = np.clip(np.zeros(phi.shape[1]), lower, upper)
    if not seen.any():
        return c
    norms = np.sqrt(np.diag(gram)[seen])
    lower, upper = lower[seen] * norms, upper[seen] * norms
    scaled = gram[np.ix_(seen, seen)] / np.outer(norms, norms)
    condition = np.linalg.cond(scaled)
    if not condition < CORRECTED:
        # of the columns and y side by side the factor alone: its last column is what an orthonormal basis, twice the work, would make of y
        r = np.linalg.qr(np.column_stack([phi[:, seen] / norms, y]), mode="r")
        c[seen] = bounded_small(r[:, :-1], r[:, -1], lower, upper) / norms
        return c
    factor = np.linalg.cholesky(scaled)
    found = bounded_small(factor.T, np.linalg.solve(factor, moment[seen] / norms), lower, upper)
    if condition >= WELL_CONDITIONED:
        c[seen] = found / norms
        left = (phi.T @ (y - phi @ c))[seen] / norms
        more = bounded_small(factor.T, np.linalg.solve(factor, left), lower - found, upper - found)
        found = np.clip(found + more, lower, upper)
    c[seen] = found / norms
    return c


def bounded_small(r: np.ndarray, b: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """The bounded problem on a small matrix, which may have fewer rows than columns; what these do not determine takes the least norm."""
    c = np.linalg.lstsq(r, b, rcond=1e-9)[0]
    if np.all(c >= lower) and np.all(c <= upper):
        return c
    from scipy.optimize import lsq_linear

    # an active set has no least norm, and lets such a direction go anywhere (to 1e14); weak rows of its own hold it
    weak = LEAST_NORM * max(float(np.linalg.norm(r, 2)), 1e-300) * np.eye(r.shape[1])
    c = lsq_linear(
        np.vstack([r, weak]), np.concatenate([b, np.zeros(r.shape[1])]), bounds=(lower, upper), method="bvls", tol=1e-12
    ).x
    return np.clip(c, lower, upper)
