"""One program stepped along a record: state in registers, outputs stored.

A step program has inputs (signals, states, constants) and outputs (next states, outputs).
"""

from functools import lru_cache

import numpy as np

from workbench.kernel.cache import JIT, load
from workbench.kernel.program import Program

PREAMBLE = '''"""Generated: {name}. Arithmetic in the order of the symbolic step; strict (no fastmath), so the bits are the same."""

import numba

from workbench.kernel.straight import looped, straight
'''


def module(name: str, call: str, lines: list[str], run: str, loop: list[str]) -> str:
    """Return the text of a module with a compiled function `run` (name and arguments) that does `loop`, in which `call` does the lines."""
    given = run.partition("(")[2]
    text = [
        PREAMBLE.format(name=name),
        *_function("straight", call, lines),
        *_function("looped", f"whole({given}", loop),
    ]
    return "\n".join([*text, JIT, f"def {run}:", f"    whole({given}"]) + "\n"


def _function(kind: str, call: str, lines: list[str]) -> list[str]:
    """Return the lines of a function of a kind (see `workbench.kernel.straight`), with empty ones about it."""
    return ["", f"@{kind}", f"def {call}:", *(f"    {line}" for line in lines), "", ""]


def elements(array: str, n: int) -> str:
    """Return the text of a tuple of the first n elements of an array, one at least."""
    return "".join(f"{array}[{k}], " for k in range(n)).rstrip()


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
    call = f"step(signals, n, {'z, ' if n_states else ''}{'p, ' if n_constants else ''}out)"
    loop = [f"z = {elements('states', n_states)}"] if n_states else []
    loop += [f"p = {elements('constants', n_constants)}"] if n_constants else []
    loop += ["for n in range(signals.shape[1]):", f"    {'z = ' if n_states else ''}{call}"]
    loop += [f"{elements('states', n_states)} = z"] if n_states else []
    return module(program.name, call, lines, "scan(signals, states, constants, out)", loop)


def scan(program: Program, signals: np.ndarray, states: np.ndarray, constants: np.ndarray) -> np.ndarray:
    """Step `program` along signals (n_signals, n) from `states` (n_states,); return outputs (n_outputs, n).

    constants: (n_constants,). The arrays given are not changed.
    """
    signals = np.ascontiguousarray(signals, dtype=float)
    out = np.empty((len(program.outputs[1]), signals.shape[1]))
    start = np.array(states, dtype=float)
    load(source(program), program.name).scan(signals, start, np.asarray(constants, dtype=float), out)
    return out
