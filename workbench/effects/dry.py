"""Dry friction: Coulomb, Stribeck, asymmetry. All read `dir`, the smooth direction, never sign(v)."""

from workbench.definition import FORCE, Effect, effect
from workbench.effects.elementary import absolute, exp, square
from workbench.parameter import Parameter


@effect
def coulomb_friction() -> Effect:
    """T = Fc dir, dir a stop operator of two encoder counts: beside friction with memory it is another contact."""

    def step(s, z, p):
        return {}, p.coulomb * s.dir

    return Effect(
        name="coulomb_friction",
        cause="dry friction between sliding surfaces, independent of speed",
        formula="T = Fc dir",
        source="Coulomb 1785; smooth direction after Al-Bender, Lampaert, Swevers 2005",
        port=FORCE,
        family="friction over speed",
        parameters={"coulomb": Parameter(0.0, "F", "Coulomb friction", lower=0.0)},
        linear=("coulomb",),
        reads=("dir",),
        step=step,
        holds=("passive", "odd"),
    )


@effect
def stribeck_friction() -> Effect:
    """T = dF exp(-(v/vs)^2) dir: what static friction has more than Coulomb friction, falling with speed."""

    def step(s, z, p):
        return {}, p.drop * exp(-square(s.v / p.speed)) * s.dir

    return Effect(
        name="stribeck_friction",
        cause="the lubricant film that builds up with speed: friction falls from static to Coulomb friction",
        formula="T = dF exp(-(v/vs)^2) dir",
        source="Stribeck 1902; Armstrong-Helouvry, Dupont, Canudas de Wit 1994",
        port=FORCE,
        family="friction over speed",
        reduces={"drop": (0.0, "")},
        parameters={
            "drop": Parameter(0.0, "F", "static less Coulomb friction", lower=0.0),
            "speed": Parameter(0.1, "x/s", "Stribeck velocity", lower=1e-9, scale="speed"),
        },
        linear=("drop",),
        reads=("v", "dir"),
        step=step,
        holds=("passive", "odd"),
    )


@effect
def coulomb_asymmetry() -> Effect:
    """T = dFc |dir| + db |v|: half the difference of friction between the two directions."""

    def step(s, z, p):
        return {}, p.coulomb_difference * absolute(s.dir) + p.viscous_difference * absolute(s.v)

    return Effect(
        name="coulomb_asymmetry",
        cause="preload, tooth flanks or seals that rub more in one direction than in the other",
        formula="T = dFc |dir| + db |v|",
        source="Janot, Gautier, Brunot 2019 (asymmetric friction)",
        port=FORCE,
        family="friction over speed",
        reduces={"coulomb_difference": (0.0, "viscous_asymmetry")},
        parameters={
            "coulomb_difference": Parameter(0.0, "F", "half the difference of Coulomb friction, forward less backward"),
            "viscous_difference": Parameter(0.0, "F*s/x", "half the difference of viscous friction"),
        },
        linear=("coulomb_difference", "viscous_difference"),
        reads=("dir", "v"),
        step=step,
        holds=("even",),
    )
