"""Friction that a gap has to be crossed to reach, on one mass."""

import casadi as ca

from workbench.definition import FORCE, TWO_COUNTS, Effect, effect, namespace
from workbench.effects.elementary import clip
from workbench.effects.hysteresis import bank, knots
from workbench.parameter import Parameter

ELEMENTS = 12  # error of the virgin curve h0/(2 N^2), 0.35 %: a gap is never known as well as a bearing


@effect
def friction_behind_gap(elements: int = ELEMENTS) -> Effect:
    """T = h0 sum k_i (w_i - clip(w_i, -b, b)), w_i <- clip(w_i + dq, -b - D_i, b + D_i): gap, spring and slider in series.

    The elements (k_i, D_i) are those of presliding_hysteresis. After a reversal friction falls to nothing along the virgin
    curve, stays nothing over the gap 2 b, and builds up again the other way; b = 0 is the hysteresis without a gap. No Masing
    rule, since the gap lies in the middle of a loop and not at its ends.
    """
    c = knots(elements)

    def derive(p):
        k, slip = bank(c, p.x0, p.d)
        return namespace(h0=p.h0, k=k, reach=p.half_width + slip, half_width=p.half_width)

    def step(s, z, p):
        w = clip(z.w + s.dq, -p.reach, p.reach)
        direction = ca.dot(p.k, w - clip(w, -p.half_width, p.half_width))
        return {"w": w}, p.h0 * direction, {"dir": direction}

    return Effect(
        name="friction_behind_gap",
        cause="a rubbing part that is driven through a gap: a pin in a slot, a loose key or a worn coupling before the friction",
        formula="T = h0 sum ki (wi - clip(wi, -b, b)), wi <- clip(wi + dq, -b - Di, b + Di)",
        source="Nordin and Gutman 2002 (gap in series); Jenkins 1962; Iwan 1966",
        port=FORCE,
        family="friction with memory",
        reduces={"half_width": (TWO_COUNTS, "presliding_hysteresis")},
        parts=("backlash", "presliding_hysteresis"),
        parameters={
            "h0": Parameter(0.0, "F", "height: friction when sliding", lower=0.0),
            "half_width": Parameter(1e-3, "x", "half of the gap", lower=1e-12, scale="stroke"),
            "x0": Parameter(1e-3, "x", "presliding length", lower=1e-12, scale="stroke"),
            "d": Parameter(1.0, "1", "exponent of the virgin curve", lower=0.3, upper=1.0, fixed=True, scale="number"),
        },
        linear=("h0",),
        states={"w": len(c)},
        reads=("dq",),
        provides=("dir",),
        derive=derive,
        step=step,
        holds=("passive", "rate independent", "odd"),
    )
