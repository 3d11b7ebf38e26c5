"""Check of the derivatives by which parameters are searched and loops are linearised."""

import casadi as ca
import numpy as np

from workbench.conformance.arithmetic import rows
from workbench.conformance.result import within
from workbench.conformance.scene import drawn
from workbench.definition import Effect, namespace
from workbench.kernel import arrays, step
from workbench.kernel.step import apply, view

SLOPES = 2e-5  # relative agreement of derivatives with differences


def derivatives(effect: Effect) -> tuple[bool, str]:
    """CasADi's derivatives of the step are those of differences wherever these settle, and are finite at rest."""
    effect = drawn(effect)
    s, z, p = step.symbols(effect)
    named = namespace(**view(effect.parameters, p))
    after, out, provided = apply(effect, view(effect.reads, s), z, effect.derive(named) if effect.derive else named)
    x, y = ca.vertcat(s, z, p), ca.vertcat(out, after, *provided.values())
    value, slope = ca.Function("value", [x], [y]), ca.Function("slope", [x], [ca.densify(ca.jacobian(y, x))])
    values = np.array([q.value for q in effect.parameters.values()])
    signals = rows(effect)
    clock = np.array([r in ("dt", "ratio", "pole_pairs") for r in effect.reads], dtype=bool)
    rest = np.concatenate([np.where(clock, signals[:, 0], 0.0), np.zeros(z.numel()), values])
    if not np.isfinite(np.asarray(slope(rest))).all():
        return False, "At rest, where all motion is zero, a derivative of the step is not a finite number."
    random, worst, settled, tried = np.random.default_rng(1), 0.0, 0, 0
    sizes = np.concatenate([np.abs(signals).max(axis=1), _state_sizes(effect, signals), np.abs(values)])
    for n in random.choice(signals.shape[1], 6, replace=False):
        at = np.concatenate(
            [signals[:, n], sizes[s.numel() : s.numel() + z.numel()] * random.uniform(-0.5, 0.5, z.numel()), values]
        )
        exact = np.asarray(slope(at))
        for k in np.flatnonzero(sizes):
            wide, narrow = (_difference(value, at, k, h * sizes[k]) for h in (2e-5, 1e-5))
            level = np.abs(np.asarray(value(at)).ravel()) / sizes[k] * 1e-3 + np.abs(narrow) + 1e-300
            smooth = np.abs(wide - narrow) < 0.1 * SLOPES * level
            tried, settled = tried + smooth.size, settled + int(smooth.sum())
            error = np.abs(exact[:, k] - narrow)[smooth] / level[smooth]
            worst = max(worst, float(np.max(error, initial=0.0)) if np.isfinite(error).all() else np.inf)
    if settled == 0 and tried:
        return False, "Differences settle nowhere, so no derivative could be checked."
    return within(
        worst, SLOPES, f"Of {tried} derivatives, {settled} are smooth; the largest relative error of these is"
    )


def _state_sizes(effect: Effect, signals: np.ndarray) -> np.ndarray:
    """How large each state becomes along the scene."""
    ready = step.build(effect)
    constants = ready.constants({n: p.value for n, p in effect.parameters.items()})
    states, largest = [np.float64(0.0)] * ready.states, np.zeros(ready.states)
    for now in signals.T:
        states = arrays.evaluate(ready.program, list(now), states, list(constants))[0]
        largest = np.maximum(largest, np.abs(np.array(states, dtype=float)).ravel()) if states else largest
    return largest


def _difference(function: ca.Function, x: np.ndarray, k: int, h: float) -> np.ndarray:
    up, down = x.copy(), x.copy()
    up[k] += h
    down[k] -= h
    return (np.asarray(function(up)) - np.asarray(function(down))).ravel() / (2.0 * h)
