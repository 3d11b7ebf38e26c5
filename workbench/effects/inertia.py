"""Inertia of a rigid body."""

from workbench.definition import FORCE, Effect, effect
from workbench.parameter import Parameter


@effect
def inertia() -> Effect:
    """T = J a. A declared inertia that is wrong is corrected by setting it free, not by a second one."""

    def step(s, z, p):
        return {}, p.inertia * s.a

    return Effect(
        name="inertia",
        cause="inertia of the moving parts; a declared value that is wrong leaves a residual in proportion to acceleration",
        formula="T = J a",
        source="Newton's second law",
        port=FORCE,
        family="inertia",
        parameters={"inertia": Parameter(0.0, "F*s^2/x", "moment of inertia or mass", lower=0.0)},
        linear=("inertia",),
        reads=("a",),
        step=step,
        holds=("odd",),
    )
