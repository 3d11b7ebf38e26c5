"""The controller's half of a study: design on the extended plant, baselines, comparison, what the effect is worth, export."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import isfinite

import numpy as np

from workbench.cancellation.contestant import SUFFIX, margins
from workbench.design.design import Designed, design
from workbench.design.regret import Regret
from workbench.design.worth import regret_of
from workbench.errors import WorkbenchError
from workbench.finding import NOT_TUNED, RESPONSE_LIMITS, Finding, title
from workbench.frequency import Response
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import TWO_MASS, Plant
from workbench.record import VALIDATION, Record
from workbench.report import control as chapters
from workbench.report.ladder import as_table as ladder_table
from workbench.report.ladder import figures_of as ladder_figures
from workbench.report.ladder import ladder_chapter
from workbench.report.loop import loop_chapter
from workbench.report.notch import as_table as notch_table
from workbench.report.notch import notch_sentence
from workbench.report.polish import as_table as gains_table
from workbench.report.polish import polish_chapter
from workbench.report.recommend import RECOMMENDED, recommended_chapter
from workbench.schedule import Schedule
from workbench.study.compensating import asked, compensation, with_compensated
from workbench.study.configuration import Study
from workbench.study.control_results import assumptions, controllers_table, figures_of, raised, recommended_figures
from workbench.study.controlling import Control, Shown, control_of
from workbench.study.drive import driven
from workbench.study.firmware import as_firmware, firmware_part
from workbench.study.leaving import leave
from workbench.study.limit_cycle import limit_cycles
from workbench.study.outcome import Outcome, Part, with_part
from workbench.study.robustness import robustness, slug
from workbench.task.task import Task
from workbench.tracing.result import Trace
from workbench.tuning import OutOfReach
from workbench.verification.assumed import loop_of, move_of
from workbench.verification.compare import Comparison, compare, verdicts
from workbench.verification.promise import promise
from workbench.verification.recommend import recommend

BASELINES = ("fixed PD", "PI cascade", "profile with PI")
BLIND = (1, 2)  # seeds of the search on the declared model, one from each arrival
RAISED = 6  # attempts with the lowest amplitude raised: friction is described anew at each


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
    declared = control.limited(found.before.plant)
    task = control.task.on(plant)
    made = designed(plant, control, task, say, response=_resonant(records, plant, bandwidth))
    given = asked(study, plant) if "compensation" in study.table else None
    made = with_compensated(made, given, task, control.seeds, say)
    say("comparing the controllers")
    ours = f"scheduled PD ({control.rule})"
    factories = {name: tuned.controller for name, tuned in made.tuned.items()}
    comparison = verdicts(compare(task, factories), ours, BASELINES, plant.displacement)
    choice = recommend(task, made.tuned, plant.displacement)
    kept, held = promise(plant, made.polished, task), made.climbed.regret
    against, tuned_too = _on_ladder(made)
    parts = [
        recommended_chapter(choice, plant, task.loop.count),
        polish_chapter(made.polished, kept, plant),
        loop_chapter(made.polished, plant, made.equivalent, control.goal, control.loop),
        chapters.schedule_chapter(made, control.rule),
        ladder_chapter(made.climbed, held, plant, control.rule, against, tuned_too),
        chapters.step_chapter(task, factories),
        chapters.comparison_chapter(
            comparison, task, (notch_sentence(made.tuned, made.unnotched, plant.displacement),)
        ),
    ]
    figures, units = figures_of(made, comparison, ours, plant.displacement)
    figures |= ladder_figures(made.climbed, held) | recommended_figures(choice, task, ours)
    figures["promised_time_deviation"] = kept.deviation
    units |= {"promised_time_deviation": "s", "scheduled_error_grid": plant.displacement}
    tables = {
        "recommended": {
            "controller": choice.name,
            "why": choice.sentence,
            "candidates": [vars(r) for r in choice.rows],
        },
        "controllers": controllers_table(made),
        "gains": gains_table(made.polished),
        "ladder": ladder_table(made.climbed, held, against | tuned_too),
        "comparison": [vars(r) for r in comparison.rows],
        "notch": notch_table(made.tuned, made.unnotched),
    }
    if found.causes:
        say("tuning on the declared model, for what the effect is worth")
        blind = designed(declared, control, task, say, baselines=False, seeds=BLIND)
        without = compare(task, {ours: blind.tuned[ours].controller})
        known = Comparison(tuple(r for r in comparison.rows if r.controller == ours), ())
        cause = " and ".join(title(c.effect) for c in found.causes)
        parts.append(chapters.worth_chapter(without, known, cause, task))
        tables["comparison_tuned_on_declared"] = [vars(r) for r in without.rows]
    tables["tuned_plant"] = {"digest": plant.digest, "lines": list(plant.digest_lines())}
    files = (
        lambda folder: write_gains(made, control, folder),
        lambda folder: leave(made.tuned, choice.name, plant, task.loop.sample_time, folder / "gains", ours, task),
    )
    limits = tuple(f for f in made.findings if f.kind == RESPONSE_LIMITS)
    advice = Finding(RECOMMENDED, "gains", choice.sentence, {}, "")
    said = (advice, *assumptions(study.table, control, shown), *raised(control, made), *limits, *comparison.findings)
    part = Part(figures, units, tuple(parts), said, tables, files)
    if "robustness" in study.table:
        part = with_part(part, robustness(study, task, factories, say))
        share = part.figures.get(f"share_beyond_final_error_{slug(choice.name)}")
        part = part if share is None else replace(part, figures={**part.figures, "recommended_share_beyond": share})
    if "limit_cycle" in study.table:
        part = with_part(part, limit_cycles(study, task, factories, say))
    if "compensation" in study.table:
        part = with_part(part, compensation(study, task, factories, say, margins=partial(margins, made, task)))
    part = with_part(part, firmware_part(as_firmware(made.tuned, choice.name), task, found.verdict, say))
    if "drive" in study.table:
        part = with_part(part, driven(study, task, made, records, bandwidth, control.rule, say))
    return part


def _on_ladder(made: Designed) -> tuple[dict[str, Regret], dict[str, Regret]]:
    """Return the regrets of what has fewer levels than the table, and of those tuned for one step, on its ladder."""
    on, known = made.climbed.on, made.climbed.references
    fewer = {r.family.name: regret_of(on, r, known) for r in made.rivals.found}
    alone = [n for n in made.tuned if n in BASELINES or n.endswith(SUFFIX)]
    return fewer, {n: regret_of(on, made.tuned[n], known) for n in alone}


def designed(plant: Plant, control: Control, task: Task, say: Callable[[str], None], **options) -> Designed:
    """Return the design for a plant; where the study states no lowest amplitude, from the lowest on that allows any gains."""
    for _ in range(RAISED):
        try:
            return design(
                plant, control.amplitudes, control.goal, task, per_octave=control.per_octave,
                tolerance=control.tolerance, rule=control.rule, load=control.load, say=say,
                **({"seeds": control.seeds} | options),
            )  # fmt: skip
        except OutOfReach as e:
            a = control.amplitudes
            if not control.raised or e.lowest is None or a[-1] < 10.0 * e.lowest:
                raise  # a schedule over less than a decade would be none
            reason = e
            control = replace(control, amplitudes=np.geomspace(e.lowest, a[-1], a.size))
    raise reason


def _resonant(records: Sequence[Record], plant: Plant, bandwidth: float) -> Response | None:
    """Return the frequency response of the records where it shows a mode: gains per amplitude are those of a rigid axis."""
    if not records:
        return None
    for e in plant.effects:
        plant = plant.without(e.key) if e.name == "flexible_mode" else plant
    from workbench.checking.modes import resonances

    response, modes = resonances(records, plant, bandwidth)
    return response if modes else None


def write_gains(made: Designed, control: Control, folder) -> None:
    """Write the gain table of the study's rule into gains/."""
    write_table(made.final[control.rule], made.plant, folder / "gains", control.scale)


