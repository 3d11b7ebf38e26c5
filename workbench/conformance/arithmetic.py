"""Checks of the arithmetic: the same bits everywhere, derivatives that hold, single precision, and neutrality."""

import casadi as ca
import numpy as np

from workbench.conformance.result import within
from workbench.conformance.scene import drawn, output, outputs, scene
from workbench.effect import COMMAND, FORCE, TIME, Effect, namespace
from workbench.kernel import arrays, scan, step
from workbench.kernel.step import apply, view

SAMPLES = 400
SINGLE = 2e-3  # share of the largest output by which single precision between steps may move it
SLOPES = 2e-5  # relative agreement of derivatives with differences


def graph(effect: Effect, column: str) -> tuple[ca.Function, ca.Function | None]:
    """Return the step as CasADi evaluates it, (signals, states, inside) -> (next, output and provided), for one column.

    And (shape) -> inside, where parameters are derived.
    """
    s, z, _ = step.symbols(effect)
    shape = ca.SX.sym("shape", len(effect.shape))
    given = view(effect.shape, shape) | {n: ca.SX(1.0 if n == column else 0.0) for n in effect.linear}
    inside, before = namespace(**given), None
    constants = shape
    if effect.derive:
        derived = {n: ca.densify(ca.SX(v)) for n, v in vars(effect.derive(inside)).items()}
        fresh = {n: ca.SX.sym(n, v.numel()) for n, v in derived.items()}
        before = ca.Function("derive", [shape], [ca.vertcat(*(ca.vec(v) for v in derived.values()))])
        inside, constants = namespace(**fresh), ca.vertcat(*fresh.values())
    after, out, provided = apply(effect, view(effect.reads, s), z, inside)
    return ca.Function("step", [s, z, constants], [after, ca.vertcat(out, *provided.values())]), before


def casadi_steps(effect: Effect, signals: np.ndarray) -> np.ndarray:
    """Columns, then provided signals, (m, n), stepped by CasADi itself."""
    shape = np.array([effect.parameters[n].value for n in effect.shape])
    rows = []
    for column in effect.linear or ("",):
        function, before = graph(effect, column)
        constants = shape if before is None else np.asarray(before(shape)).ravel()
        states, found = np.zeros(sum(effect.states.values())), []
        for now in signals.T:
            states, out = function(now, states, constants)
            found.append(np.asarray(out).ravel())
        rows.append(np.array(found).T)
    return np.vstack([*(r[:1] for r in rows), rows[0][1:]])


def numpy_steps(effect: Effect, signals: np.ndarray, keep=np.float64) -> np.ndarray:
    """The same, stepped by NumPy. keep: the type in which signals, states and constants are kept between steps."""
    ready = step.build(effect)
    constants = ready.constants({n: p.value for n, p in effect.parameters.items()}).astype(keep).astype(float)
    states, found = [np.float64(0.0)] * ready.states, []
    for now in signals.astype(keep).astype(float).T:
        after, out = arrays.evaluate(ready.program, list(now), states, list(constants))
        states = [np.float64(keep(x)) for x in after]
        found.append([float(x) for x in out])
    return np.array(found).T


def rows(effect: Effect) -> np.ndarray:
    signals = scene(effect, SAMPLES).signals
    return np.array([signals[r] for r in effect.reads]).reshape(-1, SAMPLES)


def bits(effect: Effect) -> tuple[bool, str]:
    """CasADi, NumPy and a numba kernel return the same bits."""
    effect = drawn(effect)
    signals, ready = rows(effect), step.build(effect)
    constants = ready.constants({n: p.value for n, p in effect.parameters.items()})
    kernel = scan.scan(ready.program, signals, np.zeros(ready.states), constants)
    others = {"CasADi": casadi_steps(effect, signals), "NumPy": numpy_steps(effect, signals)}
    for name, found in others.items():
        differ = ~((found == kernel) | (np.isnan(found) & np.isnan(kernel)))
        if differ.any():
            return False, f"{name} and the kernel differ in {int(differ.sum())} of {differ.size} values."
    if not np.isfinite(kernel).all():
        return False, f"{int((~np.isfinite(kernel)).sum())} of {kernel.size} values are not finite numbers."
    return True, f"CasADi, NumPy and the kernel agree in all {kernel.size} values, bit by bit."


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
    sizes = np.concatenate([np.abs(signals).max(axis=1), state_sizes(effect, signals), np.abs(values)])
    for n in random.choice(signals.shape[1], 6, replace=False):
        at = np.concatenate(
            [signals[:, n], sizes[s.numel() : s.numel() + z.numel()] * random.uniform(-0.5, 0.5, z.numel()), values]
        )
        exact = np.asarray(slope(at))
        for k in np.flatnonzero(sizes):
            wide, narrow = (difference(value, at, k, h * sizes[k]) for h in (2e-5, 1e-5))
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


def state_sizes(effect: Effect, signals: np.ndarray) -> np.ndarray:
    """How large each state becomes along the scene."""
    ready = step.build(effect)
    constants = ready.constants({n: p.value for n, p in effect.parameters.items()})
    states, largest = [np.float64(0.0)] * ready.states, np.zeros(ready.states)
    for now in signals.T:
        states = arrays.evaluate(ready.program, list(now), states, list(constants))[0]
        largest = np.maximum(largest, np.abs(np.array(states, dtype=float)).ravel()) if states else largest
    return largest


def difference(function: ca.Function, x: np.ndarray, k: int, h: float) -> np.ndarray:
    up, down = x.copy(), x.copy()
    up[k] += h
    down[k] -= h
    return (np.asarray(function(up)) - np.asarray(function(down))).ravel() / (2.0 * h)


def single(effect: Effect) -> tuple[bool, str]:
    """With signals, states and constants kept in single precision between steps, the output hardly moves."""
    effect = drawn(effect)
    signals = rows(effect)
    double, kept = numpy_steps(effect, signals), numpy_steps(effect, signals, np.float32)
    largest = np.abs(double).max(axis=1)
    moved = np.max(np.abs(kept - double).max(axis=1) / np.where(largest > 0.0, largest, 1.0))
    return within(float(moved), SINGLE, "Kept in single precision, the output moves, over its largest value, by")


def neutral(effect: Effect) -> tuple[bool, str]:
    """Where its amplitudes are zero, an effect changes nothing: compared with ==."""
    signals = scene(effect).signals
    if effect.port == FORCE:
        zero = effect(**dict.fromkeys(effect.linear, 0.0))
        changed = int(np.count_nonzero(output(zero, signals)))
        return changed == 0, f"With {', '.join(effect.linear)} zero, the force is not zero in {changed} samples."
    zero = effect(**{n: 0.0 for n in effect.parameters if may_vanish(effect, n)})
    given = {COMMAND: signals["u"], TIME: np.zeros(signals["u"].size)}.get(effect.port, signals["q"])
    changed = int(np.count_nonzero(outputs(zero, signals)[0] != given))
    return changed == 0, f"With its amplitudes zero, what goes in comes out changed in {changed} samples."


def may_vanish(effect: Effect, name: str) -> bool:
    """Whether a parameter of a map is an amplitude: it may be zero, and is not an order or a number that is held."""
    p = effect.parameters[name]
    return p.lower <= 0.0 <= p.upper and not p.fixed
