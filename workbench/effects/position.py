"""Torques that depend on position: cogging, gravity, springs to ground, and a constant."""

from math import atan2, hypot
from math import cos as cosine
from math import sin as sine

from workbench.effect import FORCE, Border, Effect, effect
from workbench.effects.elementary import cos, sin
from workbench.parameter import Parameter


@effect
def cogging() -> Effect:
    """T = A1 sin(k q + p1) + A2 sin(2 k q + p2), k the order per radian of output (linear: per metre)."""

    def step(s, z, p):
        angle = p.order * s.q
        return {}, (p.s1 * sin(angle) + p.c1 * cos(angle)) + (p.s2 * sin(2.0 * angle) + p.c2 * cos(2.0 * angle))

    def inward(o):
        return {
            "s1": o["amplitude"] * cosine(o["phase"]),
            "c1": o["amplitude"] * sine(o["phase"]),
            "s2": o["amplitude_2"] * cosine(o["phase_2"]),
            "c2": o["amplitude_2"] * sine(o["phase_2"]),
            "order": o["order"],
        }

    def outward(i):
        return {
            "amplitude": hypot(i["s1"], i["c1"]),
            "phase": atan2(i["c1"], i["s1"]),
            "amplitude_2": hypot(i["s2"], i["c2"]),
            "phase_2": atan2(i["c2"], i["s2"]),
            "order": i["order"],
        }

    order = Parameter(1.0, "1/x", "order: periods in 2 pi of displacement", lower=1e-9, scale="order")
    return Effect(
        name="cogging",
        cause="attraction between magnets and slots, or torque ripple of the commutation, periodic in position",
        formula="T = A1 sin(k q + p1) + A2 sin(2 k q + p2)",
        source="Hanselman, Brushless Permanent Magnet Motor Design, 2003",
        port=FORCE,
        parameters={
            "s1": Parameter(0.0, "F", "sine amplitude, first harmonic"),
            "c1": Parameter(0.0, "F", "cosine amplitude, first harmonic"),
            "s2": Parameter(0.0, "F", "sine amplitude, second harmonic"),
            "c2": Parameter(0.0, "F", "cosine amplitude, second harmonic"),
            "order": order,
        },
        linear=("s1", "c1", "s2", "c2"),
        reads=("q",),
        step=step,
        holds=("conservative",),
        border=Border(
            parameters={
                "amplitude": Parameter(0.0, "F", "amplitude of the first harmonic", lower=0.0),
                "phase": Parameter(0.0, "rad", "phase of the first harmonic"),
                "amplitude_2": Parameter(0.0, "F", "amplitude of the second harmonic", lower=0.0),
                "phase_2": Parameter(0.0, "rad", "phase of the second harmonic"),
                "order": order,
            },
            inward=inward,
            outward=outward,
        ),
    )


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
        parameters={
            "sine": Parameter(0.0, "F", "amplitude with the sine of position"),
            "cosine": Parameter(0.0, "F", "amplitude with the cosine of position"),
        },
        linear=("sine", "cosine"),
        reads=("q",),
        step=step,
        holds=("conservative",),
        places=("axis", "load"),
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
        parameters={
            "stiffness": Parameter(0.0, "F/x", "stiffness to ground", lower=0.0),
            "preload": Parameter(0.0, "F", "force at position zero"),
        },
        linear=("stiffness", "preload"),
        reads=("q",),
        step=step,
        holds=("conservative",),
        places=("axis", "load"),
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
        cause="offset of the current sensor, or a constant load",
        formula="T = T0",
        source="measurement practice",
        port=FORCE,
        parameters={"offset": Parameter(0.0, "F", "offset")},
        linear=("offset",),
        step=step,
        holds=("conservative",),
        places=("axis", "motor", "load"),
    )
