"""Checks of the arithmetic: the same bits everywhere, single precision, and neutrality."""

import casadi as ca
import numpy as np

from workbench.conformance.result import within
from workbench.conformance.scene import drawn, output, outputs, scene
from workbench.definition import COMMAND, FORCE, TIME, Effect, namespace
from workbench.kernel import arrays, scan, step
from workbench.kernel.step import apply, view

SAMPLES = 400
SINGLE = 2e-3  # share of the largest output by which single precision between steps may move it


def _graph(effect: Effect, column: str) -> tuple[ca.Function, ca.Function | None]:
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


def _casadi_steps(effect: Effect, signals: np.ndarray) -> np.ndarray:
    """Columns, then provided signals, (m, n), stepped by CasADi itself."""
    shape = np.array([effect.parameters[n].value for n in effect.shape])
    rows = []
    for column in effect.linear or ("",):
        function, before = _graph(effect, column)
        constants = shape if before is None else np.asarray(before(shape)).ravel()
        states, found = np.zeros(sum(effect.states.values())), []
        for now in signals.T:
            states, out = function(now, states, constants)
            found.append(np.asarray(out).ravel())
        rows.append(np.array(found).T)
    return np.vstack([*(r[:1] for r in rows), rows[0][1:]])


def _numpy_steps(effect: Effect, signals: np.ndarray, keep=np.float64) -> np.ndarray:
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
    others = {"CasADi": _casadi_steps(effect, signals), "NumPy": _numpy_steps(effect, signals)}
    for name, found in others.items():
        differ = ~((found == kernel) | (np.isnan(found) & np.isnan(kernel)))
        if differ.any():
            return False, f"{name} and the kernel differ in {int(differ.sum())} of {differ.size} values."
    if not np.isfinite(kernel).all():
        return False, f"{int((~np.isfinite(kernel)).sum())} of {kernel.size} values are not finite numbers."
    return True, f"CasADi, NumPy and the kernel agree in all {kernel.size} values, bit by bit."


def single(effect: Effect) -> tuple[bool, str]:
    """With signals, states and constants kept in single precision between steps, the output hardly moves."""
    effect = drawn(effect)
    signals = rows(effect)
    double, kept = _numpy_steps(effect, signals), _numpy_steps(effect, signals, np.float32)
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
