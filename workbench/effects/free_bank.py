"""Friction with memory of any virgin curve: Maxwell slip whose curve is a table, as identified and not as a formula."""

from collections.abc import Sequence

import casadi as ca
import numpy as np

from workbench.effect import FORCE, Effect
from workbench.effects.elementary import clip, minimum
from workbench.errors import WorkbenchError
from workbench.parameter import Parameter

NAME = "virgin_curve_friction"


def virgin_curve_friction(slips: Sequence[float], heights: Sequence[float]) -> Effect:
    """T = sum h_i x_i/D_i, x_i <- clip(x_i + dq, -D_i, D_i), h_i >= 0: Masing's rule and any concave virgin curve.

    slips (n,): D_i in SI, increasing. heights (n,): what each element holds when it slips, N*m or N. It is the free form of
    presliding_hysteresis, and gives the direction of motion as that does: sum w_i x_i/D_i with the held shares w_i = h_i/sum h.
    Raises WorkbenchError where slips do not increase from above 0, or no height is above 0.
    """
    slips, heights = np.asarray(slips, float), np.asarray(heights, float)
    if slips.size != heights.size or not (np.diff(slips, prepend=0.0) > 0.0).all():
        raise WorkbenchError("a virgin curve needs slips that increase from above 0, and one height for each of them.")
    if (heights < 0.0).any() or not heights.sum() > 0.0:
        raise WorkbenchError("the heights of a virgin curve must not be negative, and one must be above 0.")
    held, shares, limits = ([f"{x}{i}" for i in range(1, slips.size + 1)] for x in ("h", "w", "slip"))

    def vector(p, names):
        every = vars(p)
        return ca.vertcat(*(every[n] for n in names))

    def step(s, z, p):
        slip = vector(p, limits)
        x = clip(z.x + s.dq, -slip, slip)
        return {"x": x}, ca.dot(vector(p, held), x / slip), {"dir": ca.dot(vector(p, shares), x / slip)}

    def virgin(x, p):
        every = vars(p)
        return sum(every[h] * minimum(x / every[d], 1.0) for h, d in zip(held, limits, strict=True))

    table = {
        n: Parameter(float(h), "F", f"height of element {i}", lower=0.0)
        for i, (n, h) in enumerate(zip(held, heights, strict=True), 1)
    }
    for i, (w, d, share, slip) in enumerate(zip(shares, limits, heights / heights.sum(), slips, strict=True), 1):
        table[w] = Parameter(float(share), "1", f"share of element {i} in the direction", lower=0.0, fixed=True)
        table[d] = Parameter(
            float(slip), "x", f"slip deflection of element {i}", lower=1e-15, fixed=True, scale="stroke"
        )
    return Effect(
        name=NAME,
        cause="asperities that deflect before they slip, each at its own deflection: friction with memory of past reversals",
        formula="T = sum h_i x_i/D_i, x_i <- clip(x_i + dq, -D_i, D_i)",
        source="Iwan 1966; Al-Bender, Lampaert, Swevers 2005",
        port=FORCE,
        parameters=table,
        linear=tuple(held),
        states={"x": slips.size},
        reads=("dq",),
        provides=("dir",),
        virgin=virgin,
        step=step,
        holds=("passive", "rate independent", "odd", "masing"),
        places=("axis", "motor", "load", "joint"),
        traced=False,
    )
