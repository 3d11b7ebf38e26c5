"""What a channel does beside measuring: it drifts, or its clock is another one."""

from workbench.definition import SENSOR, TIME, Effect, effect
from workbench.effects.settling import SINCE, counted, going_over, gone_over
from workbench.parameter import Parameter


@effect
def sensor_trend() -> Effect:
    """y = q + r (t - t0), t on the bench clock. At the drive's channel q is the torque or force that it reports."""

    def step(s, z, p):
        return {}, s.q + p.rate * counted(s.t, p.since)

    return Effect(
        name="sensor_trend",
        cause="a reading that drifts: the mount of a scale warms up, or an analogue channel has an offset that moves",
        formula="y = q + r (t - t0)",
        source="measurement practice",
        port=SENSOR,
        family="reading over time",
        reduces={"rate": (0.0, "")},
        parameters={"rate": Parameter(0.0, "x/s", "drift of the reading")} | SINCE,
        reads=("q", "t"),
        step=step,
        places=("sensor", "drive"),
        at="sensor.position",
    )


@effect
def sensor_settling() -> Effect:
    """y = q + r (1 - exp(-e (t - t0)))/e, t on the bench clock: a drift of rate r at first, that settles. With e = 0 it is a `sensor_trend`."""

    def step(s, z, p):
        return {}, s.q + gone_over(p.rate, counted(s.t, p.since), p.settling)

    return Effect(
        name="sensor_settling",
        cause="a reading that drifts until a mount, a scale or an amplifier is warm",
        formula="y = q + r (1 - exp(-e (t - t0)))/e",
        source="measurement practice; lumped heating of one time constant",
        port=SENSOR,
        family="reading over time",
        traced=False,
        nearest="sensor_trend",
        reduces={"rate": (0.0, "")},
        parameters=going_over("x/s", "drift of the reading at first", 1e-2) | SINCE,
        reads=("q", "t"),
        step=step,
        places=("sensor", "drive"),
        at="sensor.position",
    )


@effect
def clock_skew() -> Effect:
    """y(t) = x(t - (d + s t)): the channel is stamped by a clock that is late by d and gains s seconds a second."""

    def step(s, z, p):
        return {}, p.offset + p.skew * s.t

    return _clock(
        name="clock_skew",
        cause="channels logged by two devices whose clocks were not started together, or do not run alike",
        formula="y(t) = x(t - d - s t)",
        source="measurement practice",
        reads=("t",),
        step=step,
    )


@effect
def restarted_clock() -> Effect:
    """y(t) = x(t - (d + s age)): a clock that does not run alike, set anew where each record begins; age is the time since then.

    Beside one record it is a `clock_skew`, under whose name it is traced.
    """

    def step(s, z, p):
        return {"age": z.age + s.dt}, p.offset + p.skew * z.age

    return _clock(
        name="restarted_clock",
        cause="channels logged by two devices that one trigger starts, each by a quartz of its own",
        formula="y(t) = x(t - d - s age), age the time since the record began",
        source="measurement practice; quartzes of counter cards differ by 1e-5 to 1e-4",
        states={"age": 1},
        reads=("dt",),
        step=step,
        traced=False,
        nearest="clock_skew",
    )


def _clock(**own) -> Effect:
    """Return the effect of a channel that is stamped by another clock. own: what is its own."""
    return Effect(
        **own,
        port=TIME,
        family="time",
        reduces={"skew": (0.0, "transport_delay")},
        parameters={
            "offset": Parameter(0.0, "s", "delay of the channel", lower=-0.05, upper=0.05, scale="time"),
            "skew": Parameter(0.0, "1", "seconds gained a second", lower=-1e-2, upper=1e-2, scale="drift"),
        },
        places=("sensor",),
        at="sensor.position",
    )
