"""From the plant of a trace to gains: designed, held against baselines, judged and exported, with what further tables ask of them."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from workbench.cancellation.worth import with_cancelled
from workbench.checking.modes import all_resonances
from workbench.design.design import Designed
from workbench.design.possible import check_plant
from workbench.errors import WorkbenchError
from workbench.exporting.leaving import leave
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.record import Record
from workbench.schedule import Schedule
from workbench.study import wording
from workbench.study.compared import BASELINES, compared, worth_of_causes
from workbench.study.compensation import asked
from workbench.study.configuration import Study
from workbench.study.control import Control, control_of
from workbench.study.drive import stated
from workbench.study.further import further
from workbench.study.outcome import Outcome, Part, with_part
from workbench.study.tuned import Tuned, designed
from workbench.tracing.result import Trace
from workbench.verification.assumed import Shown, shown_by
from workbench.verification.judged import judged

Say = Callable[[str], None]


def asked_first(study: Study, plant: Plant, inverses: Sequence[InverseDynamics], say: Say) -> Shown:
    """Return what the records say of all that a study leaves out; what is misspelt, or cannot be, is said before anything long starts."""
    shown = shown_by(plant, inverses)
    early(plant, say)
    control = control_of(study.table, plant, shown)
    if "drive" in study.table:
        stated(study.table, plant, control.loop.count)
    return shown


def early(plant: Plant, say: Say) -> None:
    """Say at the start what a run will not come to; it is a finding of the outcome, too."""
    try:
        check_plant(plant)
    except WorkbenchError as e:
        getattr(say, "plainly", say)(wording.no_gains(e))


def run(
    study: Study, found: Trace, say: Say, records: Sequence[Record] = (), bandwidth: float = 0.0, shown: Shown | None = None
) -> Part:  # fmt: skip
    """Design, compare and export for the plant that the trace ended with.

    records, bandwidth: measured ones, whose resonances limit the gains at each amplitude. shown: what they
    say of all that the study leaves out.
    """
    tuned, part = _tuned(study, found, say, records, bandwidth, shown), Part()
    for made in PARTS:
        part = with_part(part, made(tuned, say))
    return part


def _tuned(
    study: Study, found: Trace, say: Say, records: Sequence[Record], bandwidth: float, shown: Shown | None
) -> Tuned:
    """Return the controllers of a study, tuned and judged. Arguments as of `run`."""
    control = control_of(study.table, found.after.plant, shown)
    plant = control.limited(found.after.plant)
    task = control.task.on(plant)
    response, _ = all_resonances(records, plant, bandwidth)  # gains per amplitude are those of a rigid axis
    made = designed(plant, control, task, say, response=response)
    given = asked(study, plant) if "compensation" in study.table else None
    made = with_cancelled(made, given, task, control.seeds, say)
    say("comparing the controllers")
    worth = judged(made, task, f"scheduled PD ({control.rule})", BASELINES)
    return Tuned(study, control, shown, found, records, bandwidth, task, made, worth)


def _written(t: Tuned, say: Say) -> Part:
    """Return what writes the files of gains/ into a folder, and for which plant they are."""
    plant, name, ours, dt = t.task.plant, t.worth.choice.name, t.worth.ours, t.task.loop.sample_time

    def tables(folder: Path) -> None:
        write_gains(t.made, t.control, folder)

    def controllers(folder: Path) -> None:
        leave(t.made.tuned, name, plant, dt, folder / "gains", ours, t.task)

    tuned = {"digest": plant.digest, "lines": list(plant.digest_lines())}
    return Part(tables={"tuned_plant": tuned}, files=(tables, controllers))


PARTS: tuple[Callable[[Tuned, Say], Part], ...] = (compared, worth_of_causes, _written, further)


def write_gains(made: Designed, control: Control, folder: Path) -> None:
    """Write the gain table of the study's rule into gains/."""
    write_table(made.final[control.rule], made.plant, folder / "gains", control.scale)


def write_table(schedule: Schedule, plant: Plant, place: Path, scale: dict | None = None) -> None:
    """Write a gain table into a folder that is made for it."""
    from workbench.exporting import export

    place.mkdir()
    export(schedule, plant, place, scale=scale)


def with_control(outcome: Outcome, study: Study, shown: Shown, say: Say) -> Outcome:
    """Return the outcome of a study with the controller's half added, or with a finding that says why there is none.

    WorkbenchError where the study requires a figure that there then is not.
    """
    try:
        check_plant(outcome.plant)
        part = run(study, outcome.trace, say, outcome.records, outcome.bandwidth, shown)
    except WorkbenchError as e:
        if {r.name for r in study.requirements} - set(outcome.figures):
            raise
        return replace(outcome, findings=(*outcome.findings, wording.not_tuned(e)))
    return with_part(outcome, part)
