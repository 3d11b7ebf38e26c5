"""The paper's second approach: locked output, torsion loop, equivalents, gains over the relative displacement, steps, Table II.

Everything is derived from the plant that study.toml assumes. What a second encoder is worth is shown by cascades on either
encoder and on both.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from workbench.compensation import REFERENCE, Compensator
from workbench.design.design import two_modes
from workbench.errors import WorkbenchError
from workbench.exporting.leaving import leave
from workbench.finding import Finding
from workbench.identification.fit import identify
from workbench.identification.result import Fit
from workbench.inverse.dynamics import inverse_dynamics
from workbench.report import control as control_chapters
from workbench.report.contents import Chapter, Items, Paragraph
from workbench.report.contest import contest_chapter
from workbench.report.recommend import RECOMMENDED, recommended_chapter
from workbench.report.reproduction import as_table, counted
from workbench.study import standard
from workbench.study.compensation import compensation
from workbench.study.configuration import Study
from workbench.study.control import control_of
from workbench.study.firmware import as_firmware, firmware_part
from workbench.study.gains import write_table
from workbench.study.outcome import Outcome, Part, with_part
from workbench.study.robustness import robustness
from workbench.tracing.tracing import trace
from workbench.verification.contest import Contest
from workbench.verification.contest import as_table as contest_table
from workbench.verification.recommend import recommend
from workbench.verification.wording import verdict

from . import controllers, description, hunting, paper
from .controllers import BEST, BOTH, FIXED, JOINT, ON_LOAD, ON_MOTOR, OUTPUT, WIDE, Over
from .plant import Assumed, assumed, declared, free, identified, locked, with_gear, with_ground

FURTHER = ("plant", "records", "encoders", "contest")
CANDIDATES = (
    "presliding_hysteresis",
    "viscous_friction",
    "linear_damping",
    "cubic_stiffness",
)  # the trace is asked about these
SHOWN = (OUTPUT, JOINT, BOTH, ON_MOTOR, BEST)


def run(study: Study, say) -> Outcome:
    """Log with the output locked, identify, describe; tune every controller alike; compare and reproduce."""
    known = assumed(study)
    control = control_of(study.table, known.plant)
    encoders = study.table.table("encoders", ("load",))
    loop = replace(control.loop, load_resolution=encoders.quantity("load", "rad", above=0.0), feedback="load_position")
    say("logging with the output locked")
    records, bandwidth = locked(study, loop, known.plant)
    lacking = declared(known.plant)
    inverses = inverse_dynamics(records, bandwidth)
    found = trace(lacking, inverses, say, most=1, only=CANDIDATES)
    fit = found.before  # the paper's one spring
    apart = identify(with_ground(fit.plant), inverses)
    say("identifying with the output free")
    full = identify(with_gear(fit.plant), inverse_dynamics((*records, free(study, loop, known.plant)), bandwidth))
    model = identified(full.plant, known)
    amplitudes = standard.amplitudes(study)
    outcome = Outcome(
        plant=lacking,
        campaign="FHA-8C-50 as two masses, as assumed, records simulated by this study",
        bandwidth=bandwidth,
        trace=found,
        records=records,
        figures={**found.figures, "identification_error_of_two_hystereses": apart.identification},
        chapters=(
            description.torsion_chapter(fit, apart, records),
            description.equivalents_chapter(description.hysteretic(fit.plant, amplitudes)),
        ),
        findings=(*found.findings, *fit.findings),
    )
    say("gains over the relative displacement")
    over = controllers.over_joint(study, control, fit.plant, model, loop)
    held = controllers.held(study, control, known, model, loop, over, say)
    outcome = with_part(outcome, contested(study, held, model, full, over, found.verdict, say))
    outcome = with_part(outcome, robustness(study, held.task, held.factories, say))
    options = {"model": model.plant, "margins": partial(margins_of, held)}
    outcome = with_part(outcome, compensation(study, held.task, held.factories, say, **options))
    return with_part(outcome, compensation(study, held.task, held.factories, say, of="gear", **options))


def margins_of(held: Contest, name: str, compensator: Compensator, gains: Sequence[float]) -> dict[float, float]:
    """Return gain of the compensation -> Ms: from the reference it closes no path, and the margin is the controller's own."""
    if compensator.source != REFERENCE:
        raise WorkbenchError(
            "the margin of two masses is known for a compensation from the reference; state that source."
        )
    return dict.fromkeys(gains, held[name].median("sensitivity"))


