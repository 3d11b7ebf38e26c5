"""Figures of the second approach: the torsion loop, its equivalents, gains over the relative displacement, and its counts."""

from dataclasses import replace

import numpy as np

from workbench.description import Equivalent, equivalent
from workbench.plant import Plant
from workbench.report import numbers
from workbench.report.contents import Chapter, Figure, Paragraph
from workbench.report.drawing import AFTER, BEFORE, MEASURED, MUTED, decades, svg
from workbench.schedule import Schedule
from workbench.verification.contest import Contest

from .controllers import JOINT, WIDE, Over


def torsion_chapter(fit, apart, records) -> Chapter:
    """Torque over deflection with the output locked: the record and the model. apart: with a hysteresis at the motor too."""
    found = {(e.effect, e.parameter): e for e in fit.estimates}
    k1, k2 = (found["piecewise_stiffness", n].value for n in ("k1", "k2"))
    h0 = sum(e.value for (_, n), e in found.items() if n == "h0")
    heading = f"The joint stiffens from {k1:.0f} to {k1 + k2:.0f} N·m/rad, with a hysteresis of {1e3 * h0:.0f} mN·m"
    series = fit.series[records[0].name]

    def draw(axes):
        some = slice(series.keep.start, series.keep.stop, 8)
        axes[0].plot(1e3 * series.position[some], series.measured[some], ".", ms=1.5, color=MEASURED, label="logged")
        axes[0].plot(1e3 * series.position[some], series.predicted[some], "-", lw=0.7, color=AFTER, label="model")
        axes[0].set_xlabel("displacement of the input side, output locked (mrad)")
        axes[0].set_ylabel("torque (N·m)")
        axes[0].legend(loc="upper left")

    figure = Figure(
        "torsion", lambda: svg(heading, draw, height=3.2),
        "Counterpart of Figs. 2 and 12: random torque up to 1 Hz, output locked.", f"Torque over deflection. {heading}.",
    )  # fmt: skip
    text = (
        "Two masses on one equivalent spring (Figs. 4 and 11). All records are simulated by this study. With the output locked, "
        "friction of the motor's side and hysteresis of the joint both follow the motor's displacement; the paper lets one "
        f"hysteretic spring stand for both. That leaves {numbers.percent(fit.identification)} of the torque, more than noise "
        f"and encoders do, in part because one virgin curve stands for two. With a second one at the motor "
        f"{numbers.percent(apart.identification)} is left; which of them acts where a locked output cannot tell."
    )
    return Chapter("Torsion with the output locked", (Paragraph(text), figure))


def hysteretic(plant: Plant, amplitudes: np.ndarray) -> Equivalent:
    """Return the equivalents of all hysteresis of the joint together: in parallel, they add."""
    parts = [equivalent(e, amplitudes) for e in plant.effects if e.name == "presliding_hysteresis"]
    return replace(parts[0], stiffness=sum(p.stiffness for p in parts), loss=sum(p.loss for p in parts))


def equivalents_chapter(q: Equivalent) -> Chapter:
    """Equivalent stiffness and loss of the hysteretic part."""
    i = int(np.argmax(q.loss))
    heading = f"The hysteretic part gives {q.stiffness[0]:.0f} N·m/rad at first; its loss is largest at {1e3 * q.amplitude[i]:.2f} mrad"

    def draw(axes):
        for axis, values, name in zip(axes, (q.stiffness, q.loss), ("kₑ", "cₑω"), strict=True):
            axis.loglog(q.amplitude, values, "-", color=AFTER)
            axis.set_ylabel(f"{name} (N·m/rad)")
            decades(axis.xaxis)
            decades(axis.yaxis)
        axes[1].set_xlabel("amplitude of the relative displacement, zero to peak (rad)")

    figure = Figure(
        "hysteretic_part", lambda: svg(heading, draw, rows=2, height=3.6, share=True),
        "Counterpart of Fig. 13, of the identified hysteresis.", f"Two graphs over amplitude. {heading}.",
    )  # fmt: skip
    return Chapter("Equivalents of the hysteretic part", (figure,))


