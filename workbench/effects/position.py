"""Torques that depend on position without a period of its own: gravity, a spring to ground, and a constant."""

from math import atan2, hypot

from workbench.border import Border
from workbench.definition import FORCE, Effect, effect
from workbench.effects.elementary import cos, maximum, minimum, power, sin
from workbench.parameter import Parameter


@effect
def gravity() -> Effect:
    """T = mgl sin(q + phase)."""

    def step(s, z, p):
        return {}, p.sine * sin(s.q) + p.cosine * cos(s.q)

    return Effect(
        name="gravity",
        cause="weight of an unbalanced load",
        formula="T = mgl sin(q + phase)",
        source="rigid-body statics",
        port=FORCE,
        family="force over position",
        parameters={
            "sine": Parameter(0.0, "F", "amplitude with the sine of position"),
            "cosine": Parameter(0.0, "F", "amplitude with the cosine of position"),
        },
        linear=("sine", "cosine"),
        reads=("q",),
        step=step,
        holds=("conservative",),
        places=("axis", "motor", "load"),
        motions=("rotary",),  # on a linear axis weight is a constant offset
        border=Border(
            parameters={
                "mgl": Parameter(0.0, "F", "weight times lever; below 0 it is the phase that is turned by pi"),
                "phase": Parameter(0.0, "rad", "phase"),
            },
            inward=lambda o: {"sine": o["mgl"] * cos(o["phase"]), "cosine": o["mgl"] * sin(o["phase"])},
            outward=lambda i: {"mgl": hypot(i["sine"], i["cosine"]), "phase": atan2(i["cosine"], i["sine"])},
            linear=("mgl",),
        ),
    )


@effect
def cable_spring() -> Effect:
    """T = k (q - rest), inside k q + preload."""

    def step(s, z, p):
        return {}, p.stiffness * s.q + p.preload

    return Effect(
        name="cable_spring",
        cause="a cable chain, hose or flexure that pulls the axis towards a rest position",
        formula="T = k (q - rest)",
        source="Hooke's law",
        port=FORCE,
        family="force over position",
        reduces={"stiffness": (0.0, "constant_offset")},
        parameters={
            "stiffness": Parameter(0.0, "F/x", "stiffness to ground", lower=0.0),
            "preload": Parameter(0.0, "F", "force at position zero"),
        },
        linear=("stiffness", "preload"),
        reads=("q",),
        step=step,
        holds=("conservative",),
        places=("axis", "motor", "load"),
        stated=("motor",),  # a cable hangs on what moves farthest
        border=Border(
            parameters={
                "stiffness": Parameter(0.0, "F/x", "stiffness to ground", lower=0.0),
                "rest": Parameter(0.0, "x", "rest position"),
            },
            inward=lambda o: {"stiffness": o["stiffness"], "preload": -o["stiffness"] * o["rest"]},
            outward=lambda i: {
                "stiffness": i["stiffness"],
                "rest": -i["preload"] / i["stiffness"] if i["stiffness"] else 0.0,
            },
            linear=("stiffness",),
        ),
    )


@effect
def slack_cable() -> Effect:
    """T = r ((q - p)+/L)^n - l ((p - q)+/L)^n: a spring of its own on either side of a place p; where one side has none it hangs slack.

    L is a reference and no number of the axis: r and l are the forces at that distance from p. With one of them alone it is a bumper that is met there.
    """

    def step(s, z, p):
        right, left = maximum(s.q - p.place, 0.0), maximum(p.place - s.q, 0.0)
        taut = p.right * power(right / p.length, p.exponent) - p.left * power(left / p.length, p.exponent)
        return {}, taut

    return _of_its_place(
        name="slack_cable",
        cause="a hose or a cable that hangs slack until a place of the stroke, and is pulled taut beyond",
        formula="T = r ((q - p)+/L)^n - l ((p - q)+/L)^n",
        source="unilateral contact, n = 1.5 after Hertz 1882",
        reduces={"right": (0.0, "piecewise_stiffness"), "left": (0.0, "piecewise_stiffness")},
        parameters={
            "right": Parameter(0.0, "F", "force at the reference distance above the place", lower=0.0),
            "left": Parameter(0.0, "F", "force at the reference distance below the place", lower=0.0),
            "place": Parameter(0.0, "x", "where it comes taut", scale="place"),
            "exponent": Parameter(1.0, "1", "exponent of the distance", lower=1.0, upper=4.0, scale="exponent"),
            "length": Parameter(0.1, "x", "reference distance", lower=1e-9, fixed=True),
        },
        linear=("right", "left"),
        step=step,
        nearest="cable_spring",
        knots=("length",),
    )


