"""One program run over lanes: many independent evaluations of the same arithmetic, side by side.

The loop over lanes has no branch and no call, so the compiler puts several lanes into one vector register; it does so up
to about twenty rows in and out together, beyond which it gives up proving that they do not overlap.
"""

from functools import lru_cache

import numpy as np

from workbench.kernel.cache import load
from workbench.kernel.program import Program
from workbench.kernel.scan import elements, module


@lru_cache(maxsize=512)
def source(program: Program) -> str:
    """Return the text of a module with `lanes(inputs, constants, out)`: see `map_lanes`."""
    n_inputs, n_constants = (*program.inputs, 0)[:2]
    lines = [f"i1_{k} = p[{k}]" for k in range(n_constants)]
    lines += [f"i0_{k} = inputs[{k}, lane]" for k in range(n_inputs)]
    lines += [f"{line.out} = {line.text}" for line in program.lines]
    lines += [f"out[{k}, lane] = {name}" for k, name in enumerate(program.outputs[0])]
    call = f"one(inputs, lane, {'p, ' if n_constants else ''}out)"
    loop = [f"p = {elements('constants', n_constants)}"] if n_constants else []
    loop += ["for lane in range(inputs.shape[1]):", f"    {call}"]
    return module(program.name, call, lines, "lanes(inputs, constants, out)", loop)


def map_lanes(program: Program, inputs: np.ndarray, constants=()) -> np.ndarray:
    """Evaluate a program of one output vector at inputs (n_in, n), one lane a column; return (n_out, n).

    constants (n_constants,): the program's second input vector where it has one, the same in every lane. The bits are
    those of kernel.arrays.evaluate and of the CasADi function that the program was read from.
    """
    inputs = np.ascontiguousarray(inputs, dtype=float)
    out = np.empty((len(program.outputs[0]), inputs.shape[1]))
    load(source(program), program.name).lanes(inputs, np.array(constants, dtype=float), out)
    return out
