"""A program evaluated with NumPy: over a time axis (static effects) or over scenarios (the oracle of the lanes)."""

from functools import lru_cache

import numpy as np

from workbench.kernel.program import Program


@lru_cache(maxsize=512)
def compiled(program: Program):
    """Return f(*inputs) -> list of outputs; inputs are sequences of scalars or arrays of one common shape."""
    source = ["def run(inputs):"]
    for i, n in enumerate(program.inputs):
        for j in range(n):
            source.append(f"    i{i}_{j} = inputs[{i}][{j}]")
    source += [f"    {line.out} = {line.text}" for line in program.lines]
    source.append("    return [" + ", ".join("[" + ", ".join(o) + "]" for o in program.outputs) + "]")
    scope = {"select": np.where, "sqrt": np.sqrt, "fabs": np.abs, "floor": np.floor, "INF": np.inf, "NAN": np.nan}
    exec(compile("\n".join(source), f"<{program.name}>", "exec"), scope)  # noqa: S102 - our own generated text
    return scope["run"]


def evaluate(program: Program, *inputs) -> list[list]:
    """Evaluate with NumPy. inputs: one sequence of scalars or arrays per function input; returns the same per output.

    Overflow, division by zero and invalid operations give inf and NaN as in the kernels, without a warning.
    """
    with np.errstate(all="ignore"):
        return compiled(program)(inputs)
