"""The paper's first approach: records, virgin curve, equivalents, gains, schedule, steps, tables; and beyond it, a contest.

Everything is derived from the plant that study.toml assumes: the study logs slow sines on it through the sampled loop,
identifies the model, and tunes on the identified one. The controllers are judged on the assumed plant.
"""

from dataclasses import replace

from workbench.description import integrals
from workbench.design.worth import regret_of
from workbench.exporting.feed_forward import export_feed_forward
from workbench.exporting.leaving import leave
from workbench.finding import Finding
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import Plant
from workbench.report import control as control_chapters
from workbench.report.checks import checks_chapter
from workbench.report.contents import Chapter, Paragraph
from workbench.report.contest import asked_table, contest_chapter, margin_figure, standings_table
from workbench.report.ladder import as_table as ladder_table
from workbench.report.ladder import figures_of as ladder_figures
from workbench.report.ladder import ladder_chapter
from workbench.report.loop import loop_chapter
from workbench.report.notch import as_table as notch_table
from workbench.report.notch import notch_sentence
from workbench.report.polish import as_table as gains_table
from workbench.report.polish import polish_chapter
from workbench.report.recommend import RECOMMENDED, recommended_chapter
from workbench.report.reproduction import as_table, counted
from workbench.study import standard
from workbench.study.configuration import Study
from workbench.study.control import Control, control_of
from workbench.study.firmware import as_firmware, firmware_part
from workbench.study.gains import write_gains
from workbench.study.limit_cycle import limit_cycles
from workbench.study.outcome import Outcome, Part, with_part
from workbench.study.robustness import robustness
from workbench.tracing.tracing import trace
from workbench.verification.contest import as_table as contest_table
from workbench.verification.margin import against_margin
from workbench.verification.promise import promise
from workbench.verification.recommend import recommend

from . import controllers, description, paper, records
from .controllers import BEST as PROFILE_PI
from .controllers import CASCADE, ERROR, FIXED, NOMINAL, PAPER, SHORT, SOFT, TRADE
from .records import FIRST, SECOND

FURTHER = ("actuators", "friction", "records", "contest")
CANDIDATES = ("viscous_friction", "stribeck_friction", "coulomb_asymmetry")  # the trace is asked about these
TABLE = "gain table (closing)"
BASELINES = (FIXED, CASCADE, SOFT)
SHOWN = (PAPER, ERROR, CASCADE, PROFILE_PI, SOFT)  # steps


def run(study: Study, say) -> Outcome:
    """Log, identify, describe; tune every controller alike; check, compare and reproduce."""
    known = records.assumed(study, FIRST)
    control = control_of(study.table, known)
    say("logging slow sines")
    seen = records.logged(study, control, known)
    inverses = inverse_dynamics(seen.records, seen.bandwidth)
    found = trace(seen.declared, inverses, say, most=1, only=CANDIDATES)
    alone = identify(seen.declared, inverses[:1])
    curve, fitted = records.virgin_chapter(seen, found.before, alone, inverses)
    model = found.after.plant
    described, deviation = description.equivalents_chapter(model, standard.amplitudes(study))
    outcome = Outcome(
        plant=seen.declared,
        campaign="FHA-8C-50 as assumed, records simulated by this study",
        bandwidth=seen.bandwidth,
        trace=found,
        records=seen.records,
        equivalents=integrals.described(model, standard.amplitudes(study)),
        figures={**found.figures, **fitted, **deviation},
        units={"h0": "N*m", "a": "1/rad"},
        chapters=(curve, described),
        findings=(*found.findings, *found.after.findings),
    )
    outcome = with_part(outcome, contested(study, control, model, known, found.verdict, say))
    return with_part(outcome, second(study, control, say))