def contested(study: Study, held: Contest, model: Assumed, full: Fit, over: Over, traced: str, say) -> Part:
    """Everything about controllers. model: that they were tuned on, from the fit `full`. traced: verdict, which firmware keeps."""
    variable, counts = description.variable_figure(held, over.schedule.reversal)
    printed = paper.rows(held)
    figures, units = controllers.figures_of(held)
    task, plant = held.task, model.plant
    loaded = replace(task, load_inertias=task.load_inertias[-1:])
    tuned = {n: s.tuned.median for n, s in held.standings.items() if s.tuned}
    choice = recommend(task, tuned, "rad")
    final = two_modes(over.schedule, tuned[JOINT], "following")
    hunts = hunting.looked_at(task, over, final, tuned[JOINT])
    pumping = max(float(np.max(p.pumping / p.damping)) for p in over.passivity(final))
    part = Part(
        figures={
            **figures,
            **counts,
            **counted(printed),
            "joint_pumping_over_damping": pumping,
            **hunting.figures_of(hunts),
        },
        units=units,
        findings=(Finding(RECOMMENDED, "gains", choice.sentence),),
        files=(
            lambda folder: write_table(final, plant, folder / "gains"),
            lambda folder: leave(tuned, choice.name, plant, task.loop.sample_time, folder / "gains", JOINT, task),
        ),
        chapters=(
            recommended_chapter(choice, plant, task.loop.count),
            description.joint_chapter(full, over, held, final, variable),
            hunting.chapter(hunts, pumping),
            control_chapters.step_chapter(task, {n: held[n].factory for n in SHOWN}),
            control_chapters.step_chapter(loaded, {n: held[n].factory for n in SHOWN}, "loaded"),
            contest_chapter(held, (JOINT,), (OUTPUT, WIDE, FIXED, BOTH, BEST), tuple(held.standings)),
            encoders_chapter(held),
            paper.chapter(printed, held),
        ),
        tables={
            "recommended": {"controller": choice.name, "candidates": [vars(r) for r in choice.rows]},
            "tuned_plant": {"digest": plant.digest, "lines": list(plant.digest_lines())},
            "joint_gains": {n: getattr(over.gains, n) for n in ("amplitude", "kp", "kd", "time")},
            "contest": contest_table(held),
            "reproduction": as_table(printed),
        },
    )
    return with_part(part, firmware_part(as_firmware(tuned, choice.name), task, traced, say))


def encoders_chapter(held: Contest) -> Chapter:
    """What the second encoder is worth."""
    one = held[ON_LOAD]
    numbers = one.tuned.median.numbers
    text = (
        "The same cascade, tuned alike, on the motor's encoder, on the output's, and with the position of the output and the speed "
        "of the motor. Between torque and the output's encoder lies the joint, whose resonance turns the phase: speed from there "
        "needs a filter, and its time constant and a notch are tuned with the gains, as of every law here. With "
        f"{1e3 * numbers['velocity_filter']:.2g} ms, a notch at {numbers['notch']:.0f} Hz to {numbers['notch depth']:.2g} and a gain of "
        f"{numbers['kvp']:.2g} N·m·s/rad the output's encoder alone comes to "
        f"{held.over_bound(ON_LOAD):.3f} of the bound, {1e6 * one.median('error'):.0f} µrad nominally and "
        f"{1e6 * one.median('error_grid'):.0f} µrad over the grid. What the second encoder is worth is what the others gain on that."
    )
    said = tuple(verdict(held, BOTH, n, "rad").sentence for n in (ON_MOTOR, ON_LOAD))
    said += (verdict(held, JOINT, OUTPUT, "rad").sentence, verdict(held, ON_LOAD, JOINT, "rad").sentence)
    return Chapter("What the second encoder is worth", (Paragraph(text), Items(said)))
