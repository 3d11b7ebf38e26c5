"""What a study holds of its controllers: figures, a table for results.json, and what they rest on."""

from collections.abc import Sequence

import numpy as np

from workbench.design.design import Designed
from workbench.finding import RESPONSE_LIMITS, Finding
from workbench.readers.declaration import Table
from workbench.report import control as chapters
from workbench.report import numbers
from workbench.report.ladder import as_table as ladder_table
from workbench.report.ladder import figures_of as ladder_figures
from workbench.report.ladder import ladder_chapter
from workbench.report.loop import loop_chapter
from workbench.report.notch import as_table as notch_table
from workbench.report.notch import notch_sentence
from workbench.report.polish import as_table as gains_table
from workbench.report.polish import polish_chapter
from workbench.report.recommend import RECOMMENDED, recommended_chapter
from workbench.report.wording import listed
from workbench.study.controlling import Control
from workbench.study.outcome import Part
from workbench.task.task import Task
from workbench.verification.assumed import Shown
from workbench.verification.compare import Comparison
from workbench.verification.judged import Judged
from workbench.verification.recommend import Recommended

ASSUMED = "assumed loop"


def _controllers_table(made: Designed) -> list[dict]:
    """Every tuned controller as results.json holds it."""
    return [
        {"controller": n, "numbers": t.numbers, "cost": t.value, "points_tried": t.evaluations, "seed": t.seed}
        for n, t in made.tuned.items()
    ]


def _figures_of(made: Designed, comparison: Comparison, ours: str, x: str) -> tuple[dict, dict]:
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


def _recommended_figures(choice: Recommended, task: Task, ours: str) -> dict[str, float]:
    """Return what the recommended controller leaves nominally, in counts, and the schedule's worst over the grid."""
    mine = next(r for r in choice.rows if r.name == ours)
    return {
        "recommended_error_counts": choice.row.error / task.loop.count if task.loop.count else float("nan"),
        "scheduled_error_grid": mine.error_grid,
        "scheduled_overshoot_grid": mine.overshoot_grid,
    }


def assumptions(top: Table, control: Control, shown: Shown | None) -> tuple[Finding, ...]:
    """Return what the gains rest on that the study does not state and the records had to say, one finding or none."""
    keys = (("loop", "sample_time"), ("loop", "resolution"), ("task", "step"))
    left = [f"{table}.{key}" for table, key in keys if key not in top.values.get(table, {})]
    if shown is None or not left:
        return ()
    loop, task, x = control.loop, control.task, control.task.plant.displacement
    sentence = (
        f"The gains are for a loop of {1e3 * loop.sample_time:.4g} ms with {1e3 * loop.delay:.4g} ms of delay, an encoder of "
        f"{loop.resolution:.3g} {x}, and a step of {task.step:.3g} {x} at no more than {control.speed_limit:.3g} {x}/s; of "
        f"these, {listed(left)} are assumed from record '{shown.record}'."
    )
    return (Finding(ASSUMED, "gains", sentence, {}, "State what is known of them in study.toml."),)


def raised(control: Control, made: Designed) -> tuple[Finding, ...]:
    """Return a finding where no gains keep the goal at amplitudes that would have been tuned."""
    lowest, x = float(made.gains.amplitude[0]), made.plant.displacement
    if lowest <= control.amplitudes[0]:
        return ()
    sentence = (
        f"Below {numbers.scaled(lowest, x)} no gains keep |S| below {control.goal.sensitivity:g} and the overshoot against the axis's own "
        f"stiffness in a loop of {1e3 * control.loop.sample_time:.4g} ms; those of {numbers.scaled(lowest, x)} are held there."
    )
    return (Finding("constraint dropped", "gains", sentence, {"lowest": lowest}, "Sample faster, or delay less."),)


def compared_part(made: Designed, worth: Judged, task: Task, control: Control, said: Sequence[Finding]) -> Part:
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
    figures, units = _figures_of(made, worth.comparison, worth.ours, x)
    figures |= ladder_figures(made.climbed, held) | _recommended_figures(worth.choice, task, worth.ours)
    figures["promised_time_deviation"] = worth.promise.deviation
    units |= {"promised_time_deviation": "s", "scheduled_error_grid": x}
    limits = tuple(f for f in made.findings if f.kind == RESPONSE_LIMITS)
    advice = Finding(RECOMMENDED, "gains", worth.choice.sentence, {}, "")
    findings = (advice, *said, *limits, *worth.comparison.findings)
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
        "controllers": _controllers_table(made),
        "gains": gains_table(made.polished),
        "ladder": ladder_table(made.climbed, made.climbed.regret, {**worth.fewer, **worth.alone}),
        "comparison": [vars(r) for r in worth.comparison.rows],
        "notch": notch_table(made.tuned, made.unnotched),
    }
