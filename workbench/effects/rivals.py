"""Hysteresis of a flexspline without memory, as the harmonic-drive literature has it: for comparison, not for a trace."""

from workbench.definition import FORCE, TWO_COUNTS, Effect, effect
from workbench.effects.elementary import absolute, power, tanh
from workbench.parameter import Parameter


@effect
def hyperbolic_friction() -> Effect:
    """T = (Fc + Fw tanh(|x|/xw)) dir: Coulomb friction, and friction weighted by a hyperbolic function of the deflection.

    Loss grows with deflection, but there is no memory of reversals, and the force jumps where the direction turns.
    """

    def step(s, z, p):
        return {}, (p.coulomb + p.weighted * tanh(absolute(s.q) / p.width)) * s.dir

    return Effect(
        name="hyperbolic_friction",
        cause="hysteresis of a flexspline taken as friction that grows with its deflection",
        formula="T = (Fc + Fw tanh(|x|/xw)) dir",
        source="after Seyfferth, Maghzal, Angeles 1995",
        port=FORCE,
        family="friction over position",
        reduces={"weighted": (0.0, "coulomb_friction"), "width": (TWO_COUNTS, "coulomb_friction")},
        parameters={
            "coulomb": Parameter(0.0, "F", "Coulomb friction", lower=0.0),
            "weighted": Parameter(0.0, "F", "friction that grows with deflection", lower=0.0),
            "width": Parameter(1e-3, "x", "deflection over which it grows", lower=1e-12, scale="stroke"),
        },
        linear=("coulomb", "weighted"),
        reads=("q", "dir"),
        step=step,
        holds=("passive", "odd"),
        places=("joint",),
        at="joint",
        traced=False,
    )


@effect
def structural_damping() -> Effect:
    """T = h |x|^n dir: loss per cycle grows with amplitude and not with frequency; n = 1 is the textbook's."""

    def step(s, z, p):
        return {}, p.coefficient * power(absolute(s.q), p.exponent) * s.dir

    return Effect(
        name="structural_damping",
        cause="internal friction of the flexspline's material, in proportion to its deflection",
        formula="T = h |x|^n dir",
        source="after Taghirad and Belanger 1998",
        port=FORCE,
        family="friction over position",
        parameters={
            "coefficient": Parameter(0.0, "F/x^exponent", "coefficient", lower=0.0),
            "exponent": Parameter(1.0, "1", "exponent", lower=0.1, upper=3.0, fixed=True, scale="number"),
        },
        linear=("coefficient",),
        reads=("q", "dir"),
        step=step,
        holds=("passive", "odd"),
        places=("joint",),
        at="joint",
        traced=False,
    )
