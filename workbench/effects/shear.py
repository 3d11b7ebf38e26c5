"""Friction that goes through zero with speed: a film that yields, asperities that turn over a speed, a lubricant that shears thinner."""

from workbench.definition import FORCE, Effect, effect
from workbench.effects.elementary import absolute, power, sign0, tanh
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
        nearest="nonlinear_viscous_friction",
    )


@effect
def regularised_coulomb_friction() -> Effect:
    """T = Tc v/(vr^n + |v|^n)^(1/n): Coulomb friction that turns over a speed, and comes to its level sooner the larger n is.

    n = 1 is v/(|v| + vr), n = 2 v/sqrt(v^2 + vr^2). An arctangent is one of n = 1.4 to 1 % of Tc, tanh one of n = 2.9, an
    error function one of n = 3.5 to 2 %. Far above vr it is Coulomb friction, far below it viscous with Tc/vr.
    """

    def step(s, z, p):
        x = s.v / p.speed
        return {}, p.coulomb * x * power(1.0 + power(absolute(x), p.sharpness), -1.0 / p.sharpness)

    return Effect(
        name="regularised_coulomb_friction",
        cause="dry and mixed friction of asperities that do not turn all at once: it goes through zero over a speed",
        formula="T = Tc v/(vr^n + |v|^n)^(1/n)",
        source="Andersson, Soderberg, Bjorklund 2007 (smooth laws of dry and mixed friction); Churchill, Usagi 1972 (two limits joined by n)",
        port=FORCE,
        family="friction over speed",
        parameters={
            "coulomb": Parameter(0.0, "F", "friction far above the speed of the turn", lower=0.0),
            "speed": Parameter(0.01, "x/s", "speed over which it turns", lower=1e-9, scale="speed"),
            "sharpness": Parameter(2.0, "1", "how soon it comes to its level", lower=0.7, upper=8.0, scale="exponent"),
        },
        linear=("coulomb",),
        reads=("v",),
        step=step,
        holds=("passive", "odd"),
        traced=False,
        nearest="nonlinear_viscous_friction",
    )


@effect
def power_law_friction() -> Effect:
    """T = T1 (|v|/v1)^n sgn(v): a lubricant whose viscosity falls (n < 1) or rises (n > 1) with the rate of shear.

    v1 is a reference and no number of the axis: T1 is the friction there.
    """

    def step(s, z, p):
        return {}, p.level * sign0(s.v) * power(absolute(s.v) / p.speed, p.exponent)

    return Effect(
        name="power_law_friction",
        cause="a lubricant that shears thinner or thicker, so that friction goes with a power of speed",
        formula="T = T1 (|v|/v1)^n sgn(v)",
        source="Ostwald 1925; de Waele 1923; Waiboer, Aarts, Jonker 2005 (joints of robots)",
        port=FORCE,
        family="friction over speed",
        parameters={
            "level": Parameter(0.0, "F", "friction at the reference speed", lower=0.0),
            "speed": Parameter(0.1, "x/s", "reference speed", lower=1e-9, fixed=True),
            "exponent": Parameter(0.5, "1", "exponent of speed", lower=0.1, upper=3.0, scale="exponent"),
        },
        linear=("level",),
        reads=("v",),
        step=step,
        holds=("passive", "odd"),
        traced=False,
        nearest="nonlinear_viscous_friction",
        reduces={"exponent": (1.0, "viscous_friction")},
        knots=("speed",),
    )
