"""What a study says of its controllers beside each other, and of what the causes of its trace are worth to them."""

from collections.abc import Callable

from workbench.finding import RESPONSE_LIMITS, title
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
from workbench.study import wording
from workbench.study.outcome import Part
from workbench.study.tuned import Tuned, designed
from workbench.verification.compare import compare

FIXED = "fixed PD"
BASELINES = (FIXED, "PI cascade", "profile with PI")


def compared(t: Tuned, say: Callable[[str], None]) -> Part:
    """Return what a study says of its controllers beside each other: figures, chapters and tables."""
    made, worth, task, control = t.made, t.worth, t.task, t.control
    plant, x, held = task.plant, task.plant.displacement, made.climbed.regret
    parts = (
        recommended_chapter(worth.choice, plant, task.loop.count),
        polish_chapter(made.polished, worth.promise, plant),
        loop_chapter(made.polished, plant, made.equivalent, control.goal, control.loop),
        chapters.schedule_chapter(made, control.rule),
        ladder_chapter(made.climbed, held, plant, control.rule, worth.fewer, worth.alone),
        chapters.step_chapter(task, t.factories),
        chapters.comparison_chapter(worth.comparison, task, (notch_sentence(made.tuned, made.unnotched, x),)),
    )
    figures = worth.table_figures(made, FIXED)
    units = {n: x for n in figures if n.startswith("scheduled_final_error")}
    figures |= ladder_figures(made.climbed, held) | worth.recommended_figures(task.loop.count)
    figures["promised_time_deviation"] = worth.promise.deviation
    units |= {"promised_time_deviation": "s", "scheduled_error_grid": x}
    said = wording.rests_on(t.study.table, control, t.shown, made)
    limits = tuple(f for f in made.findings if f.kind == RESPONSE_LIMITS)
    findings = (wording.recommended(worth.choice), *said, *limits, *worth.comparison.findings)
    return Part(figures, units, parts, findings, _tables(t))


def _tables(t: Tuned) -> dict[str, object]:
    """Return the design as results.json holds it."""
    made, worth = t.made, t.worth
    choice = worth.choice
    return {
        "recommended": {
            "controller": choice.name,
            "why": choice.sentence,
            "candidates": [vars(r) for r in choice.rows],
        },
        "controllers": [
            {
                "controller": n,
                "numbers": one.numbers,
                "cost": one.value,
                "points_tried": one.evaluations,
                "seed": one.seed,
            }
            for n, one in made.tuned.items()
        ],
        "gains": gains_table(made.polished),
        "ladder": ladder_table(made.climbed, made.climbed.regret, {**worth.fewer, **worth.alone}),
        "comparison": [vars(r) for r in worth.comparison.rows],
        "notch": notch_table(made.tuned, made.unnotched),
    }


def worth_of_causes(t: Tuned, say: Callable[[str], None]) -> Part:
    """Return what the causes of a trace are worth to the controller: the same search on the declared model, run on the extended one.

    From as many seeds, so that the luck of a search is alike on both."""
    if not t.trace.causes:
        return Part()
    ours = t.worth.ours
    say("tuning on the declared model, for what the effect is worth")
    blind = designed(t.control.limited(t.trace.before.plant), t.control, t.task, say, baselines=False)
    without = compare(t.task, {ours: blind.tuned[ours].controller})
    cause = " and ".join(title(c.effect) for c in t.trace.causes)
    chapter = chapters.worth_chapter(without, t.worth.of_ours, cause, t.task)
    return Part(chapters=(chapter,), tables={"comparison_tuned_on_declared": [vars(r) for r in without.rows]})
