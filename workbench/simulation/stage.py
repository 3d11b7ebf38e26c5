"""One piece of the loop without branches: named values in, named values out, as a program.

A name stands for a row (one value a lane: states and what one piece hands to the next), for a clock (one value for all
lanes that changes with time) or for a constant (one value, or one a lane, that does not).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from workbench.kernel.program import Program, read

CLOCKS = ("t", "k", "window")  # bench clock in s, number of the sample, 1 in the last window else 0


@dataclass(frozen=True)
class Stage:
    """program: one input vector in the order of `inputs`, one output vector in the order of `outputs`."""

    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    program: Program


def stage(name: str, inputs: Mapping[str, ca.SX], outputs: Mapping[str, ca.SX]) -> Stage:
    """Return a stage; inputs that no output needs are left out."""
    result = ca.vertcat(*(ca.densify(ca.SX(v)) for v in outputs.values()))
    symbols = list(inputs.values())
    needed = ca.which_depends(result, ca.vertcat(*symbols), 1, False) if symbols else []
    used = {n: s for (n, s), need in zip(inputs.items(), needed, strict=True) if need}
    function = ca.Function(name, [ca.vertcat(*used.values(), ca.SX(0, 1))], [ca.cse(result)])
    return Stage(name, tuple(used), tuple(outputs), read(function))
