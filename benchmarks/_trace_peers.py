"""Two peers on the residual that the trace starts from: sparse regression, and greedy selection with BIC.

Both get the same generic library of functions of the filtered motion, torque and time, and the fit's residual on the
identification records, thinned to a little above twice the band so that the noise between samples is nearly white. A term
that they pick is read as the effect that an engineer would read it as (LIBRARY); the first is the one with the largest rms.
"""

from collections.abc import Callable, Sequence

import numpy as np

BLOCKS = 20  # in which errors are counted
TERMS = 12  # that a greedy selection may add
THRESHOLDS = np.geomspace(0.01, 0.6, 12)  # of columns and residual scaled to one


def library(q, v, a, u, t, way, rate, orders: Sequence[float], fastest: float) -> list[tuple[str, np.ndarray]]:
    """Return (effect that a term stands for, values (n,)): polynomials, signs, Fourier in position, and slopes in time.

    way: direction of motion. orders: of the gear and the motor, which anyone would try. fastest: the largest speed of all.
    """
    terms = [
        ("constant_offset", np.ones_like(q)), ("cable_spring", q), ("cable_spring", q**2), ("cable_spring", q**3),
        ("viscous_friction", v), ("nonlinear_viscous_friction", v * np.abs(v)), ("nonlinear_viscous_friction", v**3),
        ("coulomb_asymmetry", np.abs(v)), ("coulomb_friction", way), ("inertia", a), ("friction_drift", t * way),
        ("sensor_trend", t), ("load_dependent_friction", np.abs(u) * way), ("torque_constant_saturation", u**3),
        ("transport_delay", rate(u)), ("actuator_lag", rate(rate(u))), ("clock_skew", t * rate(u)),
    ]  # fmt: skip
    terms += [
        ("stribeck_friction", np.exp(-((v / s) ** 2)) * way) for s in (0.015 * fastest, 0.04 * fastest, 0.1 * fastest)
    ]
    for order in (1.0, 2.0, *orders):
        for f in (np.sin, np.cos):
            terms.append(("gravity" if order == 1.0 else "cogging", f(order * q)))
            terms.append(("cyclic_friction", f(order * q) * way))
    return terms


def columns(series: Sequence, band: float, orders: Sequence[float], declared: set[str]):
    """Return names (k,), columns (n, k) and residual (n,) of records (workbench.identification.result.Series).

    Terms of effects that are declared and fitted are projected out of the rest, and not for choice.
    """
    names, blocks, left = [], [], []
    fastest = max(float(np.abs(s.velocity).max()) for s in series)
    for s in series:
        step = s.time[1] - s.time[0]
        rate = lambda x, step=step: np.gradient(x, step)  # noqa: E731
        v = s.velocity
        way = np.tanh(v / (1e-3 * fastest))
        found = library(s.position, v, rate(v), s.measured, s.time, way, rate, orders, fastest)
        decimate = slice(s.keep.start, s.keep.stop, max(1, int(1 / (2.4 * band * step))))
        names = [name for name, _ in found]
        blocks.append(np.column_stack([x[decimate] for _, x in found]))
        left.append(s.residual[decimate])
    x, y = np.concatenate(blocks), np.concatenate(left)
    fitted = np.array([name in declared for name in names])
    basis = np.linalg.qr(x[:, fitted])[0]
    x, y = x[:, ~fitted], y - basis @ (basis.T @ y)
    return [n for n in names if n not in declared], x - basis @ (basis.T @ x), y


def scaled(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Columns and target of rms one."""
    return x / np.maximum(np.sqrt(np.mean(x**2, axis=0)), 1e-300), y / np.sqrt(np.mean(y**2))


def folded(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return columns and target of as many rows as there are of both, with the same products: least squares of any choice of
    columns leaves the same sum of squares, and a search over choices does not go through the samples each time."""
    triangle = np.linalg.qr(np.column_stack([x, y]), mode="r")
    return triangle[:, :-1], triangle[:, -1]


def named(names: Sequence[str], weights: np.ndarray) -> list[str]:
    """Effects of the terms with a weight, largest first, each once. weights (k,) of columns of rms one."""
    order = np.argsort(-np.abs(weights), kind="stable")
    return list(dict.fromkeys(names[k] for k in order if weights[k] != 0.0))


def greedy(names: Sequence[str], x: np.ndarray, y: np.ndarray) -> list[str]:
    """Forward selection: the term that lowers BIC = n log(rss/n) + k log n most, as long as one does."""
    n, (x, y) = y.size, folded(*scaled(x, y))
    chosen, best, weights = [], n * np.log(y @ y / n), np.zeros(len(names))
    while len(chosen) < TERMS:
        tried = []
        for k in (k for k in range(len(names)) if k not in chosen):
            a = x[:, [*chosen, k]]
            w = np.linalg.lstsq(a, y, rcond=None)[0]
            left = y - a @ w
            tried.append((n * np.log(left @ left / n) + (len(chosen) + 1) * np.log(n), k, w))
        bic, k, w = min(tried, key=lambda row: row[0])
        if bic >= best:
            break
        best, chosen = bic, [*chosen, k]
        weights[:] = 0.0
        weights[chosen] = w
    return list(dict.fromkeys(names[k] for k in chosen))


def sparse(names: Sequence[str], x: np.ndarray, y: np.ndarray) -> list[str]:
    """PySINDy's STLSQ (Brunton, Proctor and Kutz, PNAS 113, 2016).

    Its threshold is chosen on held-out blocks, every other one of twenty: the sparsest within one standard error of the best.
    """
    import pysindy as ps

    x, y = scaled(x, y)
    block = np.arange(y.size) * BLOCKS // y.size
    seen, target = folded(x[block % 2 == 0], y[block % 2 == 0])

    def weights(threshold: float) -> np.ndarray:
        found = ps.STLSQ(threshold=threshold, alpha=1e-6, max_iter=30).fit(seen, target[:, None]).coef_[0]
        return np.where(np.isfinite(found), found, 0.0)

    def wrong(w: np.ndarray) -> np.ndarray:
        return np.array([np.mean((y - x @ w)[block == k] ** 2) for k in range(1, BLOCKS, 2)])

    found = [weights(t) for t in THRESHOLDS]
    errors = np.array([wrong(w) for w in found])
    best = errors[np.argmin(errors.mean(axis=1))]
    near = [np.mean(e) <= np.mean(best) + np.std(e - best) / np.sqrt(e.size) for e in errors]
    return named(names, found[max(np.flatnonzero(near))])


PEERS: dict[str, Callable] = {"greedy, BIC": greedy, "PySINDy": sparse}


def answers(series: Sequence, band: float, orders: Sequence[float], declared: set[str]) -> dict[str, list[str]]:
    """Return peer -> effects, first the one it would name; a peer that is not installed is not there."""
    import warnings

    names, x, y = columns(series, band, orders, declared)
    found = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of coefficients that a threshold has emptied
        for name, peer in PEERS.items():
            try:
                found[name] = peer(names, x, y)
            except ImportError:
                continue
    return found
