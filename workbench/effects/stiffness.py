"""Stiffness of a joint, in its deflection."""

from workbench.effect import FORCE, Effect, effect
from workbench.parameter import Parameter


@effect
def linear_stiffness() -> Effect:
    """T = k x."""

    def step(s, z, p):
        return {}, p.stiffness * s.q

    return Effect(
        name="linear_stiffness",
        cause="elastic wind-up of the flexspline, coupling or belt",
        formula="T = k x",
        source="Hooke's law",
        port=FORCE,
        parameters={"stiffness": Parameter(0.0, "F/x", "stiffness", lower=0.0)},
        linear=("stiffness",),
        reads=("q",),
        step=step,
        holds=("conservative", "odd"),
        places=("joint",),
        at="joint",
    )


@effect
def cubic_stiffness() -> Effect:
    """T = k3 x^3, k3 >= 0: hardening."""

    def step(s, z, p):
        return {}, p.k3 * (s.q * s.q * s.q)

    return Effect(
        name="cubic_stiffness",
        cause="more teeth in mesh as torque grows: the joint hardens",
        formula="T = k3 x^3",
        source="Tuttle and Seering 1996",
        port=FORCE,
        parameters={"k3": Parameter(0.0, "F/x^3", "cubic stiffness", lower=0.0)},
        linear=("k3",),
        reads=("q",),
        step=step,
        holds=("conservative", "odd"),
        places=("joint",),
        at="joint",
    )
