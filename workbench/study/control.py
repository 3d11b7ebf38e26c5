"""The controller's half of a study: design on the extended plant, baselines, comparison, what the effect is worth, export."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from workbench.cancellation.contestant import margins
from workbench.cancellation.worth import with_cancelled
from workbench.checking.modes import all_resonances
from workbench.design.design import Designed, design
from workbench.design.possible import check_plant, design_from_lowest
from workbench.errors import WorkbenchError
from workbench.finding import NOT_TUNED, Finding, title
from workbench.plant import Plant
from workbench.record import Record
from workbench.report import control as chapters
from workbench.schedule import Schedule
from workbench.study.compensating import asked, compensation
from workbench.study.configuration import Study
from workbench.study.control_results import assumptions, compared_part, raised
from workbench.study.controlling import Control, control_of
from workbench.study.drive import driven
from workbench.study.firmware import as_firmware, firmware_part
from workbench.study.leaving import leave
from workbench.study.limit_cycle import limit_cycles
from workbench.study.outcome import Outcome, Part, with_part
from workbench.study.robustness import robustness, slug
from workbench.task.task import Task
from workbench.tracing.result import Trace
from workbench.verification.assumed import Shown
from workbench.verification.compare import Comparison, compare
from workbench.verification.judged import Judged, judged

BASELINES = ("fixed PD", "PI cascade", "profile with PI")
BLIND = (1, 2)  # seeds of the search on the declared model, one from each arrival


def run(
    study: Study, found: Trace, say: Callable[[str], None], records: Sequence[Record] = (), bandwidth: float = 0.0,
    shown: Shown | None = None,
) -> Part:  # fmt: skip
    """Design, compare and export for the plant that the trace ended with.

    records, bandwidth: measured ones, whose resonances limit the gains at each amplitude. shown: what they
    say of all that the study leaves out.
    """
    control = control_of(study.table, found.after.plant, shown)
    plant = control.limited(found.after.plant)
    task = control.task.on(plant)
    response, _ = all_resonances(records, plant, bandwidth)  # gains per amplitude are those of a rigid axis
    made = designed(plant, control, task, say, response=response)
    given = asked(study, plant) if "compensation" in study.table else None
    made = with_cancelled(made, given, task, control.seeds, say)
    say("comparing the controllers")
    worth = judged(made, task, f"scheduled PD ({control.rule})", BASELINES)
    part = compared_part(
        made, worth, task, control, (*assumptions(study.table, control, shown), *raised(control, made))
    )
    if found.causes:
        part = with_part(part, _on_declared(found, worth, control, say))
    tuned = {"digest": plant.digest, "lines": list(plant.digest_lines())}
    part = with_part(part, Part(tables={"tuned_plant": tuned}, files=_written(made, worth, control, task)))
    return _further(part, study, found, made, worth, task, records, bandwidth, control, say)


def _on_declared(found: Trace, worth: Judged, control: Control, say: Callable[[str], None]) -> Part:
    """Return what the causes of a trace are worth to the controller: the same search on the declared model, run on the extended one."""
    declared, task = control.limited(found.before.plant), control.task.on(control.limited(found.after.plant))
    say("tuning on the declared model, for what the effect is worth")
    blind = designed(declared, control, task, say, baselines=False, seeds=BLIND)
    without = compare(task, {worth.ours: blind.tuned[worth.ours].controller})
    known = Comparison(tuple(r for r in worth.comparison.rows if r.controller == worth.ours), ())
    cause = " and ".join(title(c.effect) for c in found.causes)
    chapter = chapters.worth_chapter(without, known, cause, task)
    return Part(chapters=(chapter,), tables={"comparison_tuned_on_declared": [vars(r) for r in without.rows]})


def _written(made: Designed, worth: Judged, control: Control, task: Task) -> tuple[Callable[[Path], None], ...]:
    """Return what writes the files of gains/ into a folder."""
    name, ours, dt = worth.choice.name, worth.ours, task.loop.sample_time
    return (
        lambda folder: write_gains(made, control, folder),
        lambda folder: leave(made.tuned, name, task.plant, dt, folder / "gains", ours, task),
    )


def _further(
    part: Part, study: Study, found: Trace, made: Designed, worth: Judged, task: Task, records: Sequence[Record], bandwidth: float,
    control: Control, say: Callable[[str], None],
) -> Part:  # fmt: skip
    """Return a part with what further tables of study.toml ask of the tuned controllers."""
    factories, name = {n: tuned.controller for n, tuned in made.tuned.items()}, worth.choice.name
    if "robustness" in study.table:
        part = with_part(part, robustness(study, task, factories, say))
        share = part.figures.get(f"share_beyond_final_error_{slug(name)}")
        part = part if share is None else with_part(part, Part({"recommended_share_beyond": share}))
    if "limit_cycle" in study.table:
        part = with_part(part, limit_cycles(study, task, factories, say))
    if "compensation" in study.table:
        part = with_part(part, compensation(study, task, factories, say, margins=partial(margins, made, task)))
    part = with_part(part, firmware_part(as_firmware(made.tuned, name), task, found.verdict, say, made.climbed))
    if "drive" in study.table:
        part = with_part(part, driven(study, task, made, records, bandwidth, control.rule, say))
    return part


def designed(plant: Plant, control: Control, task: Task, say: Callable[[str], None], **options) -> Designed:
    """Return the design for a plant; where the study states no lowest amplitude, from the lowest on that allows any gains."""
    make = design_from_lowest if control.raised else design
    return make(
        plant, control.amplitudes, control.goal, task, per_octave=control.per_octave, tolerance=control.tolerance,
        rule=control.rule, load=control.load, notch=control.notch, say=say, **({"seeds": control.seeds} | options),
    )  # fmt: skip


def write_gains(made: Designed, control: Control, folder) -> None:
    """Write the gain table of the study's rule into gains/."""
    write_table(made.final[control.rule], made.plant, folder / "gains", control.scale)


def write_table(schedule: Schedule, plant: Plant, place, scale: dict | None = None) -> None:
    """Write a gain table into a folder that is made for it."""
    from workbench.exporting import export

    place.mkdir()
    export(schedule, plant, place, scale=scale)


def with_control(outcome: Outcome, study: Study, shown: Shown, say: Callable[[str], None]) -> Outcome:
    """Return the outcome of a study with the controller's half added, or with a finding that says why there is none.

    WorkbenchError where the study requires a figure that there then is not.
    """
    try:
        check_plant(outcome.plant)
        part = run(study, outcome.trace, say, outcome.records, outcome.bandwidth, shown)
    except WorkbenchError as e:
        if {r.name for r in study.requirements} - set(outcome.figures):
            raise
        return replace(outcome, findings=(*outcome.findings, Finding(NOT_TUNED, "gains", f"No gains are tuned: {e}")))
    return with_part(outcome, part)
