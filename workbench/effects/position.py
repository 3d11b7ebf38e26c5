"""Torques that depend on position without a period of its own: gravity, a spring to ground, and a constant."""

from math import atan2, hypot
from math import cos as cosine
from math import sin as sine

from workbench.definition import FORCE, Border, Effect, effect
from workbench.effects.elementary import cos, sin
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
                "mgl": Parameter(0.0, "F", "weight times lever", lower=0.0),
                "phase": Parameter(0.0, "rad", "phase"),
            },
            inward=lambda o: {"sine": o["mgl"] * cosine(o["phase"]), "cosine": o["mgl"] * sine(o["phase"])},
            outward=lambda i: {"mgl": hypot(i["sine"], i["cosine"]), "phase": atan2(i["cosine"], i["sine"])},
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
        ),
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
