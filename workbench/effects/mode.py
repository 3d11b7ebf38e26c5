"""A part that swings on the axis: a mass on a spring and a damper, on top of the declared inertia or counted in it."""

from math import pi

from workbench.definition import FORCE, Effect, effect
from workbench.effects._arithmetic import sqrt
from workbench.effects.elementary import cos, exp, sin
from workbench.parameter import Parameter


def _swing(s, z, p) -> tuple[dict, object]:
    """Return the states after a step, and the acceleration of the part in space: w^2 y + 2 zeta w dy/dt, reversed.

    Exact for an acceleration of the axis that is linear between samples.
    """
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
    return {"y": y_after, "v": v_after, "a": s.a}, -(w * w * y_after + 2.0 * zeta * w * v_after)


@effect
def flexible_mode() -> Effect:
    """T = -m (w^2 y + 2 zeta w dy/dt), d2y/dt2 + 2 zeta w dy/dt + w^2 y = -a; y is where the part is, seen from the axis.

    m comes on top of the declared inertia: far below the mode T is m a. y begins at rest.
    """

    def step(s, z, p):
        after, acceleration = _swing(s, z, p)
        return after, p.mass * acceleration

    return _mode(
        name="flexible_mode",
        cause="a part of the moving mass that is not rigid: it swings against the axis at its own frequency",
        formula="T = -m (w^2 y + 2 zeta w dy/dt), d2y/dt2 + 2 zeta w dy/dt + w^2 y = -a",
        step=step,
    )


@effect
def flexible_part() -> Effect:
    """T = -m (w^2 y + 2 zeta w dy/dt + a), y as of `flexible_mode`: m is part of the declared inertia, far below the mode T is 0.

    A data sheet gives the mass of all that moves, whether all of it is rigid or not. Beside a free inertia it is a flexible mode, under
    whose name it is traced.
    """

    def step(s, z, p):
        after, acceleration = _swing(s, z, p)
        return after, p.mass * (acceleration - s.a)

    return _mode(
        name="flexible_part",
        cause="a part of the declared inertia that is not rigid: it swings against the axis at its own frequency",
        formula="T = -m (w^2 y + 2 zeta w dy/dt + a), d2y/dt2 + 2 zeta w dy/dt + w^2 y = -a",
        step=step,
        nearest="flexible_mode",
        counted_in="inertia",
    )


def _mode(**own) -> Effect:
    """Return the effect of a part that swings. own: name, cause, formula, step, and what else is its own."""
    return Effect(
        **own,
        source="Den Hartog, Mechanical Vibrations, 1956",
        port=FORCE,
        family="mode",
        parameters={
            "mass": Parameter(0.0, "F*s^2/x", "inertia or mass of the part that swings", lower=0.0),
            "frequency": Parameter(50.0, "Hz", "its frequency with the axis held", lower=1e-3, scale="resonance"),
            "damping": Parameter(0.1, "1", "damping ratio", lower=1e-4, upper=0.95, scale="number"),
        },
        linear=("mass",),
        states={"y": 1, "v": 1, "a": 1},
        reads=("a", "dt"),
        holds=("odd",),
    )
