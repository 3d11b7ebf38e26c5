"""The chapter on the checks of a schedule."""

import numpy as np

from workbench.report import numbers
from workbench.report.contents import Chapter, Figure, Items, Paragraph, Table
from workbench.report.drawing import AFTER, BEFORE, MUTED, decades, svg
from workbench.verification.checks import Checks


def _margins_figure(checks: Checks, limit: float, unit: str, name: str) -> Figure:
    """Margins by python-control at every knot, and the sensitivity between knots."""
    least = 20 * np.log10(np.min(checks.gain_margin))
    phase = np.degrees(np.min(checks.phase_margin))
    heading = f"Every knot has a gain margin of {least:.1f} dB and a phase margin of {phase:.0f}° or more"

    def draw(axes):
        knots = checks.schedule.knots
        axes[0].semilogx(knots, 20 * np.log10(checks.gain_margin), ".-", ms=3, color=AFTER)
        axes[0].set_ylabel("gain margin (dB)")
        axes[1].semilogx(knots, np.degrees(checks.phase_margin), ".-", ms=3, color=AFTER)
        axes[1].set_ylabel("phase margin (°)")
        axes[2].semilogx(checks.between.amplitude, checks.between.sensitivity_peak, "-", color=AFTER)
        axes[2].axhline(limit, color=MUTED, lw=0.8, ls=":")
        axes[2].set_ylabel("Ms")
        axes[2].set_xlabel(numbers.label("amplitude A", unit))
        for axis in axes:
            decades(axis.xaxis)

    return Figure(
        f"margins_{name}",
        lambda: svg(heading, draw, rows=3, height=4.6, share=True),
        "Gain and phase margin by python-control at the knots, and the sensitivity peak at three amplitudes a segment, on the "
        "equivalent axis of each amplitude with sampling, delay and velocity filter. Dotted: the limit.",
        f"Three graphs over amplitude. {heading}.",
    )


def _passivity_figure(checks: Checks, unit: str, per: str, name: str) -> Figure:
    """What moving gains feed in beside what takes energy out."""
    p = checks.moving
    share = p.pumping / p.damping
    i = int(np.argmax(share))
    heading = f"Moving gains use up at most {numbers.percent(float(share[i]))} of the damping, at {numbers.scaled(float(p.amplitude[i]), unit)}"

    def draw(axes):
        axes[0].loglog(p.amplitude, p.damping, "-", color=AFTER, label="friction, Kd: taken out")
        seen = p.pumping > 1e-6 * p.damping.max()
        axes[0].loglog(p.amplitude[seen], p.pumping[seen], "--", color=BEFORE, label="moving Kp: fed in")
        axes[0].set_ylabel(numbers.label("quadrature", per))
        axes[0].set_xlabel(numbers.label("amplitude A", unit))
        decades(axes[0].xaxis)
        decades(axes[0].yaxis)
        axes[0].legend(loc="best")

    return Figure(
        f"passivity_{name}",
        lambda: svg(heading, draw, height=2.6),
        "Loss of friction and derivative action against the quadrature part of a proportional gain that moves with the stroke.",
        f"Two curves over amplitude. {heading}.",
    )


def checks_chapter(checks: Checks, limit: float, plant, rule: str) -> Chapter:
    """Margins, what lies between the knots, passivity, and how short a schedule may be. rule: under which it was tuned."""
    x = plant.displacement
    per = numbers.unit(f"{plant.effort}/{x}")
    worst, at = checks.between.worst_sensitivity
    text = (
        f"Checked is the schedule with which the simulated loop ended under the rule “{rule}”, {checks.schedule.knots.size} knots. Between its knots the "
        f"sensitivity is at most {numbers.number(worst)} (at {numbers.scaled(at, x)}), and the largest eigenvalue has a modulus of "
        f"{checks.between.worst_radius[0]:.4f}. Frozen gains feed in no energy; gains that follow the stroke do, and the "
        "second figure says how much of the damping that takes."
    )
    rows = tuple(
        (
            numbers.percent(n.tolerance),
            str(n.knots) if n.knots else "none suffice",
            numbers.percent(n.error) if n.knots else "–",
        )
        for n in checks.lengths
    )
    table = Table(
        ("asked for", "fewest knots", "left"),
        rows,
        "Knots that a schedule of the gains tuned at each amplitude needs.",
        "rrr",
    )
    said = tuple(f.sentence for f in (*checks.between.findings, *checks.moving.findings))
    figures = (
        _margins_figure(checks, limit, numbers.unit(x), rule),
        _passivity_figure(checks, numbers.unit(x), per, rule),
    )
    return Chapter(f"Checks of the schedule, rule “{rule}”", (Paragraph(text), *figures, Items(said), table))
