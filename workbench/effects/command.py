"""What happens to the command before it acts: transport delay, actuator lag, a torque constant that falls."""

from workbench.definition import COMMAND, TIME, Effect, effect
from workbench.effects._arithmetic import sqrt
from workbench.effects.elementary import exp, square
from workbench.parameter import Parameter


@effect
def transport_delay() -> Effect:
    """u'(t) = u(t - delay). At the drive's own channel u' is what it reports, and the report is late."""

    def step(s, z, p):
        return {}, p.delay

    return Effect(
        name="transport_delay",
        cause="bus cycles and computation between the logged command and the torque, or between the torque and its report",
        formula="u'(t) = u(t - delay)",
        source="Astrom and Wittenmark, Computer-Controlled Systems, 1997",
        port=TIME,
        family="time",
        reduces={"delay": (0.0, "")},
        parameters={"delay": Parameter(0.0, "s", "transport delay", lower=0.0, upper=0.05, scale="time")},
        step=step,
        places=("command", "drive"),
        at="command",
    )


@effect
def actuator_lag() -> Effect:
    """T du'/dt + u' = u, by the exact step for a command that is linear between samples.

    With e = exp(-dt/T) and w = (1 - e) T/dt: u'+ = e u' + (w - e) u_before + (1 - w) u.
    """

    def step(s, z, p):
        ratio = s.dt / p.time_constant
        e = exp(-ratio)
        w = (1.0 - e) / ratio
        y = e * z.y + (w - e) * z.before + (1.0 - w) * s.u
        return {"y": y, "before": s.u}, y

    return Effect(
        name="actuator_lag",
        cause="finite bandwidth of the current loop",
        formula="T du'/dt + u' = u",
        source="first-order hold equivalent, Franklin, Powell, Workman 1998",
        port=COMMAND,
        family="time",
        parameters={
            "time_constant": Parameter(1e-4, "s", "time constant", lower=1e-6, upper=0.1, scale="time"),
        },
        states={"y": 1, "before": 1},
        reads=("u", "dt"),
        step=step,
        places=("command",),
        at="command",
    )


@effect
def torque_constant_error() -> Effect:
    """u' = (1 + e) u: this motor's torque constant, as a share off the one that the drive computes with.

    On records it cannot be told from all inertias and forces being off by the same share, so it is not traced.
    """

    def step(s, z, p):
        return {}, (1.0 + p.error) * s.u

    return Effect(
        name="torque_constant_error",
        cause="magnets and windings differ between motors of one type: the torque constant is off its catalogue value",
        formula="u' = (1 + e) u",
        source="Hanselman, Brushless Permanent Magnet Motor Design, 2003 (tolerances)",
        port=COMMAND,
        family="drive over command",
        reduces={"error": (0.0, "")},
        parameters={"error": Parameter(0.0, "1", "e: share by which torque is off", lower=-0.9, upper=9.0)},
        reads=("u",),
        step=step,
        holds=("odd",),
        places=("command",),
        at="command",
        traced=False,
    )


@effect
def torque_constant_saturation() -> Effect:
    """u' = u/sqrt(1 + c u^2): the torque constant falls with current, K(u) = K0/sqrt(1 + c u^2).

    Odd, smooth and increasing, so that it has an inverse; u' stays below 1/sqrt(c), and K has fallen by 29 % where u is
    that large. To second order every even law K0 (1 - c u^2/2) is the same; c = 0 is a constant that does not fall.
    """

    def step(s, z, p):
        return {}, s.u / sqrt(1.0 + p.fall * square(s.u))

    return Effect(
        name="torque_constant_saturation",
        cause="iron that saturates: at high current the motor gives less torque than its constant promises",
        formula="u' = u/sqrt(1 + c u^2)",
        source="Hanselman, Brushless Permanent Magnet Motor Design, 2003 (saturation); form chosen for its inverse",
        port=COMMAND,
        family="drive over command",
        reduces={"fall": (0.0, "")},
        parameters={"fall": Parameter(0.0, "1/F/F", "c: fall of the torque constant with drive squared", lower=0.0)},
        reads=("u",),
        step=step,
        holds=("odd",),
        places=("command",),
        at="command",
    )
