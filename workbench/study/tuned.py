"""The design that a study asks for, and what a study's further tables are told of it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from workbench.control import Controller
from workbench.design.design import Designed, design
from workbench.design.possible import design_from_lowest
from workbench.plant import Plant
from workbench.record import Record
from workbench.study.configuration import Study
from workbench.study.control import Control
from workbench.task.task import Task
from workbench.tracing.result import Trace
from workbench.verification.assumed import Shown
from workbench.verification.judged import Judged


@dataclass(frozen=True, eq=False)
class Tuned:
    """study, control: what is asked, and on what the controllers run. shown: what records say of all that the study leaves out. trace:
    whose extended plant is tuned for. records, bandwidth: measured ones, as of `Outcome`. task: on that plant, limited in speed.
    made: the controllers. worth: beside each other."""

    study: Study
    control: Control
    shown: Shown | None
    trace: Trace
    records: Sequence[Record]
    bandwidth: float
    task: Task
    made: Designed
    worth: Judged

    @property
    def factories(self) -> Mapping[str, Callable[[int], Controller]]:
        """Controllers by name, each for so many lanes."""
        return {name: tuned.controller for name, tuned in self.made.tuned.items()}


def designed(plant: Plant, control: Control, task: Task, say: Callable[[str], None], **options) -> Designed:
    """Return the design for a plant; where the study states no lowest amplitude, from the lowest on that allows any gains."""
    make = design_from_lowest if control.raised else design
    return make(
        plant, control.amplitudes, control.goal, task, per_octave=control.per_octave, tolerance=control.tolerance,
        rule=control.rule, load=control.load, notch=control.notch, say=say, **({"seeds": control.seeds} | options),
    )  # fmt: skip
