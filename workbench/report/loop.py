"""The chapter on the loop over frequency: plant, open loop and sensitivity at some amplitudes, as python-control has them."""

import numpy as np

from workbench.description import Equivalent
from workbench.description.friction import friction_of
from workbench.design.polish import Polished
from workbench.plant import Plant
from workbench.report import numbers
from workbench.report.contents import Chapter, Figure, Paragraph, Table
from workbench.report.drawing import AFTER, BEFORE, MEASURED, MUTED, decades, svg
from workbench.simulation import Loop
from workbench.tuning import TuningGoal
from workbench.tuning.axis import Axis
from workbench.tuning.systems import law_system, plant_system

LINES = 400  # frequencies, from a ten-thousandth of the sampling rate to half of it


def loop_chapter(polished: Polished, plant: Plant, equivalent: Equivalent, goal: TuningGoal, loop: Loop) -> Chapter:
    """Show the loop of the robust gains on the equivalents (n,) at the first, the middle and the last amplitude."""
    import control

    gains, (_, inertia, viscous) = polished.robust, friction_of(plant)
    axis = Axis.of(equivalent, inertia, viscous, loop)
    rows = (0, gains.amplitude.size // 2, gains.amplitude.size - 1)
    omega = 2.0 * np.pi / loop.sample_time * np.geomspace(1e-4, 0.5, LINES)[:-1]
    shown, cells, crossings = [], [], []
    for i in rows:
        kp, kd = float(gains.kp[i]), float(gains.kd[i])
        p = plant_system(axis, i, kp)
        whole = p * law_system(kp, kd, axis.clock)
        gain, phase, _, _, crossing, _ = control.stability_margins(whole)
        values = np.ravel(whole(np.exp(1j * omega * loop.sample_time)))
        crossings.append(crossing / (2.0 * np.pi))
        a = numbers.scaled(float(gains.amplitude[i]), plant.displacement)
        peak = float(np.max(1.0 / np.abs(1.0 + values)))
        cells.append((a, _said(crossings[-1], "Hz"), _said(20.0 * np.log10(gain), "dB"), _said(phase, "°"), numbers.number(peak)))  # fmt: skip
        shown.append((a, values, np.ravel(p(np.exp(1j * omega * loop.sample_time)))))
    columns = ("amplitude", "crossover", "gain margin", "phase margin", "Ms")
    table = Table(columns, tuple(cells), "Margins by python-control, of the exact sampled loop.", "rrrrr")
    text = (
        "Plant and loop at three amplitudes, with the gains that are tuned there on simulated steps: the axis on its equivalent spring, "
        "behind the zero-order hold, the delay and the velocity filter, as objects of python-control."
    )
    heading = f"From {shown[0][0]} to {shown[-1][0]} the loop crosses over at {_said(crossings[0], 'Hz')} to {_said(crossings[-1], 'Hz')}"
    return Chapter(
        "The loop over frequency", (Paragraph(text), _figure(heading, shown, omega, plant, goal.sensitivity), table)
    )


def _said(value: float, unit: str) -> str:
    return f"{numbers.number(value)} {unit}" if np.isfinite(value) else "–"


def _figure(heading: str, shown: list, omega: np.ndarray, plant: Plant, sensitivity: float) -> Figure:
    """Draw plant, open loop and sensitivity over frequency."""
    colours = (BEFORE, MEASURED, AFTER)

    def draw(axes):
        hertz = omega / (2.0 * np.pi)
        for (a, whole, own), colour in zip(shown, colours, strict=True):
            axes[0].loglog(hertz, np.abs(own), color=colour, label=a)
            axes[1].loglog(hertz, np.abs(whole), color=colour)
            axes[2].semilogx(hertz, 1.0 / np.abs(1.0 + whole), color=colour)
        axes[1].axhline(1.0, color=MUTED, lw=0.8)
        axes[2].axhline(sensitivity, color=MUTED, lw=0.8, ls=":")
        axes[0].set_ylabel(numbers.label("|P|", numbers.unit(f"{plant.displacement}/({plant.effort})")))
        axes[1].set_ylabel("|P C|")
        axes[2].set_ylabel("|S|")
        axes[2].set_xlabel("frequency (Hz)")
        axes[0].legend(loc="best")
        for axis in axes[:2]:
            decades(axis.yaxis)

    return Figure(
        "loop",
        lambda: svg(heading, draw, rows=3, height=4.8, share=True),
        "Plant, open loop and sensitivity. Dotted: the limit.",
        f"Three graphs over frequency. {heading}.",
    )
