"""The figure of a frequency response: measured and fitted magnitude, and the coherence under it."""

import numpy as np

from workbench.frequency import Modes, Response
from workbench.report.drawing import AFTER, BEFORE, MEASURED, MUTED, decades, svg

FINER = 2000  # frequencies at which the fitted response is drawn


def figure(title: str, response: Response, modes: Modes, unit: str) -> bytes:
    """Return the figure as SVG. unit: of the gain, acceleration over drive."""

    def draw(axes) -> None:
        top, low = axes
        f = np.geomspace(response.frequency[0], response.frequency[-1], FINER)
        sure = response.coherence > 0.5
        top.loglog(
            response.frequency[sure], np.abs(response.value)[sure], ".", ms=2.5, color=MEASURED, label="measured"
        )
        top.loglog(f, np.abs(modes.at(f)), color=AFTER, label="fitted")
        for k, m in enumerate(modes.modes):
            top.axvline(m.frequency, color=BEFORE, lw=0.8, ls="--", label="mode" if k == 0 else None)
        top.set_ylabel(f"gain, {unit}")
        top.legend(loc="best")
        decades(top.yaxis)
        low.semilogx(response.frequency, response.coherence, ".", ms=2.5, color=MUTED)
        low.set_ylim(0.0, 1.05)
        low.set_ylabel("coherence")
        low.set_xlabel("frequency, Hz")
        for axis in axes:
            axis.set_xlim(response.frequency[0], response.frequency[-1])
            decades(axis.xaxis)

    return svg(title, draw, rows=2, height=4.0, share=True)
