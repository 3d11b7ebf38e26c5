"""Chapters on the controller: gains over amplitude, the step, who beats whom, and what the found effect is worth."""

import numpy as np

from workbench.design.design import Designed
from workbench.finding import capital
from workbench.plant import ONE_MASS
from workbench.report import numbers
from workbench.report.contents import BAD, GOOD, Callout, Chapter, Figure, Items, Marked, Paragraph, Table
from workbench.report.drawing import AFTER, BEFORE, MUTED, SERIES, STYLES, decades, envelope, svg
from workbench.report.gains import course, step_heading
from workbench.task.task import PHASES, Task
from workbench.verification.compare import LEVEL, Comparison, Row, side

DRAWN = 3  # decades below the step that the error is drawn over, at least


def schedule_chapter(designed: Designed, rule: str) -> Chapter:
    """The gains tuned at each amplitude, and the schedule through them."""
    g, s, final = designed.polished.robust, designed.schedule, designed.final[rule]
    plant = designed.plant
    kp_unit, kd_unit = (numbers.unit(f"{plant.effort}{t}/{plant.displacement}") for t in ("", "*s"))
    heading = f"Kp {course(g.kp, kp_unit)} over amplitude; |S| stays below {np.max(g.sensitivity_peak):.2f}"

    def draw(axes):
        for axis, tuned, fitted, two, name, unit in (
            (axes[0], g.kp, s.kp, final.kp, "Kp", kp_unit),
            (axes[1], g.kd, s.kd, final.kd, "Kd", kd_unit),
        ):
            axis.loglog(g.amplitude, tuned, "o", ms=3, color=MUTED, label="tuned at each amplitude, robust")
            axis.loglog(s.knots, fitted, "--", color=BEFORE, label="interpolated between them")
            axis.loglog(final.knots, two, "-", color=AFTER, label="table, tuned for every move")
            axis.set_ylabel(numbers.label(name, unit))
        axes[2].semilogx(g.amplitude, g.sensitivity_peak, "-", color=AFTER)
        axes[2].set_ylabel("Ms")
        axes[2].set_xlabel(numbers.label("amplitude A", numbers.unit(plant.displacement)))
        for axis in axes:
            decades(axis.xaxis)
        for axis in axes[:2]:
            decades(axis.yaxis)
        axes[0].legend(loc="lower left")

    figure = Figure(
        "gains",
        lambda: svg(heading, draw, rows=3, height=5.4, share=True),
        "Gains over amplitude (top, middle) and the sensitivity peak of the exact sampled loop with the tuned gains.",
        f"Three graphs over amplitude. {heading}.",
    )
    findings = (*designed.gains.findings, *s.findings, *final.findings, *designed.between.findings, *designed.findings)
    said = [f.sentence for f in findings]
    blocks = [Paragraph(_of_schedule(designed, rule)), figure]
    return Chapter("Gains per amplitude, and the schedule", tuple(blocks + ([Items(tuple(said))] if said else [])))


def _of_schedule(designed: Designed, rule: str) -> str:
    """Say what one table holds, and what it leaves between its knots."""
    g, final = designed.polished.robust, designed.final[rule]
    peak, at = designed.between.worst_sensitivity
    return (
        f"One table holds the gains of every amplitude, and between its knots the sensitivity peak is at most {numbers.number(peak)} (at "
        f"{numbers.scaled(at, designed.plant.displacement)}). At each of {g.amplitude.size} amplitudes the gains are those that the simulated step has over friction and inertia. The "
        f"table has {final.knots.size} knots, even in the logarithm to base two; between them gains are linear in the amplitude. "
        "Its ratio Kp/Kd over amplitude begins at theirs and is tuned for every move of a ladder; Kp follows as stiff as |S| allows."
    )


def step_chapter(task: Task, controllers: dict, load: str = "") -> Chapter:
    """The same step under every controller: position, what is left of it, and torque. load: "loaded" where there is one."""
    plant, step = task.plant, task.step
    unit, effort = numbers.unit(plant.displacement), numbers.unit(plant.effort)
    bound = task.bound(task.load_inertias[0])
    position = "q" if plant.kind == ONE_MASS else "load.q"
    scenarios = task.scenarios(load_inertias=task.load_inertias[:1], frictions=(1.0,), inertias=(1.0,), phases=1)
    ran = {name: task.run(make(1), scenarios, (position, "u"), every=1) for name, make in controllers.items()}
    traces = {name: m.trajectories for name, m in ran.items()}
    target = float(np.ravel(scenarios.target)[0])
    heading = step_heading(
        bound, [float(m.time_1pct[0]) for m in ran.values()], [float(m.final_error[0]) for m in ran.values()],
        plant.displacement,
    )  # fmt: skip

    def draw(axes):
        for k, (name, t) in enumerate(traces.items()):
            style = {"color": SERIES[k % len(SERIES)], "ls": STYLES[k % len(STYLES)], "lw": 1.1}
            q, u = t[position][:, 0], t["u"][:, 0]
            axes[0].plot(*envelope(t.time, q), label=name, **style)
            left = np.maximum(np.abs(target - q), 0.05 * task.loop.count)
            axes[1].semilogy(*envelope(t.time, left), **style)
            axes[2].plot(*envelope(t.time, u), **style)
        axes[0].axvline(bound, color=MUTED, lw=0.8, ls=":")
        axes[1].axvline(bound, color=MUTED, lw=0.8, ls=":")
        axes[1].axhline(task.loop.count, color=MUTED, lw=0.8)
        axes[1].text(0, task.loop.count * 1.15, "\u2002one encoder count", color=MUTED, va="bottom")
        axes[0].set_ylabel(numbers.label("position", unit))
        axes[1].set_ylabel(numbers.label("error, absolute", unit))
        axes[2].set_ylabel(numbers.label("command", effort))
        axes[2].set_xlabel("time (s)")
        decades(axes[1].yaxis)
        axes[0].legend(loc="lower right")

    figure = Figure(
        f"step_{load}" if load else "step",
        lambda: svg(heading, draw, rows=3, height=5.8, share=True),
        f"A step of {numbers.quantity(step, plant.displacement)} {'with the load' if load else 'without load'}. Dotted: the time-optimal bound.",
        f"Three graphs over time for {len(traces)} controllers. {heading}.",
    )
    return Chapter("The step, loaded" if load else "The step", (Paragraph(_of_step(ran, load)), figure))


