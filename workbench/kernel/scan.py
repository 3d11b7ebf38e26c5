"""One program stepped along a record: state in registers, outputs stored.

A step program has inputs (signals, states, constants) and outputs (next states, outputs).
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from workbench.kernel.cache import JIT, load
from workbench.kernel.program import Program

PREAMBLE = '''"""Generated: {name}. Arithmetic in the order of the symbolic step; strict (no fastmath), so the bits are the same."""

import numba

from workbench.kernel.straight import straight
'''


def function(name: str, arguments: Sequence[str], lines: list[str]) -> list[str]:
    """Return the lines of a straight function (see `workbench.kernel.straight`), with empty ones about it."""
    return ["", "@straight", f"def {name}({', '.join(arguments)}):", *(f"    {line}" for line in lines), "", ""]


def held(name: str, array: str, n: int) -> tuple[list[str], list[str]]:
    """Return the lines of a straight function, and of its call, by which a tuple has the first n elements of an array, which are then not read
    again; none where there are none."""
    if not n:
        return [], []
    return function(f"{name}_of", (array,), [f"return {''.join(f'{array}[{k}], ' for k in range(n))}"]), [
        f"    {name} = {name}_of({array})"
    ]


@lru_cache(maxsize=512)
def source(program: Program) -> str:
    """Return the text of a module with `scan(signals, states, constants, out)`: see `scan`."""
    n_signals, n_states, n_constants = program.inputs
    lines = [f"i1_{k} = z[{k}]" for k in range(n_states)]
    lines += [f"i2_{k} = p[{k}]" for k in range(n_constants)]
    lines += [f"i0_{k} = signals[{k}, n]" for k in range(n_signals)]
    lines += [f"{line.out} = {line.text}" for line in program.lines]
    following, outputs = program.outputs
    lines += [f"out[{k}, n] = {name}" for k, name in enumerate(outputs)]
    lines += [f"return {''.join(f'{name}, ' for name in following)}"] if n_states else []
    begun, begin = held("z", "states", n_states)
    fixed, fix = held("p", "constants", n_constants)
    given = ["signals", "n", *(["z"] if n_states else []), *(["p"] if n_constants else []), "out"]
    text = [PREAMBLE.format(name=program.name), *begun, *fixed, *function("step", given, lines)]
    if n_states:
        text += function("keep", ("states", "z"), [f"states[{k}] = z[{k}]" for k in range(n_states)])
    text += [JIT, "def scan(signals, states, constants, out):"]
    text += [*begin, *fix, "    for n in range(signals.shape[1]):"]
    text += [f"        {'z = ' if n_states else ''}step({', '.join(given)})"]
    text += ["    keep(states, z)"] if n_states else []
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
