"""Friction of a lubricant film that is sheared until it yields."""

from workbench.definition import FORCE, Effect, effect
from workbench.effects.elementary import tanh
from workbench.parameter import Parameter


@effect
def film_friction() -> Effect:
    """T = TL tanh(v/vL): viscous with TL/vL at low speed, level at TL where the film carries no more shear stress.

    Beside Coulomb friction it is what that has less at low speed: the opposite of Stribeck's drop. Traction contacts (balls
    and rollers under load) have it, with TL in proportion to the pressure.
    """

    def step(s, z, p):
        return {}, p.limit * tanh(s.v / p.speed)

    return Effect(
        name="film_friction",
        cause="a lubricant film under pressure that is sheared up to a limiting stress, so that friction rises with speed to a level",
        formula="T = TL tanh(v/vL)",
        source="Bair and Winer 1979; Gecim and Winer 1980 (limiting shear stress)",
        port=FORCE,
        family="friction over speed",
        parameters={
            "limit": Parameter(0.0, "F", "friction at the limiting shear stress", lower=0.0),
            "speed": Parameter(
                0.1, "x/s", "speed that the film's viscosity alone would need for it", lower=1e-9, scale="speed"
            ),
        },
        linear=("limit",),
        reads=("v",),
        step=step,
        holds=("passive", "odd"),
        traced=False,
    )
