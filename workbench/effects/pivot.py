"""Preload and two slopes: the bearing pivot of disk drives before hysteresis operators; for comparison, not for a trace."""

from workbench.definition import FORCE, Effect, effect
from workbench.effects.elementary import clip
from workbench.parameter import Parameter

EVERYWHERE = ("axis", "motor", "load", "joint")


@effect
def preload_friction() -> Effect:
    """T = b v + Fs dir: the preload model, viscous and Coulomb friction in one."""

    def step(s, z, p):
        return {}, p.viscous * s.v + p.preload * s.dir

    return Effect(
        name="preload_friction",
        cause="a preloaded pivot bearing: dry friction with a viscous part",
        formula="T = b v + Fs dir",
        source="Abramovitch, Wang, Franklin 1994 (disk drive pivot nonlinearity)",
        port=FORCE,
        family="friction over speed",
        reduces={"viscous": (0.0, "coulomb_friction"), "preload": (0.0, "viscous_friction")},
        parameters={
            "viscous": Parameter(0.0, "F*s/x", "viscous coefficient", lower=0.0),
            "preload": Parameter(0.0, "F", "preload friction", lower=0.0),
        },
        linear=("viscous", "preload"),
        reads=("v", "dir"),
        step=step,
        holds=("passive", "odd"),
        places=EVERYWHERE,
        traced=False,
    )


@effect
def two_slope_stiffness() -> Effect:
    """T = ka q for |q| < xs, kb q + (ka - kb) xs sgn(q) beyond (odd: the second line takes the sign of q)."""

    def step(s, z, p):
        near = clip(s.q, -p.knee, p.knee)
        return {}, p.inner * near + p.outer * (s.q - near)

    return Effect(
        name="two_slope_stiffness",
        cause="balls of a pivot bearing that are held about the rest position and roll further out",
        formula="T = ka clip(q, -xs, xs) + kb (q - clip(q, -xs, xs))",
        source="Abramovitch, Wang, Franklin 1994 (disk drive pivot nonlinearity)",
        port=FORCE,
        family="force over position",
        parameters={
            "inner": Parameter(0.0, "F/x", "stiffness inside the knee", lower=0.0),
            "outer": Parameter(0.0, "F/x", "stiffness outside the knee", lower=0.0),
            "knee": Parameter(1e-3, "x", "displacement of the knee", lower=1e-12, scale="stroke"),
        },
        linear=("inner", "outer"),
        reads=("q",),
        step=step,
        holds=("conservative", "odd"),
        places=EVERYWHERE,
        traced=False,
    )