def _of_step(ran: dict, load: str) -> str:
    """Say who is first and who ends nearest. ran: name -> metrics of a step. load: "loaded" where there is one."""
    first = min(ran, key=lambda n: float(ran[n].time_1pct[0]))
    least = min(ran, key=lambda n: float(ran[n].final_error[0]))
    return (
        f"{capital(first)} is first within 1 % of the target, and {'it' if first == least else least} ends nearest to it. "
        + (
            "With the load on the axis all else is as before."
            if load
            else (
                "The simulated loop has all that the drive has: sampling, a quantised encoder, delay, the velocity filter, torque and "
                "speed limits, torque noise, and the identified friction. Controllers that are tuned were tuned by the same search on the same "
                "scenarios, with the same limits, also on its sensitivity."
            )
        )
    )


def _time(seconds: float) -> str:
    return numbers.scaled(seconds, "s", 4) if np.isfinite(seconds) else "never"


def _comparison_table(comparison: Comparison, caption: str, unit: str, effort: str) -> Table:
    """Every controller under every load. unit, effort: of position and of the drive, as printed."""
    rows = []
    for r in comparison.rows:
        load = "none" if r.load_inertia == 0 else numbers.number(r.load_inertia, 2)
        rows.append(
            (
                r.controller,
                load,
                _time(r.time_1pct),
                numbers.number(r.over_bound) if np.isfinite(r.time_1pct) else "–",
                numbers.percent(r.overshoot),
                numbers.number(r.final_error, 2),
                numbers.number(r.error_counts, 2),
                _time(r.settling),
                numbers.number(r.peak_torque),
            )
        )
    columns = (
        "controller", "load inertia", "1 % time", "of the bound", "overshoot", f"final error ({unit})", "in counts",
        "settled", f"peak command ({effort})",
    )  # fmt: skip
    return Table(columns, tuple(rows), caption, "lrrrrrrrr")


def comparison_chapter(comparison: Comparison, task: Task, beside: tuple[str, ...] = ()) -> Chapter:
    """Who is beaten on what, and who is not. beside: further sentences."""
    c = task.criteria
    caption = (
        f"The worst of {PHASES} encoder phases and noise seeds each. The bound comes to rest on the target; a controller that "
        "overshoots within the band may be below it. Settled: within "
        f"±{c.counts:g} counts for {numbers.scaled(c.hold, 's')}. Load inertia in {numbers.unit('kg*m^2' if task.plant.rotary else 'kg')}."
    )
    beaten = (*(f.sentence for f in comparison.findings), *beside)
    x, effort = task.plant.displacement, task.plant.effort
    return Chapter(
        "Against the baselines",
        (Items(beaten), _comparison_table(comparison, caption, numbers.unit(x), numbers.unit(effort))),
    )


def _changed(now: Row, before: Row) -> Marked | str:
    """Say on which side of another row one is, in time and error together."""
    time = side(now.time_1pct, before.time_1pct, LEVEL["time"])
    sides = {time, side(now.final_error, before.final_error, LEVEL["error"])}
    if sides == {1, -1}:
        return "mixed"
    return Marked("better", GOOD) if 1 in sides else Marked("worse", BAD) if -1 in sides else "equal"


def worth_chapter(declared: Comparison, extended: Comparison, cause: str, task: Task) -> Chapter:
    """The same controllers tuned on the declared and on the extended model, all run on the extended plant."""
    rows = []
    for r in extended.rows:
        other = declared.row(r.controller, r.load_inertia)
        rows.append(
            (
                r.controller,
                "none" if r.load_inertia == 0 else numbers.number(r.load_inertia, 2),
                _time(other.time_1pct),
                _time(r.time_1pct),
                numbers.number(other.final_error, 2),
                numbers.number(r.final_error, 2),
                _changed(r, other),
            )
        )
    unit = numbers.unit(task.plant.displacement)
    columns = (
        "controller", "load inertia", "1 % time, declared", "1 % time, extended", f"error ({unit}), declared",
        f"error ({unit}), extended", "extended is",
    )  # fmt: skip
    return Chapter(
        "What the found effect is worth",
        (
            Callout(_worth_sentence(declared, extended, cause, task.plant.displacement)),
            Table(
                columns,
                tuple(rows),
                "Tuned on the declared and on the extended model, run on the extended plant.",
                "lrrrrrl",
            ),
        ),
    )


def _worth_sentence(declared: Comparison, extended: Comparison, cause: str, x: str) -> str:
    """Say what the scheduled PD gains by knowing the effect. x: SI unit of position."""
    a, b = declared.rows[0], extended.rows[0]
    time = f"{_time(a.time_1pct)} to {_time(b.time_1pct)}"
    return (
        f"Tuned with {cause} in the model instead of without it, {b.controller} goes from a 1 % time of {time} and a final "
        f"error of {numbers.scaled(a.final_error, x, 2)} to {numbers.scaled(b.final_error, x, 2)} without load, on the plant that has it."
    )
