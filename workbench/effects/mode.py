"""A part that swings on the axis: added mass on a spring and a damper."""

from math import pi

from workbench.definition import FORCE, Effect, effect
from workbench.effects._arithmetic import sqrt
from workbench.effects.elementary import cos, exp, sin
from workbench.parameter import Parameter


@effect
def flexible_mode() -> Effect:
    """T = -m (w^2 y + 2 zeta w dy/dt), d2y/dt2 + 2 zeta w dy/dt + w^2 y = -a; y is where the part is, seen from the axis.

    m comes on top of the declared inertia: far below the mode T is m a. Exact step for an acceleration that is linear
    between samples; y begins at rest.
    """

    def step(s, z, p):
        w, h, zeta = 2.0 * pi * p.frequency, s.dt, p.damping
        damped = w * sqrt(1.0 - zeta * zeta)
        slope = (s.a - z.a) / h
        # the motion that follows the ramp of acceleration, -(alpha + beta t), and the swing about it
        beta = slope / (w * w)
        alpha = z.a / (w * w) - 2.0 * zeta * slope / (w * w * w)
        y, v = z.y + alpha, z.v + beta
        decay, c, d = exp(-zeta * w * h), cos(damped * h), sin(damped * h) / damped
        y_after = decay * (c * y + d * (v + zeta * w * y)) - (alpha + beta * h)
        v_after = decay * (c * v - d * (w * w * y + zeta * w * v)) - beta
        return {"y": y_after, "v": v_after, "a": s.a}, -p.mass * (w * w * y_after + 2.0 * zeta * w * v_after)

    return Effect(
        name="flexible_mode",
        cause="a part of the moving mass that is not rigid: it swings against the axis at its own frequency",
        formula="T = -m (w^2 y + 2 zeta w dy/dt), d2y/dt2 + 2 zeta w dy/dt + w^2 y = -a",
        source="Den Hartog, Mechanical Vibrations, 1956",
        port=FORCE,
        family="mode",
        parameters={
            "mass": Parameter(0.0, "F*s^2/x", "inertia or mass of the part that swings", lower=0.0),
            "frequency": Parameter(50.0, "Hz", "its frequency with the axis held", lower=1e-3, scale="resonance"),
            "damping": Parameter(0.1, "1", "its damping ratio", lower=1e-4, upper=0.95, scale="number"),
        },
        linear=("mass",),
        states={"y": 1, "v": 1, "a": 1},
        reads=("a", "dt"),
        step=step,
        holds=("odd",),
    )
