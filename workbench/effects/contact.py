"""The length over which friction builds up, as an effect of its own beside Coulomb friction."""

import casadi as ca

from workbench.definition import FORCE, TWO_COUNTS, Effect, effect
from workbench.effects.elementary import clip
from workbench.parameter import Parameter


@effect
def presliding_length() -> Effect:
    """dir = x/r, x <- clip(x + dq, -r, r): friction that reads `dir` builds up in proportion to the displacement.

    It has no force of its own: Coulomb friction beside it becomes one spring of stiffness Fc/r that slips at Fc (one
    Maxwell-slip element), and asymmetry of Coulomb friction a spring that is stiffer under force of one sign.
    """

    def step(s, z, p):
        x = clip(z.x + s.dq, -p.length, p.length)
        return {"x": x}, ca.SX(0), {"dir": x / p.length}

    return Effect(
        name="presliding_length",
        cause="one contact, or what holds it, that deflects as a spring before it slips: dry friction builds up over a length",
        formula="dir = x/r, x <- clip(x + dq, -r, r)",
        source="Prandtl 1928; stop operator, Krasnosel'skii and Pokrovskii 1989",
        port=FORCE,
        family="friction with memory",
        reduces={"length": (TWO_COUNTS, "")},
        parameters={"length": Parameter(1e-3, "x", "displacement at which it slips", lower=1e-12, scale="stroke")},
        states={"x": 1},
        reads=("dq",),
        provides=("dir",),
        step=step,
        places=("axis", "motor", "load", "joint"),
        traced=False,
    )