@effect
def end_stops() -> Effect:
    """T = r (q - p2)+ - l (p1 - q)+: a bumper of its own at either end of the stroke, and nothing between p1 and p2.

    Two that overlap are a spring and no stops: p1 above p2 is p2.
    """

    def step(s, z, p):
        lower = minimum(p.lower, p.upper)
        return {}, p.right * maximum(s.q - p.upper, 0.0) - p.left * maximum(lower - s.q, 0.0)

    return _of_its_place(
        name="end_stops",
        cause="bumpers, hoses or covers that are met near both ends of the stroke, neither alike nor as far from zero",
        formula="T = r (q - p2)+ - l (p1 - q)+",
        source="unilateral contact, at two places",
        reduces={"right": (0.0, "piecewise_stiffness"), "left": (0.0, "piecewise_stiffness")},
        parameters={
            "right": Parameter(0.0, "F/x", "stiffness above the upper place", lower=0.0),
            "left": Parameter(0.0, "F/x", "stiffness below the lower place", lower=0.0),
            "upper": Parameter(0.1, "x", "where the one above is met", scale="place"),
            "lower": Parameter(-0.1, "x", "where the one below is met", scale="place"),
        },
        linear=("right", "left"),
        step=step,
        nearest="piecewise_stiffness",
    )


@effect
def hardening_cable() -> Effect:
    """T = k (q - rest) + k3 (q - rest)^3, k3 >= 0: a cable or a flexure that pulls the harder, the farther it is bent."""

    def step(s, z, p):
        x = s.q - p.rest
        return {}, p.stiffness * x + p.cubic * (x * x * x)

    return _of_its_place(
        name="hardening_cable",
        cause="a cable wrap, a hose or a flexure that stiffens as it is bent, about a rest position",
        formula="T = k (q - rest) + k3 (q - rest)^3",
        source="Duffing 1918",
        parameters={
            "stiffness": Parameter(0.0, "F/x", "stiffness at rest", lower=0.0),
            "cubic": Parameter(0.0, "F/x^3", "cubic stiffness", lower=0.0),
            "rest": Parameter(0.0, "x", "rest position", scale="place"),
        },
        linear=("stiffness", "cubic"),
        step=step,
        nearest="cable_spring",
    )


def _of_its_place(**own) -> Effect:
    """Return another spelling of what pulls or pushes the body over its place. own: what is its own."""
    return Effect(
        **own,
        port=FORCE,
        family="force over position",
        reads=("q",),
        holds=("conservative",),
        places=("axis", "motor", "load"),
        stated=("motor",),
        traced=False,
    )


@effect
def constant_offset() -> Effect:
    """T = offset."""

    def step(s, z, p):
        return {}, p.offset

    return Effect(
        name="constant_offset",
        cause="offset of the current sensor, a constant load, or of a joint what its encoders' zeros lie apart",
        formula="T = T0",
        source="measurement practice",
        port=FORCE,
        family="force over position",
        parameters={"offset": Parameter(0.0, "F", "offset")},
        linear=("offset",),
        step=step,
        holds=("conservative",),
        places=("axis", "motor", "load", "joint"),
        stated=("joint",),  # with one at either body it says the same
    )
