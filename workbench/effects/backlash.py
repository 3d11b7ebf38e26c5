"""Lost motion in a joint."""

from workbench.definition import ANGLE, TWO_COUNTS, Effect, effect
from workbench.effects.elementary import clip
from workbench.parameter import Parameter


@effect
def backlash() -> Effect:
    """x_eff = x - clip(x, -b, b): inside the gap the joint sees no deflection."""

    def step(s, z, p):
        return {}, s.q - clip(s.q, -p.half_width, p.half_width)

    return Effect(
        name="backlash",
        cause="a gap between teeth, keys or couplings that has to be crossed at every reversal",
        formula="x_eff = x - clip(x, -b, b)",
        source="Nordin and Gutman 2002",
        port=ANGLE,
        family="joint stiffness",
        reduces={"half_width": (TWO_COUNTS, "")},
        parameters={"half_width": Parameter(1e-4, "x", "half of the gap", lower=1e-12, scale="stroke")},
        reads=("q",),
        step=step,
        holds=("odd",),
        places=("joint",),
        at="joint",
    )
