"""The controller's half of a study: design on the extended plant, baselines, comparison, what the effect is worth, export."""

from collections.abc import Callable, Sequence

import numpy as np

from workbench.finding import title
from workbench.frequency import Response
from workbench.plant import Plant
from workbench.record import Record
from workbench.report import control as chapters
from workbench.study.configuration import Study
from workbench.study.controlling import Control, control_of
from workbench.study.hunting import limit_cycles
from workbench.study.outcome import Part, with_part
from workbench.study.series import robustness
from workbench.trace.result import Trace
from workbench.verify.compare import Comparison, compare, verdicts
from workbench.verify.design import RULES, Designed, design

BASELINES = ("fixed PD", "PI cascade")


def run(
    study: Study, found: Trace, say: Callable[[str], None], records: Sequence[Record] = (), bandwidth: float = 0.0
) -> Part:
    """Design, compare and export for the plant that the trace ended with.

    records, bandwidth: measured ones, whose resonances limit the gains where the plant does not have them.
    """
    control = control_of(study.table, found.after.plant)
    plant = control.limited(found.after.plant)
    declared = control.limited(found.before.plant)
    task = control.task.on(plant)
    made = design(
        plant, control.amplitudes, control.goal, task,
        per_octave=control.per_octave, tolerance=control.tolerance, seed=control.seed, say=say,
        response=resonant(records, plant, bandwidth),
    )  # fmt: skip
    say("comparing the controllers")
    ours = f"scheduled PD ({control.rule})"
    makers = {name: tuned.controller for name, tuned in made.tuned.items()}
    comparison = verdicts(compare(task, makers), ours, BASELINES, plant.displacement)
    parts = [chapters.schedule_chapter(made, control.rule), chapters.step_chapter(task, makers)]
    parts.append(chapters.comparison_chapter(comparison, task))
    figures, units = figures_of(made, comparison, ours, plant.displacement)
    tables = {"controllers": controllers(made), "comparison": [vars(r) for r in comparison.rows]}
    if found.causes:
        say("tuning on the declared model, for what the effect is worth")
        blind = design(
            declared, control.amplitudes, control.goal, task,
            per_octave=control.per_octave, tolerance=control.tolerance, seed=control.seed, say=say, baselines=False,
        )  # fmt: skip
        names = [f"scheduled PD ({r})" for r in RULES]
        without = compare(task, {n: blind.tuned[n].controller for n in names})
        known = Comparison(tuple(r for r in comparison.rows if r.controller in names), ())
        cause = " and ".join(title(c.effect) for c in found.causes)
        parts.append(chapters.worth_chapter(without, known, cause, task))
        tables["comparison_tuned_on_declared"] = [vars(r) for r in without.rows]
    files = (lambda folder: write_gains(made, control, folder),)
    limits = tuple(f for f in made.findings if f.kind == "response limits")
    part = Part(figures, units, tuple(parts), (*limits, *comparison.findings), tables, files)
    if "robustness" in study.table:
        part = with_part(part, robustness(study, task, makers, say))
    if "limit_cycle" in study.table:
        part = with_part(part, limit_cycles(study, task, makers, say))
    return part


def resonant(records: Sequence[Record], plant: Plant, bandwidth: float) -> Response | None:
    """Return the frequency response of the records where it shows a mode that the plant does not have."""
    if not records:
        return None
    from workbench.check.modes import resonances

    response, modes = resonances(records, plant, bandwidth)
    return response if modes else None


def write_gains(made: Designed, control: Control, folder) -> None:
    """Write the gain table of the study's rule into gains/."""
    from workbench.export import export

    place = folder / "gains"
    place.mkdir()
    export(made.final[control.rule], made.plant, place, scale=control.scale)


def controllers(made: Designed) -> list[dict]:
    """Every tuned controller as results.json holds it."""
    return [
        {"controller": n, "numbers": t.numbers, "cost": t.value, "points_tried": t.evaluations, "seed": t.seed}
        for n, t in made.tuned.items()
    ]


def figures_of(made: Designed, comparison: Comparison, ours: str, x: str) -> tuple[dict, dict]:
    """Return (figures, units) by which a study may be judged."""
    first = comparison.rows[0].load_inertia
    mine = [r for r in comparison.rows if r.controller == ours]
    fixed = comparison.row("fixed PD", first)
    free = comparison.row(ours, first)
    figures = {
        "sensitivity_peak": float(np.max(made.gains.sensitivity_peak)),
        "schedule_interpolation_error": float(made.schedule.interpolation_error),
        "schedule_knots": float(made.schedule.knots.size),
        "scheduled_time_over_bound": free.over_bound,
        "scheduled_time_over_bound_worst": max(r.over_bound for r in mine),
        "scheduled_final_error": free.final_error,
        "scheduled_final_error_worst": max(r.final_error for r in mine),
        "scheduled_error_over_fixed": free.final_error / fixed.final_error,
    }
    return figures, {n: x for n in figures if n.startswith("scheduled_final_error")}


def with_control(outcome, study: Study, say: Callable[[str], None]):
    """Return the outcome of a study with the controller's half added."""
    return with_part(outcome, run(study, outcome.trace, say, outcome.records, outcome.bandwidth))
