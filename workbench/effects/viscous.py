"""Friction that depends on velocity alone."""

from workbench.definition import FORCE, Effect, effect
from workbench.effects.elementary import absolute, maximum, minimum
from workbench.parameter import Parameter


@effect
def viscous_friction() -> Effect:
    """T = b v."""

    def step(s, z, p):
        return {}, p.viscous * s.v

    return Effect(
        name="viscous_friction",
        cause="shear of lubricant and eddy currents, in proportion to speed",
        formula="T = b v",
        source="Armstrong-Helouvry, Dupont, Canudas de Wit 1994",
        port=FORCE,
        family="friction over speed",
        parameters={"viscous": Parameter(0.0, "F*s/x", "viscous coefficient", lower=0.0)},
        linear=("viscous",),
        reads=("v",),
        step=step,
        holds=("passive", "odd"),
    )


@effect
def nonlinear_viscous_friction() -> Effect:
    """T = b2 v |v|: the part of viscous friction that grows faster than speed."""

    def step(s, z, p):
        return {}, p.quadratic * s.v * absolute(s.v)

    return Effect(
        name="nonlinear_viscous_friction",
        cause="churning of lubricant and windage, growing with the square of speed",
        formula="T = b2 v |v|",
        source="Armstrong-Helouvry, Dupont, Canudas de Wit 1994",
        port=FORCE,
        family="friction over speed",
        reduces={"quadratic": (0.0, "")},
        # The sign is free: shear thinning bends the curve down, which is passive only beside a viscous term.
        parameters={"quadratic": Parameter(0.0, "F*s^2/x^2", "coefficient of v |v|")},
        linear=("quadratic",),
        reads=("v",),
        step=step,
        holds=("odd",),
    )


@effect
def linear_damping() -> Effect:
    """T = c v, v the rate of the joint's deflection."""

    def step(s, z, p):
        return {}, p.damping * s.v

    return Effect(
        name="linear_damping",
        cause="material damping of the joint",
        formula="T = c v",
        source="Kelvin-Voigt element",
        port=FORCE,
        family="friction over speed",
        parameters={"damping": Parameter(0.0, "F*s/x", "damping", lower=0.0)},
        linear=("damping",),
        reads=("v",),
        step=step,
        holds=("passive", "odd"),
        places=("axis", "motor", "load", "joint"),
        stated=("axis", "motor", "load"),  # viscous friction is traced there
        at="joint",
    )


@effect
def viscous_asymmetry() -> Effect:
    """T = db |v|: the viscous part of coulomb_asymmetry alone, where no difference of Coulomb friction is needed.

    Beside a constant offset a difference of Coulomb friction shows in no motion but within the reversals.
    """

    def step(s, z, p):
        return {}, p.viscous_difference * absolute(s.v)

    return Effect(
        name="viscous_asymmetry",
        cause="a lubricant film, seals or a preloaded nut that drag more in one direction than in the other",
        formula="T = db |v|",
        source="Janot, Gautier, Brunot 2019 (asymmetric friction)",
        port=FORCE,
        family="friction over speed",
        parameters={
            "viscous_difference": Parameter(
                0.0, "F*s/x", "half the difference of viscous friction, forward less backward"
            )
        },
        linear=("viscous_difference",),
        reads=("v",),
        step=step,
        holds=("even",),
        traced=False,
    )


@effect
def directional_viscous_friction() -> Effect:
    """T = b+ v forward, b- v backward. Another spelling of viscous friction with the viscous part of coulomb_asymmetry."""

    def step(s, z, p):
        return {}, p.forward * maximum(s.v, 0.0) + p.backward * minimum(s.v, 0.0)

    return Effect(
        name="directional_viscous_friction",
        cause="lubricant, seals or tooth flanks that drag more in one direction than in the other",
        formula="T = b+ max(v, 0) + b- min(v, 0)",
        source="Janot, Gautier, Brunot 2019 (asymmetric friction)",
        port=FORCE,
        family="friction over speed",
        parameters={
            "forward": Parameter(0.0, "F*s/x", "viscous coefficient forward", lower=0.0),
            "backward": Parameter(0.0, "F*s/x", "viscous coefficient backward", lower=0.0),
        },
        linear=("forward", "backward"),
        reads=("v",),
        step=step,
        holds=("passive",),
        traced=False,
    )