def joint_chapter(full, over: Over, found: Contest, final: Schedule, variable: Figure) -> Chapter:
    """Gains over the relative displacement: tuned at each amplitude, the schedule through them, and what the search makes of it."""
    ground = full.plant["presliding_hysteresis@motor"].parameters["h0"].value
    gains, wide = over.gains, found[WIDE]
    text = (
        "The equivalents of the one spring that is identified with the output locked give a PD for each of "
        f"{gains.amplitude.size} amplitudes of the relative displacement: the shortest 1 % time of both masses, with every load, "
        "within |S| and overshoot, position from the output and speed from the motor. A quadratic program makes a schedule of "
        "them. Within Ms they hardly depend on the amplitude, since the spring does not: Kp from "
        f"{gains.kp.min():.0f} to {gains.kp.max():.0f} N·m/rad. A large step needs gains of gross sliding, too, which that model does "
        "not know; they, the switch to them, a factor on each of the tuned gains, the velocity filter and a notch on the "
        "resonance, which lets both gains be stiffer within the same Ms, are searched on the simulated plant as "
        "identified with the output free as well "
        f"(friction to ground {1e3 * ground:.0f} mN·m), for the nominal axis, with the overshoot held over the grid. "
        f"That leaves {1e6 * found[JOINT].median('error'):.0f} µrad nominally and {1e6 * found[JOINT].median('error_grid'):.0f} µrad "
        f"in the worst case of the grid. Tuned for that worst case the same schedule leaves {1e6 * wide.median('error'):.0f} and "
        f"{1e6 * wide.median('error_grid'):.0f} µrad: the trade is nominal against worst case, at one margin. The variable is small: "
        "a few counts of the motor's encoder without load, of which the gear's error, which moves the reading and not the torque, "
        "is a large part."
    )
    return Chapter("Gains over the relative displacement", (Paragraph(text), schedule_figure(over, final), variable))


def schedule_figure(over: Over, final: Schedule) -> Figure:
    """Gains over the relative displacement: tuned, scheduled, and as the search ended."""
    gains, first = over.gains, over.schedule
    heading = (
        f"Within Ms, Kp over the relative displacement varies by a factor of {gains.kp.max() / gains.kp.min():.2f}"
    )

    def draw(axes):
        for axis, name in zip(axes, ("kp", "kd"), strict=True):
            axis.loglog(
                gains.amplitude, getattr(gains, name), "o", ms=3, color=MEASURED, label="tuned at each amplitude"
            )
            axis.loglog(first.knots, getattr(first, name), "-", color=BEFORE, label="schedule")
            axis.loglog(
                final.knots, getattr(final, name), "-", color=AFTER, label="after the search, with gross sliding"
            )
            decades(axis.xaxis)
        axes[0].set_ylabel("Kp (N·m/rad)")
        axes[1].set_ylabel("Kd (N·m·s/rad)")
        axes[1].set_xlabel("amplitude of the relative displacement (rad)")
        axes[0].legend(loc="best")

    return Figure(
        "joint_schedule", lambda: svg(heading, draw, rows=2, height=3.6, share=True),
        "Counterpart of Fig. 14.", f"Two graphs over amplitude. {heading}.",
    )  # fmt: skip


def variable_figure(found: Contest, back: float) -> tuple[Figure, dict[str, float]]:
    """The relative displacement as the encoders read it, over a step, in counts of the motor's encoder."""
    task = found.task
    count = task.loop.resolution
    seen = {}
    for load, said in zip(task.load_inertias, ("no load", "loaded"), strict=True):
        scenarios = task.scenarios(load_inertias=(load,), frictions=(1.0,), inertias=(1.0,), phases=1)
        seen[said] = task.run(found[JOINT].factory(1), scenarios, ("motor.y", "load.y", "q", "load.q")).trajectories
    gear = task.plant["kinematic_error"].parameters["sine"].value / count
    wound = {said: float(np.max(np.abs(t["q"][:, 0] - t["load.q"][:, 0]))) / count for said, t in seen.items()}
    heading = (
        f"The scheduling variable stays within {max(wound.values()):.0f} counts of the motor's encoder; the gear's error alone "
        f"is {gear:.0f}"
    )

    def draw(axes):
        for axis, (said, t) in zip(axes, seen.items(), strict=True):
            axis.plot(t.time, (t["motor.y"][:, 0] - t["load.y"][:, 0]) / count, lw=0.6, color=AFTER, label="as read")
            axis.axhspan(-back / count, back / count, color=MUTED, alpha=0.2, lw=0)
            axis.axhline(gear, color=BEFORE, lw=0.8, ls=":")
            axis.axhline(-gear, color=BEFORE, lw=0.8, ls=":")
            axis.set_ylabel(f"{said} (counts)")
        axes[1].set_xlabel("time (s)")

    figure = Figure(
        "scheduling_variable", lambda: svg(heading, draw, rows=2, height=3.8, share=True),
        "Motor less load as the encoders read them, over a step. Grey: what must come back to count as a reversal. Dotted: the "
        "gear's error.",
        f"Relative displacement over time, without and with load. {heading}.",
    )  # fmt: skip
    figures = {"gear_error_counts": gear, "largest_displacement_counts": wound["no load"]}
    return figure, figures | {"largest_displacement_counts_loaded": wound["loaded"]}
