"""From the plant of a trace to gains: designed, held against baselines, judged and exported, with what further tables ask of them."""

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
from workbench.exporting.leaving import leave
from workbench.finding import RESPONSE_LIMITS, Finding, title
from workbench.firmware.naming import slug
from workbench.plant import Plant
from workbench.record import Record
from workbench.report import control as chapters
from workbench.report.ladder import as_table as ladder_table
from workbench.report.ladder import figures_of as ladder_figures
from workbench.report.ladder import ladder_chapter
from workbench.report.loop import loop_chapter
from workbench.report.notch import as_table as notch_table
from workbench.report.notch import notch_sentence
from workbench.report.polish import as_table as gains_table
from workbench.report.polish import polish_chapter
from workbench.report.recommend import recommended_chapter
from workbench.schedule import Schedule
from workbench.study import wording
from workbench.study.compensation import asked, compensation
from workbench.study.configuration import Study
from workbench.study.control import Control, control_of
from workbench.study.drive import driven
from workbench.study.firmware import as_firmware, firmware_part
from workbench.study.limit_cycle import limit_cycles
from workbench.study.outcome import Outcome, Part, with_part
from workbench.study.robustness import robustness
from workbench.task.task import Task
from workbench.tracing.result import Trace
from workbench.verification.assumed import Shown
from workbench.verification.compare import compare
from workbench.verification.judged import Judged, judged

FIXED = "fixed PD"
BASELINES = (FIXED, "PI cascade", "profile with PI")
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
    part = _compared(made, worth, task, control, wording.rests_on(study.table, control, shown, made))
    if found.causes:
        part = with_part(part, _on_declared(found, worth, control, say))
    tuned = {"digest": plant.digest, "lines": list(plant.digest_lines())}
    part = with_part(part, Part(tables={"tuned_plant": tuned}, files=_written(made, worth, control, task)))
    return _further(part, study, found, made, worth, task, records, bandwidth, control, say)


def _compared(made: Designed, worth: Judged, task: Task, control: Control, said: Sequence[Finding]) -> Part:
    """Return what a study says of its controllers beside each other: figures, chapters and tables. said: what they rest on."""
    plant, x, held = task.plant, task.plant.displacement, made.climbed.regret
    factories = {name: tuned.controller for name, tuned in made.tuned.items()}
    parts = (
        recommended_chapter(worth.choice, plant, task.loop.count),
        polish_chapter(made.polished, worth.promise, plant),
        loop_chapter(made.polished, plant, made.equivalent, control.goal, control.loop),
        chapters.schedule_chapter(made, control.rule),
        ladder_chapter(made.climbed, held, plant, control.rule, worth.fewer, worth.alone),
        chapters.step_chapter(task, factories),
        chapters.comparison_chapter(worth.comparison, task, (notch_sentence(made.tuned, made.unnotched, x),)),
    )
    figures = worth.table_figures(made, FIXED)
    units = {n: x for n in figures if n.startswith("scheduled_final_error")}
    figures |= ladder_figures(made.climbed, held) | worth.recommended_figures(task.loop.count)
    figures["promised_time_deviation"] = worth.promise.deviation
    units |= {"promised_time_deviation": "s", "scheduled_error_grid": x}
    limits = tuple(f for f in made.findings if f.kind == RESPONSE_LIMITS)
    findings = (wording.recommended(worth.choice), *said, *limits, *worth.comparison.findings)
    return Part(figures, units, parts, findings, _tables(made, worth))


def _tables(made: Designed, worth: Judged) -> dict[str, object]:
    """Return the design as results.json holds it."""
    choice = worth.choice
    return {
        "recommended": {
            "controller": choice.name,
            "why": choice.sentence,
            "candidates": [vars(r) for r in choice.rows],
        },
        "controllers": [
            {"controller": n, "numbers": t.numbers, "cost": t.value, "points_tried": t.evaluations, "seed": t.seed}
            for n, t in made.tuned.items()
        ],
        "gains": gains_table(made.polished),
        "ladder": ladder_table(made.climbed, made.climbed.regret, {**worth.fewer, **worth.alone}),
        "comparison": [vars(r) for r in worth.comparison.rows],
        "notch": notch_table(made.tuned, made.unnotched),
    }


def _on_declared(found: Trace, worth: Judged, control: Control, say: Callable[[str], None]) -> Part:
    """Return what the causes of a trace are worth to the controller: the same search on the declared model, run on the extended one."""
    declared, task = control.limited(found.before.plant), control.task.on(control.limited(found.after.plant))
    say("tuning on the declared model, for what the effect is worth")
    blind = designed(declared, control, task, say, baselines=False, seeds=BLIND)
    without = compare(task, {worth.ours: blind.tuned[worth.ours].controller})
    cause = " and ".join(title(c.effect) for c in found.causes)
    chapter = chapters.worth_chapter(without, worth.of_ours, cause, task)
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
        return replace(outcome, findings=(*outcome.findings, wording.not_tuned(e)))
    return with_part(outcome, part)