def contested(study: Study, control: Control, model: Plant, known: Plant, traced: str, say) -> Part:
    """Everything about controllers on the first actuator. traced: the trace's verdict, which firmware keeps."""
    made, held = controllers.held(study, control, model, known, say=say)
    designed, checks, table = controllers.designed(made, held, control, model, say)
    polished, regret = designed.polished, table.regret_on(held.task)
    kept = promise(known, polished, held.task)
    on, best = table.climbed.on, table.climbed.references
    fewer = {r.family.name: regret_of(on, r, best, held.task) for r in table.rivals.found}
    tuned_too = {n: regret_of(on, held[n].tuned.median, best, held.task) for n in (FIXED, CASCADE, PROFILE_PI)}
    tuned = {n: t for n, t in designed.tuned.items() if n not in (NOMINAL, TRADE)} | {TABLE: table.climbed.best}
    say("tuning with a notch")
    behind, bare = controllers.notched(study, made, held), {n: held[n].tuned.median for n in controllers.BEHIND}
    tuned |= {f"{n}, notch": t for n, t in behind.items()}
    choice = recommend(held.task, tuned, model.displacement)
    say("error against margin")
    asked = study.table.table("contest", ("seeds", "tuning_time"), ("margins", "soft_cascade", "fits"))
    margins = against_margin(
        held.task,
        asked.numbers("margins", (2.0,)),
        lambda limit: controllers.for_margin(control, model, held.task, limit, (PAPER, ERROR, FIXED)),
        tuning_time=asked.quantity("tuning_time", "s", above=0.0),
        found=held,
        say=say,
    )
    missed = controllers.asked_for(held, margins)
    disc = held.task.load_inertias[-1]
    fits = controllers.fitted(study, made, held)
    printed = paper.rows(held, fits)
    figures, units = controllers.figures_of(held)
    loaded = replace(held.task, load_inertias=(disc,))
    steps = (
        control_chapters.step_chapter(held.task, {n: held[n].factory for n in SHOWN}),
        control_chapters.step_chapter(
            loaded, {n: held[n].factory for n in (PAPER, SOFT, CASCADE, PROFILE_PI)}, "loaded"
        ),
    )
    against = contest_chapter(
        held, (PAPER, ERROR, PROFILE_PI), BASELINES, tuple(n for n in held.standings if n not in (SOFT, NOMINAL, TRADE))
    )
    limit = control.goal.sensitivity
    paid = (
        Paragraph(notch_sentence(behind, bare, model.displacement)),
        asked_table(missed, margins.limits, limit),
        margin_figure(margins, "rad", limit),
    )
    against = replace(against, blocks=(*against.blocks, *paid))
    part = Part(
        figures={
            **figures,
            **{f"{m.name}_at_loosest_margin": float(m.values[-1]) for m in missed},
            **counted(printed),
            **controllers.figures_of_steps(polished, kept),
            **ladder_figures(table.climbed, regret),
            "knots": float(made.schedule.knots.size),
            **controllers.figures_of_checks(checks),
        },
        units=units
        | dict.fromkeys(controllers.TIMES, "s")
        | {"phase_margin": "rad"}
        | {f"{m.name}_at_loosest_margin": m.unit for m in missed},
        findings=(Finding(RECOMMENDED, "gains", choice.sentence),),
        chapters=(
            recommended_chapter(choice, model, control.loop.count),
            control_chapters.schedule_chapter(designed, control.rule),
            polish_chapter(polished, kept, model),
            loop_chapter(polished, model, designed.equivalent, control.goal, control.loop),
            ladder_chapter(table.climbed, regret, model, control.rule, fewer, tuned_too),
            *(checks_chapter(c, control.goal.sensitivity, model, rule) for rule, c in checks.items()),
            *steps,
            against,
            paper.chapter(printed),
        ),
        tables={
            "recommended": {"controller": choice.name, "candidates": [vars(r) for r in choice.rows]},
            "tuned_plant": {"digest": model.digest, "lines": list(model.digest_lines())},
            "contest": contest_table(held),
            "gains": gains_table(polished),
            "ladder": ladder_table(table.climbed, regret, fewer | tuned_too),
            "reproduction": as_table(printed),
            "fits": fits,
            "notch": notch_table(behind, bare),
            "error_against_margin": {"limits": margins.limits, **margins.values},
            "asked": [{**vars(m), "had_at": m.had_at(margins.limits)} for m in missed],
        },
        files=(
            lambda folder: write_gains(designed, control, folder),
            lambda folder: leave(tuned, choice.name, model, control.loop.sample_time, folder / "gains", TABLE),
            lambda folder: export_feed_forward(made.feed_forward, model, folder / "gains"),
        ),
    )
    if "robustness" in study.table:
        part = with_part(part, robustness(study, held.task, held.factories, say))
    if "limit_cycle" in study.table:
        part = with_part(part, limit_cycles(study, held.task, held.factories, say))
    return with_part(part, firmware_part(as_firmware(tuned, choice.name), held.task, traced, say, table.climbed))


def second(study: Study, control: Control, say) -> Part:
    """The same contest, in short, on the second actuator."""
    known = records.assumed(study, SECOND)
    say(f"the second actuator, {SECOND}")
    _, held = controllers.held(study, control, known, known, SHORT, say)
    text = (
        "Which actuator the paper drove is not stated. The same controllers, tuned again, on the FHA-8C-30: lighter, faster, "
        "and with less torque. The printed times lie nearer to the bound of the FHA-8C-50."
    )
    figures = {f"{n}_second": v for n, v in {
        "paper_time_over_bound": held.over_bound(PAPER),
        "profile_pi_time_over_bound": held.over_bound(PROFILE_PI),
    }.items()}  # fmt: skip
    return Part(
        figures=figures,
        chapters=(Chapter("The second actuator", (Paragraph(text), standings_table(held))),),
        tables={"contest_second": contest_table(held)},
    )
