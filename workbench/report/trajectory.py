"""The figure of a planned trajectory: position and drive over time, with what they must stay within."""

import numpy as np

from workbench.planning import Envelope
from workbench.report.drawing import AFTER, BEFORE, MUTED, envelope, svg


def figure(
    title: str, time: np.ndarray, position: np.ndarray, drive: np.ndarray, limits: Envelope, rotary: bool
) -> bytes:
    """Return the figure as SVG. time, position of the drive's encoder and drive (n,), SI."""
    x, f = ("rad", "N·m") if rotary else ("m", "N")

    def draw(axes) -> None:
        top, low = axes
        for axis, values, colour, bounds in (
            (top, position, AFTER, (limits.low, limits.high)),
            (low, drive, BEFORE, (-limits.drive, limits.drive)),
        ):
            axis.plot(*envelope(time, values), color=colour, lw=0.8)
            for bound in bounds:
                axis.axhline(bound, color=MUTED, lw=0.8, ls="--")
        top.set_ylabel(f"position, {x}")
        low.set_ylabel(f"drive, {f}")
        low.set_xlabel("time, s (dashed: limits)")
        low.set_xlim(time[0], time[-1])

    return svg(title, draw, rows=2, height=3.6, share=True)
