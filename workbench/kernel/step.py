"""From an effect's `step` to programs: its columns (one a linear parameter), and its value.

A column is the output with that linear parameter one and the others zero, which is d output / d parameter exactly,
because linear parameters are checked to enter the output linearly and no state.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from workbench.definition import Effect, namespace
from workbench.errors import WorkbenchError
from workbench.kernel import arrays, scan
from workbench.kernel.program import Program, read

# Instructions from which a step without states is worth compiling: NumPy passes over memory for each, and keeps what each makes. Of 10 000
# samples, 50 take NumPy 0.2 ms and a kernel 0.03, 100 take 4 ms and 0.03; a kernel costs 70 ms once on a machine
MANY = 32
# Columns from which they are slopes: a table of 36 knots is built in 0.03 s instead of 0.4. Halved, one program of twelve columns has another order of
# factors, and other last bits; doubled, no program of sixty is another one, and a table of 24 takes six times as long
APART = 16
OWN = "workbench.effects."


@dataclass(frozen=True)
class Step:
    """An effect made ready to run.

    program: inputs (signals in `reads` order, states, constants); outputs (next states, columns then provided signals).
    columns: linear parameter names, or ("",) for an effect without linear parameters (its plain output).
    """

    effect_name: str
    reads: tuple[str, ...]
    provides: tuple[str, ...]
    columns: tuple[str, ...]
    shape: tuple[str, ...]
    states: int
    program: Program
    derive: ca.Function | None

    def constants(self, values: Mapping[str, float]) -> np.ndarray:
        """Return the constants of the program for these parameter values (only shape parameters matter)."""
        shape = np.array([values[n] for n in self.shape], dtype=float)
        return shape if self.derive is None else np.asarray(self.derive(shape)).ravel()

    def run(self, signals: Mapping[str, np.ndarray], values: Mapping[str, float], states=None) -> np.ndarray:
        """Evaluate along a record. signals: name -> (n,) array or scalar. Returns (columns + provided, n)."""
        n = max(np.size(s) for s in signals.values())
        constants = self.constants(values)
        inputs = [signals[r] for r in self.reads]
        if self.states:
            start = np.zeros(self.states) if states is None else states
            return scan.scan(self.program, _stacked(inputs, n), start, constants)
        return _stacked(along(self.program, inputs, constants, n), n)


def along(program: Program, inputs: Sequence, constants: Sequence[float], n: int) -> Sequence:
    """Evaluate a step program without states along n samples: inputs (n,) or scalars, its constants. Returns outputs, (n,) or scalars."""
    if len(program.lines) > MANY:
        return scan.scan(program, _stacked(inputs, n), np.zeros(0), np.asarray(constants, dtype=float))
    return arrays.evaluate(program, inputs, (), constants)[1]


def _stacked(values: Sequence, n: int) -> np.ndarray:
    """Return values, (n,) or scalars, as one array (values, n)."""
    stacked = np.empty((len(values), n))
    for row, value in zip(stacked, values, strict=True):
        row[:] = value
    return stacked


def symbols(effect: Effect):
    """Return (signals, states, parameters) as namespaces of SX, and the vectors that they are views of."""
    s = ca.SX.sym("s", len(effect.reads))
    z = ca.SX.sym("z", sum(effect.states.values()))
    p = ca.SX.sym("p", len(effect.parameters))
    return s, z, p


def view(names, vector) -> dict:
    """Name -> element of a vector."""
    return {n: vector[i] for i, n in enumerate(names)}


def _split_states(effect: Effect, z) -> dict:
    """State name -> its part of the state vector."""
    parts, at = {}, 0
    for name, size in effect.states.items():
        parts[name] = z[at : at + size]
        at += size
    return parts


def apply(effect: Effect, s, z, p):
    """Call the step with namespaces; return (next state vector, output, {provided signal: SX}). Checks what it returns."""
    returned = effect.step(namespace(**s), namespace(**_split_states(effect, z)), p)
    following, output, *more = returned
    provided = more[0] if more else {}
    if set(following) != set(effect.states):
        raise WorkbenchError(
            f"effect '{effect.name}': step returns states {sorted(following)}, declared are {sorted(effect.states)}."
        )
    if set(provided) != set(effect.provides):
        raise WorkbenchError(
            f"effect '{effect.name}': step provides {sorted(provided)}, declared is {sorted(effect.provides)}."
        )
    after = ca.vertcat(*(ca.densify(ca.SX(following[n])) for n in effect.states)) if effect.states else ca.SX(0, 1)
    return after, ca.densify(ca.SX(output)), {n: ca.densify(ca.SX(v)) for n, v in provided.items()}


def check_linear(effect: Effect) -> None:
    """Refuse an effect whose `linear` parameters do not enter its output linearly and homogeneously, or enter a state."""
    if not effect.linear:
        return
    s, z, p = symbols(effect)
    named = view(effect.parameters, p)
    inside = effect.derive(namespace(**named)) if effect.derive else namespace(**named)
    after, output, _ = apply(effect, view(effect.reads, s), z, inside)
    linear = ca.vertcat(*(named[n] for n in effect.linear))
    slope = ca.jacobian(output, linear)
    where = f"effect '{effect.name}'"
    if any(ca.which_depends(after, linear, 1, False)):
        raise WorkbenchError(f"{where}: a linear parameter ({', '.join(effect.linear)}) enters its states.")
    if any(ca.which_depends(slope, linear, 1, False)):
        raise WorkbenchError(f"{where}: its output is not linear in {', '.join(effect.linear)}.")
    rest = ca.Function("rest", [s, z, p], [ca.substitute(output, linear, ca.SX.zeros(linear.numel()))])
    probe = [np.linspace(0.3, 0.7, max(v.numel(), 0)) for v in (s, z, p)]
    if float(rest(*probe)) != 0.0:
        raise WorkbenchError(f"{where}: its output is not zero where {', '.join(effect.linear)} are zero.")


def _slopes(effect: Effect, s, z, shape):
    """Return (next state vector, columns, {provided signal: SX}), each column as the slope of the output: with one written as the output
    with a one and zeros, n of them take n^2 operations."""
    linear = ca.SX.sym("linear", len(effect.linear))
    following, output, given = apply(
        effect, view(effect.reads, s), z, namespace(**view(effect.shape, shape), **view(effect.linear, linear))
    )
    slope = ca.densify(ca.jacobian(output, linear))
    return following, [slope[k] for k in range(len(effect.linear))], given


def _outside(effect: Effect, insides: Sequence, shape):
    """Return (namespaces of symbols, these as one vector, what derives it from the shape): what is derived is evaluated once, outside the
    loop, and the program sees it as constants."""
    fresh, derived = [], []
    for inside in insides:
        fields = {}
        for field, value in vars(inside).items():
            value = ca.densify(ca.SX(value))
            symbol = ca.SX.sym(field, value.numel())
            derived.append((symbol, ca.vec(value)))
            fields[field] = symbol
        fresh.append(namespace(**fields))
    values = ca.vertcat(*(value for _, value in derived))
    return fresh, ca.vertcat(*(x for x, _ in derived)), ca.Function(f"{effect.name}_derive", [shape], [values])


def build(effect: Effect) -> Step:
    """Return the effect's columns as a program; cached by the definition, whatever the parameter values."""
    return _build(effect.name, effect.step, effect.derive, tuple(effect.states.items()), Definition(effect))


