"""A program cut in two: what depends on constants alone, to be evaluated once, and what is left for the loop.

A factor of a plant that varies over scenarios, the reciprocal of the mass or exp(-h/T) is so computed once a run, with
the same operations in the same order, and therefore with the same bits.
"""

from collections.abc import Sequence
from dataclasses import replace

from workbench.kernel.program import Program


def split(program: Program, constant: Sequence[bool]) -> tuple[Program, Program]:
    """Return (before, after) of a program with one input and one output vector.

    constant (n_in,): which inputs are the same in every step. before: those inputs alone -> the values that the rest
    needs. after: (the other inputs, those values) -> the outputs. An input keeps its index among those of its kind.
    """
    names = {f"i0_{j}": None for j in range(program.inputs[0])}
    once: dict[str, str] = {}  # name -> its name in `before`
    moving: dict[str, str] = {}
    for j, name in enumerate(names):
        (once if constant[j] else moving)[name] = f"i0_{sum(c == constant[j] for c in constant[:j])}"
    early = []
    for line in program.lines:
        if all(o in once or not o.startswith(("w", "i")) for o in (line.a, line.b)):
            once[line.out] = line.out
            early.append(replace(line, a=once.get(line.a, line.a), b=once.get(line.b, line.b)))
    kept: dict[str, str] = {}  # name -> its name in `after`

    def late(name: str) -> str:
        if name in once:
            return kept.setdefault(name, f"i1_{len(kept)}")
        return moving.get(name, name)

    rest = [replace(line, a=late(line.a), b=late(line.b)) for line in program.lines if line.out not in once]
    outputs = tuple(late(name) for name in program.outputs[0])
    n_once = sum(map(bool, constant))
    before = Program(f"{program.name}_once", (n_once,), tuple(early), (tuple(once[n] for n in kept),))
    after = Program(program.name, (len(constant) - n_once, len(kept)), tuple(rest), (outputs,))
    return before, after
