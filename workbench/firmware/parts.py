"""The parts that a law's firmware is made of: stages of instructions, and the numbers that its table holds."""

from dataclasses import dataclass

from workbench.control.law import Law
from workbench.firmware.units import Power
from workbench.kernel.program import Program


@dataclass(frozen=True)
class Constant:
    """A number that the table holds. formula: of what the engineer states; identifier: its name in C."""

    identifier: str
    formula: str
    power: Power


@dataclass(frozen=True, eq=False)
class Part:
    """rows: what moves, in the order of the program's first input; constants: places in Stages.constants, of its second.

    names: value -> the name it gets in C. powers: value -> unit.
    """

    name: str
    rows: tuple[str, ...]
    constants: tuple[int, ...]
    outputs: tuple[str, ...]
    program: Program
    names: dict[str, str]
    powers: dict[str, Power]


@dataclass(frozen=True, eq=False)
class Stages:
    """start: states at rest. before: (given names, program) -> constants, evaluated once.

    states: what the firmware keeps from sample to sample.
    """

    law: Law
    feedback: str
    start: Part
    observe: Part
    command: Part
    given: tuple[str, ...]
    before: Program
    constants: tuple[Constant, ...]
    states: tuple[str, ...]

    @property
    def both(self) -> bool:
        """Whether two encoders are read."""
        return self.law.both

    def place(self, formula: str) -> int:
        """Where a constant is that is nothing but a given number."""
        return next(i for i, c in enumerate(self.constants) if c.formula == formula)

    @property
    def columns(self) -> tuple[str, ...]:
        return self.law.columns