class Definition:
    """An effect that compares equal to any other of the same definition, to key the cache."""

    def __init__(self, effect: Effect):
        self.effect = effect
        self.known = effect.step, tuple(effect.reads), tuple(effect.linear), tuple(effect.provides)

    def __eq__(self, other):
        return self.known == other.known

    def __hash__(self):
        return hash(self.known)


@lru_cache(maxsize=256)
def _build(name, step, derive, states, definition) -> Step:
    effect = definition.effect
    if not getattr(effect.step, "__module__", "").startswith(OWN):  # of these the tests ask it
        check_linear(effect)
    s, z, _ = symbols(effect)
    shape = ca.SX.sym("shape", len(effect.shape))
    columns = effect.linear or ("",)
    constants, function = shape, None
    if len(columns) > APART and not effect.derive:
        after, outputs, provided = _slopes(effect, s, z, shape)
    else:
        insides = []
        for column in columns:
            p = view(effect.shape, shape) | {n: ca.SX(1.0 if n == column else 0.0) for n in effect.linear}
            insides.append(effect.derive(namespace(**p)) if effect.derive else namespace(**p))
        if effect.derive:
            insides, constants, function = _outside(effect, insides, shape)
        steps = [apply(effect, view(effect.reads, s), z, inside) for inside in insides]
        after, _, provided = steps[0]
        outputs = [output for _, output, _ in steps]
    # sine and cosine of one angle share their reduction, and columns of one effect most of their work
    results = ca.cse([after, ca.vertcat(*outputs, *(provided[n] for n in effect.provides))])
    graph = ca.Function(f"{effect.name}_columns", [s, z, constants], results)
    return Step(effect.name, effect.reads, effect.provides, columns, effect.shape, z.numel(), read(graph), function)
