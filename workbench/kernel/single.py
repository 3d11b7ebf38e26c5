"""A program evaluated in float32 with NumPy: the reference of the C that kernel.c writes, bit for bit."""

from functools import lru_cache

import numpy as np

from workbench.kernel.program import Program

F = np.float32


def _select(condition, a, b):
    return np.where(condition, F(a) if np.ndim(a) == 0 else a, F(b) if np.ndim(b) == 0 else b)


def _number(name: str) -> str:
    return name if name[0] in "wi" else f"F({name})"


@lru_cache(maxsize=512)
def compiled(program: Program):
    """Return f(*inputs) -> list of outputs; inputs are sequences of float32 arrays."""
    source = ["def run(inputs):"]
    for i, n in enumerate(program.inputs):
        source += [f"    i{i}_{j} = inputs[{i}][{j}]" for j in range(n)]
    source += [f"    {line.out} = {line.text}" for line in program.lines]
    source.append("    return [" + ", ".join("[" + ", ".join(map(_number, o)) + "]" for o in program.outputs) + "]")
    scope = {"select": _select, "sqrt": np.sqrt, "fabs": np.abs, "floor": np.floor, "F": F}
    exec(compile("\n".join(source), f"<{program.name}>", "exec"), scope)  # noqa: S102 - our own generated text
    return scope["run"]


def evaluate(program: Program, *inputs) -> list[list]:
    """Evaluate in float32, rounded to nearest after every operation; inputs are rounded to it first.

    inputs: one sequence of scalars or arrays per function input; returns the same per output, float32 throughout.
    """
    given = [[np.asarray(x, dtype=F)[()] for x in vector] for vector in inputs]
    with np.errstate(all="ignore"):
        found = compiled(program)(given)
    return [[np.asarray(x, dtype=F) for x in vector] for vector in found]
