"""LuGre friction: bristles that deflect, slip, and are fewer at speed."""

from workbench.definition import FORCE, TWO_COUNTS, Effect, effect
from workbench.effects.elementary import absolute, exp, sign0, square
from workbench.parameter import Parameter


@effect
def lugre_friction() -> Effect:
    """T = s0 z + s1 dz/dt, dz/dt = v - |v| z/g(v), g(v) = x0 (1 + ratio exp(-(v/vs)^2)); s2 v is viscous_friction.

    The step is exact for a steady g over |dq|: z <- g sgn(dq) + (z - g sgn(dq)) exp(-|dq|/g), whatever its size; dz/dt is
    the mean over the step. x0 = Fc/s0, ratio = Fs/Fc - 1. No Masing rule: it forgets reversals (no non-local memory), and
    creeps under dither. With ratio > 0 and a constant s1 it is not passive at every speed (Barahona and Canudas de Wit).
    """

    def step(s, z, p):
        g = p.x0 * (1.0 + p.ratio * exp(-square(s.v / p.speed)))
        slid = sign0(s.dq) * g
        after = slid + (z.z - slid) * exp(-absolute(s.dq) / g)
        return {"z": after}, p.sigma0 * after + p.sigma1 * ((after - z.z) / s.dt), {"dir": after / g}

    return Effect(
        name="lugre_friction",
        cause="contact bristles that bend before they slip, and carry less once a film of lubricant builds up",
        formula="T = s0 z + s1 dz/dt, dz/dt = v - |v| z/g(v), g = x0 (1 + r exp(-(v/vs)^2))",
        source="Canudas de Wit, Olsson, Astrom, Lischinsky 1995",
        port=FORCE,
        family="friction with memory",
        reduces={"ratio": (0.0, "fading_memory"), "x0": (TWO_COUNTS, "stribeck_friction")},
        parts=("presliding_hysteresis", "stribeck_friction"),
        parameters={
            "sigma0": Parameter(0.0, "F/x", "stiffness of the bristles", lower=0.0),
            "sigma1": Parameter(0.0, "F*s/x", "damping of the bristles", lower=0.0),
            "x0": Parameter(1e-3, "x", "deflection when sliding: Coulomb friction over stiffness", lower=1e-12, scale="stroke"),
            "ratio": Parameter(0.5, "1", "static over Coulomb friction, less one", lower=0.0, upper=10.0, scale="number"),
            "speed": Parameter(0.1, "x/s", "Stribeck velocity", lower=1e-9, scale="speed"),
        },
        linear=("sigma0", "sigma1"),
        states={"z": 1},
        reads=("dq", "v", "dt"),
        provides=("dir",),
        step=step,
        holds=("odd",),
    )  # fmt: skip
