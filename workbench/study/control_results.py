"""What a study holds of its controllers: figures, a table for results.json, and what they rest on."""

import numpy as np

from workbench.design.design import Designed
from workbench.finding import Finding
from workbench.readers.declaration import Table
from workbench.report import numbers
from workbench.report.wording import listed
from workbench.study.controlling import Control, Shown
from workbench.task.task import Task
from workbench.verification.compare import Comparison
from workbench.verification.recommend import Recommended

ASSUMED = "assumed loop"


def controllers_table(made: Designed) -> list[dict]:
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


def recommended_figures(choice: Recommended, task: Task, ours: str) -> dict[str, float]:
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