def write_table(schedule: Schedule, plant: Plant, place, scale: dict | None = None) -> None:
    """Write a gain table into a folder that is made for it."""
    from workbench.exporting import export

    place.mkdir()
    export(schedule, plant, place, scale=scale)


def shown_by(plant: Plant, passes: Sequence[InverseDynamics]) -> Shown:
    """Return what records show of a controller's half: loop, move and speed, by the first that validates."""
    record = next((p.motion.record for p in passes if p.motion.record.role == VALIDATION), passes[0].motion.record)
    speed = max(float(np.abs(p.motion.v).max()) for p in passes)
    return Shown(loop_of(record), *move_of(plant, record), speed, record.name)


TWO_MASSES = (
    "gains over amplitude are those of one mass with one encoder, and this plant is two masses; `workbench trace` closes the "
    "loop of a cascade around it."
)


def check_plant(plant: Plant) -> None:
    """Raise WorkbenchError, with what would mend it, where no gains can be tuned for a plant as it is declared."""
    if not isfinite(plant.limits.drive):
        raise WorkbenchError(
            "campaign.toml states no limit of the drive, and without one the fastest gains are infinite; "
            "state actuator_limit there."
        )
    if plant.kind == TWO_MASS:
        raise WorkbenchError(TWO_MASSES)


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
