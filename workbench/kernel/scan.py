"""One program stepped along a record: state in registers, outputs stored.

A step program has inputs (signals, states, constants) and outputs (next states, outputs).
"""

from functools import lru_cache

import numpy as np

from workbench.kernel.cache import load
from workbench.kernel.program import Program

PREAMBLE = '''"""Generated: {name}. Arithmetic in the order of the symbolic step; strict (no fastmath), so the bits are the same."""

import numba
import numpy as np
from numpy import floor, sqrt

INF, NAN = np.inf, np.nan


@numba.njit
def select(condition, a, b):
    return a if condition else b


@numba.njit
def fabs(a):
    return abs(a)

'''


@lru_cache(maxsize=512)
def source(program: Program) -> str:
    """Return the text of a module with `scan(signals, states, constants, out)`: see `scan`."""
    n_signals, n_states, n_constants = program.inputs
    text = [PREAMBLE.format(name=program.name)]
    text += ['@numba.njit(cache=True, nogil=True, error_model="numpy")', "def scan(signals, states, constants, out):"]
    text += [f"    i1_{k} = states[{k}]" for k in range(n_states)]
    text += [f"    i2_{k} = constants[{k}]" for k in range(n_constants)]
    text.append("    for n in range(signals.shape[1]):")
    text += [f"        i0_{k} = signals[{k}, n]" for k in range(n_signals)]
    text += [f"        {line.out} = {line.text}" for line in program.lines]
    following, outputs = program.outputs
    text += [f"        n_{k} = {name}" for k, name in enumerate(following)]
    text += [f"        out[{k}, n] = {name}" for k, name in enumerate(outputs)]
    text += [f"        i1_{k} = n_{k}" for k in range(n_states)]
    text += [f"    states[{k}] = i1_{k}" for k in range(n_states)]
    return "\n".join(text) + "\n"


def scan(program: Program, signals: np.ndarray, states: np.ndarray, constants: np.ndarray) -> np.ndarray:
    """Step `program` along signals (n_signals, n) from `states` (n_states,); return outputs (n_outputs, n).

    constants: (n_constants,). The arrays given are not changed.
    """
    signals = np.ascontiguousarray(signals, dtype=float)
    out = np.empty((len(program.outputs[1]), signals.shape[1]))
    start = np.array(states, dtype=float)
    load(source(program), program.name).scan(signals, start, np.asarray(constants, dtype=float), out)
    return out
