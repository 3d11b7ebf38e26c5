"""What identifies a law: a firmware and a table know by it that they belong together."""

import zlib

from workbench.firmware.parts import Stages
from workbench.kernel.choice import Choice


def _law_text(stages: Stages, scales: str = "float32") -> str:
    """Return what identifies a law: every instruction of its stages, every constant's formula, and the scales."""
    said = [stages.law.name, stages.feedback, scales, *(c.formula for c in stages.constants)]
    for part in (stages.start, stages.observe, stages.command):
        said += [part.name, *part.rows, *map(str, part.constants)]
        for x in part.program.lines:
            said.append(f"{x.out} {x.op} {x.a} {x.b} {x.condition if isinstance(x, Choice) else ''}")
        said += [f"{n} {v}" for n, v in zip(part.outputs, part.program.outputs[0], strict=True)]
    return "\n".join(said)


def law_code(stages: Stages, scales: str = "float32") -> int:
    """Return the CRC-32 by which a firmware and a table know that they belong together."""
    return zlib.crc32(_law_text(stages, scales).encode())
