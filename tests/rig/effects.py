"""What may be missing of a declared model: every effect of the catalogue, and causes that no catalogue has.

To add one, write its law in kernel.py (or a field of the Axis) and one entry here.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from rig.bases import Base
from rig.kernel import slip_at
from rig.machine import Machine, Target

PLAIN = ("presliding", "coulomb", "stribeck", "gravity", "linear")
ROTARY = ("presliding", "coulomb", "stribeck", "gravity")
SLIDING = ("presliding", "gravity", "linear")
TWO = ("two mass", "elastic")


@dataclass(frozen=True)
class Kind:
    """One thing that may be missing.

    effect: the name that a trace should give it; "" for what no catalogue has. draw(rng, base) -> parameters; the first is
    a typical size with its sign, which is then scaled. law: of the kernel, at one of the places; or fields: of the Axis,
    which the parameters are added to. wrong: the field or parameter whose declared value is off by p[0], as a share.
    bases: on what it may be missing. names: what p is called. where(p, seconds): of a cause outside the catalogue, the
    coordinate and the places (low, high) in which it lives, position in rad. natural: p[0] is kept as drawn. largest(base):
    of p[0], beyond which it is another effect.
    """

    effect: str
    draw: Callable[[np.random.Generator, Base], tuple[float, ...]]
    names: tuple[str, ...]
    law: str = ""
    fields: tuple[str, ...] = ()
    wrong: Target | None = None
    places: tuple[str, ...] = ("axis", "motor")
    bases: tuple[str, ...] = PLAIN
    where: Callable | None = None
    natural: bool = False
    largest: Callable[[Base], float] = lambda base: float("inf")

    def on(self, machine: Machine, at: str, p: tuple[float, ...]) -> Machine:
        """The machine with this on it."""
        if self.law:
            return machine.adding(self.law, at, p)
        if self.wrong is not None:  # the machine is what it was; somebody believes something else of it
            return machine
        values = {
            f: (getattr(machine.axis, f) if k == 0 else 0.0) + x
            for k, (f, x) in enumerate(zip(self.fields, p, strict=True))
        }
        return replace(machine, axis=machine.axis._replace(**values))


def phase(rng) -> float:
    return rng.uniform(-np.pi, np.pi)


def sign(rng) -> float:
    return rng.choice([-1.0, 1.0])


def order(rng, base: Base) -> float:
    """An order over one turn of the output, or over the pitch of a screw or of the magnets."""
    if not base.rotary:
        return rng.choice([2.0, 5.0, 20.0, 62.8])
    return rng.choice([2.0, base.ratio, 2.0 * base.ratio, base.pole_pairs * base.ratio])


def turning_order(rng, base: Base) -> float:
    return rng.choice([1.0, 2.0, base.ratio]) if base.rotary else rng.choice([1.0, 3.0, 20.0])


def span(p, seconds):
    return "position", [(p[1], p[2])]


def slip_times(p, seconds):
    moments = [slip_at(k, p[1], p[2]) for k in range(int(seconds / p[1]) + 1)]
    return "time", [(m, m + p[3]) for m in moments]


def loss_times(p, seconds):
    return "time", [(k * p[1], k * p[1]) for k in range(1, int(seconds / p[1]) + 1)]


EFFECTS: dict[str, Kind] = {
    # dry and viscous friction
    "stribeck_friction": Kind(
        "stribeck_friction", lambda r, b: (0.03, r.uniform(0.2, 1.5)), ("drop", "speed"), "stribeck",
        bases=("presliding", "coulomb", "gravity", "linear", "two mass"),
    ),
    "coulomb_asymmetry": Kind(
        "coulomb_asymmetry", lambda r, b: (0.01 * sign(r), r.uniform(0.0, 0.15)), ("coulomb", "viscous"), "asymmetry",
        bases=(*PLAIN, "two mass"),
    ),
    "nonlinear_viscous_friction": Kind(
        "nonlinear_viscous_friction", lambda r, b: (2e-4 * sign(r),), ("quadratic",), "nonlinear_viscous",
        bases=(*PLAIN, "two mass"),
    ),
    "load_dependent_friction": Kind(
        "load_dependent_friction", lambda r, b: (0.05, r.uniform(0.4, 1.0)), ("mu", "share"), "loaded",
        bases=(*PLAIN, "two mass"),
    ),
    "friction_drift": Kind(
        "friction_drift", lambda r, b: (3e-4 * sign(r), 0.0), ("rate", "from"), "drift", bases=(*PLAIN, "two mass")
    ),
    "cyclic_friction": Kind(
        "cyclic_friction", lambda r, b: (0.02, turning_order(r, b), phase(r), r.choice([0.0, 0.1]), phase(r)),
        ("amplitude", "order", "phase", "viscous", "viscous_phase"), "cyclic", bases=(*PLAIN, "two mass"),
    ),
    "viscous_friction": Kind("viscous_friction", lambda r, b: (0.002,), ("viscous",), fields=("viscous",), bases=("dry",)),
    "coulomb_friction": Kind("coulomb_friction", lambda r, b: (0.02,), ("coulomb",), fields=("h0",), bases=("viscous",)),
    "presliding_hysteresis@load": Kind(  # with the presliding stroke of the motor's
        "presliding_hysteresis", lambda r, b: (0.02,), ("h0",), fields=("load_h",), places=("load",), bases=TWO
    ),
    "presliding_hysteresis": Kind(
        "presliding_hysteresis", lambda r, b: (0.05, r.uniform(300.0, 900.0)), ("h0", "a"), fields=("h1", "rate1"),
        bases=("coulomb",),
    ),
    "lugre_friction": Kind(
        "lugre_friction", lambda r, b: (0.05, r.uniform(5e-4, 2e-3), r.uniform(0.3, 1.0), r.uniform(0.2, 1.0), 0.01),
        ("sliding", "x0", "ratio", "speed", "damping"), "bristles", bases=("viscous",),
    ),
    # memory
    "creep": Kind(
        "creep", lambda r, b: (0.02, r.uniform(0.3, 2.0), r.uniform(5.0, 20.0), r.uniform(0.3, 1.0)),
        ("stiffness", "slow", "fast", "second"), "creeping",
    ),
    "fading_memory": Kind("fading_memory", lambda r, b: (0.03, r.uniform(0.02, 0.3)), ("height", "distance"), "forgetting"),
    "flexible_mode": Kind(
        "flexible_mode", lambda r, b: (2e-4, r.uniform(20.0, 70.0), r.uniform(0.02, 0.15)), ("inertia", "frequency", "damping"),
        "swinging",
    ),
    # position
    "cogging": Kind(
        "cogging", lambda r, b: (0.02, order(r, b), phase(r), r.uniform(0.0, 0.3), phase(r)),
        ("amplitude", "order", "phase", "second", "phase_2"), "cogging", bases=(*PLAIN, "two mass"),
    ),
    "cable_spring": Kind(
        "cable_spring", lambda r, b: (0.01, r.uniform(-3.0, 3.0)), ("stiffness", "rest"), "cable",
        places=("axis", "load"), bases=(*PLAIN, "two mass"),
    ),
    "gravity": Kind(
        "gravity", lambda r, b: (0.03, phase(r)), ("mgl", "phase"), "weight", places=("axis", "load"),
        bases=("presliding", "coulomb", "stribeck", "two mass"),
    ),
    "constant_offset": Kind("constant_offset", lambda r, b: (0.01 * sign(r),), ("offset",), "offset", bases=(*PLAIN, "two mass")),
    # drive, encoder, clock
    "transport_delay": Kind(
        "transport_delay", lambda r, b: (5e-4,), ("delay",), fields=("delay",), places=("command",), bases=(*PLAIN, "two mass")
    ),
    "actuator_lag": Kind(
        "actuator_lag", lambda r, b: (5e-4,), ("time_constant",), fields=("lag",), places=("command",), bases=(*PLAIN, "two mass")
    ),
    "torque_constant_saturation": Kind(
        "torque_constant_saturation", lambda r, b: (0.05,), ("fall",), fields=("fall",), places=("command",),
        bases=(*PLAIN, "two mass"),
    ),
    "encoder_eccentricity": Kind(
        "encoder_eccentricity", lambda r, b: (2e-3, 1.0, phase(r)), ("amplitude", "turns", "phase"),
        fields=("error", "error_turns", "error_phase"), places=("sensor.position",), bases=ROTARY,
        largest=lambda b: 0.2,  # of the disc's radius
    ),
    "kinematic_error": Kind(
        # of one encoder a wave once a turn of the motor is its disc's by another name: the wave generator's two
        "kinematic_error", lambda r, b: (1e-4, 2.0 * b.ratio if b.rotary else r.choice([20.0, 40.0]), phase(r)),
        ("amplitude", "order", "phase"), fields=("error", "error_turns", "error_phase"), places=("sensor.position",),
    ),
    "sensor_trend": Kind("sensor_trend", lambda r, b: (2e-4 * sign(r),), ("rate",), fields=("trend",), places=("sensor.position",), bases=SLIDING),
    "clock_skew": Kind(
        "clock_skew", lambda r, b: (2e-5 * sign(r),), ("skew",), fields=("skew",), places=("sensor.position",)
    ),
    "clock_skew@load": Kind(
        "clock_skew", lambda r, b: (2e-5 * sign(r),), ("skew",), fields=("skew",), places=("sensor.load_position",), bases=TWO
    ),
    # what is declared, and wrong
    "inertia": Kind("inertia", lambda r, b: (0.05 * sign(r),), ("share",), wrong="inertia", bases=(*PLAIN, "two mass")),
    "inertia of a data sheet": Kind(
        "inertia", lambda r, b: (sign(r) * r.uniform(0.1, 0.3),), ("share",), wrong="inertia", bases=(*PLAIN, "two mass"), natural=True
    ),
    "inertia@load": Kind(
        "inertia", lambda r, b: (0.05 * sign(r),), ("share",), wrong="load_inertia", places=("load",), bases=TWO
    ),
    "viscous_friction of a data sheet": Kind(
        "viscous_friction", lambda r, b: (sign(r) * r.uniform(0.2, 0.4),), ("share",), wrong="viscous", bases=PLAIN, natural=True
    ),
    "gravity of a data sheet": Kind(
        "gravity", lambda r, b: (sign(r) * r.uniform(0.1, 0.3),), ("share",), wrong=("weight", 0), bases=("gravity",), natural=True
    ),
    "flexible_mode@load": Kind(
        "flexible_mode", lambda r, b: (2e-4, r.uniform(20.0, 50.0), r.uniform(0.02, 0.1)), ("inertia", "frequency", "damping"),
        "swinging", places=("load",), bases=TWO,
    ),
    # in the joint of two masses
    "kinematic_error@joint": Kind(
        "kinematic_error", lambda r, b: (5e-5, r.choice([1.0, 2.0]) * b.ratio, phase(r)), ("amplitude", "order", "phase"),
        fields=("tooth", "tooth_turns", "tooth_phase"), places=("joint",), bases=TWO,
    ),
    "backlash": Kind("backlash", lambda r, b: (5e-5,), ("half_width",), fields=("gap",), places=("joint",), bases=TWO),
    "creep@joint": Kind(
        "creep", lambda r, b: (30.0, r.uniform(0.3, 2.0), r.uniform(5.0, 20.0), r.uniform(0.3, 1.0)),
        ("stiffness", "slow", "fast", "second"), "creeping", places=("joint",), bases=TWO,
    ),
    "cubic_stiffness": Kind("cubic_stiffness", lambda r, b: (1e6,), ("k3",), "hardening", places=("joint",), bases=TWO),
    "piecewise_stiffness": Kind(
        "piecewise_stiffness", lambda r, b: (100.0, r.uniform(3e-4, 8e-4)), ("k2", "threshold"), "second_slope", places=("joint",), bases=TWO,
        largest=lambda b: 10.0 * b.machine.axis.k2,  # harder still is an end stop
    ),
    "multi_body_compliance": Kind(
        "multi_body_compliance", lambda r, b: (2.0, 1.3 * b.machine.axis.k2, r.uniform(0.5, 1.5), 1.3 / 0.3 * b.machine.axis.k2, b.machine.axis.k2),
        ("per_torque", "flexspline", "ratio", "generator", "instead_of"), "in_series", places=("joint",), bases=("elastic",),
    ),
    "presliding_hysteresis@joint": Kind(
        "presliding_hysteresis", lambda r, b: (0.05,), ("h0",), fields=("h2",), places=("joint",), bases=("elastic",)
    ),
    "linear_damping": Kind("linear_damping", lambda r, b: (0.02,), ("damping",), fields=("c2",), places=("joint",), bases=("undamped",)),
    # outside the catalogue
    "window_friction": Kind(
        "", lambda r, b: (0.05, *(r.uniform(-0.6, -0.2) + np.array([0.0, r.uniform(0.4, 0.8)])), 0.01),
        ("amplitude", "from", "to", "edge"), "window", where=span, bases=(*PLAIN, "two mass"),
    ),
    "slip_moments": Kind(
        "", lambda r, b: (0.1, r.uniform(0.6, 1.2), phase(r), 0.08), ("amplitude", "every", "seed", "length"), "slips",
        where=slip_times, bases=(*PLAIN, "two mass"),
    ),
    "fan": Kind(
        "", lambda r, b: (0.02, r.uniform(15.0, 60.0), *(r.uniform(1.5, 3.5) + np.array([0.0, r.uniform(4.0, 8.0)])), phase(r)),
        ("amplitude", "frequency", "on", "off", "phase"), "fan", where=lambda p, seconds: ("time", [(p[2], p[3])]),
    ),
    "rattle": Kind(
        "", lambda r, b: (0.05, r.uniform(30.0, 70.0), *(r.uniform(0.8, 1.3) * np.array([1.0, 1.8])), phase(r)),
        ("amplitude", "frequency", "from", "to", "phase"), "rattle",
        where=lambda p, seconds: ("velocity", [(p[2], p[3]), (-p[3], -p[2])]),
    ),
    "hard_spot": Kind(
        "", lambda r, b: (0.5, r.uniform(-0.7, 0.7), r.uniform(0.05, 0.15)), ("amplitude", "place", "width"), "hard_spot",
        where=lambda p, seconds: ("position", [(p[1] - 1.5 * p[2], p[1] + 1.5 * p[2])]),
    ),
    "missed_counts": Kind(
        "", lambda r, b: (2e-4, r.uniform(1.5, 3.0)), ("step", "every"), fields=("lost", "lost_every"),
        places=("sensor.position",), where=loss_times, bases=(*PLAIN, "two mass"),
    ),
    "slip@joint": Kind(
        "", lambda r, b: (2e-4, r.uniform(1.5, 3.0), phase(r)), ("step", "every", "seed"), fields=("slid", "slid_every", "slid_seed"),
        places=("joint",), bases=("two mass",), where=lambda p, seconds: slip_times((*p, 0.0), seconds),
    ),
    "coarse_torque": Kind(
        "", lambda r, b: (0.05,), ("step",), fields=("grain",), places=("command",), where=lambda p, seconds: ("command", []),
    ),
}  # fmt: skip
