"""Machines whose declared model is right, and how a campaign.toml states them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rig.kernel import LIMIT, Axis
from rig.machine import Machine, Target
from rig.motions import Planned

# Units in F (torque or force) and x (angle or displacement): rotary, linear, and the powers of both.
UNITS = {
    "F*s^2/x": ("kg*m^2", "kg", 1, -1),
    "F*s/x": ("N*m*s/rad", "N*s/m", 1, -1),
    "F": ("N*m", "N", 1, 0),
    "1/x": ("1/rad", "1/m", 0, -1),
    "x/s": ("rad/s", "m/s", 0, 1),
    "F/x": ("N*m/rad", "N/m", 1, -1),
    "angle": ("rad", "rad", 0, 0),
}


@dataclass(frozen=True)
class Stated:
    """One parameter of a declared effect: its key, unit, where the machine has it, and whether it is from a data sheet."""

    key: str
    unit: str
    target: Target
    fixed: bool = False


@dataclass(frozen=True)
class Declared:
    effect: str
    at: str
    parameters: tuple[Stated, ...]

    @property
    def free(self) -> tuple[Target, ...]:
        return tuple(s.target for s in self.parameters if not s.fixed)


@dataclass(frozen=True)
class Base:
    """machine: the true one as long as nothing is missing. declared: how it is stated. metres, newtons: on a linear axis,
    the travel that is one radian and the force that is one N*m; None on a rotary one. also: what a
    trace may add besides, as it is there on the scale of a count."""

    name: str
    machine: Machine
    declared: tuple[Declared, ...]
    ratio: float = 30.0
    pole_pairs: int = 5
    metres: float | None = None
    newtons: float = 1.0
    also: tuple[str, ...] = ()

    @property
    def rotary(self) -> bool:
        return self.metres is None

    def outside(self, unit: str) -> tuple[float, str]:
        """Return (factor, unit) with which a value inside the rig is written."""
        rotary, linear, force, length = UNITS[unit]
        if self.rotary:
            return 1.0, rotary
        return self.newtons**force * self.metres**length, linear


def around(rng, value: float, part: float) -> float:
    return value * np.exp(rng.uniform(-part, part))


INERTIA = Stated("inertia", "F*s^2/x", "inertia", True)
VISCOUS = Declared("viscous_friction", "axis", (Stated("viscous", "F*s/x", "viscous"),))
COULOMB = Declared("coulomb_friction", "axis", (Stated("coulomb", "F", "h0"),))
PRESLIDING = Declared("presliding_hysteresis", "axis", (Stated("h0", "F", "h0"), Stated("a", "1/x", "rate")))
STRIBECK = Declared(
    "stribeck_friction", "axis", (Stated("drop", "F", ("stribeck", 0)), Stated("speed", "x/s", ("stribeck", 1)))
)
GRAVITY = Declared("gravity", "axis", (Stated("mgl", "F", ("weight", 0)), Stated("phase", "angle", ("weight", 1))))
ONE_MASS = {
    "presliding": (VISCOUS, PRESLIDING),
    "coulomb": (VISCOUS, COULOMB),
    "stribeck": (VISCOUS, PRESLIDING, STRIBECK),
    "gravity": (VISCOUS, PRESLIDING, GRAVITY),
    "linear": (VISCOUS, PRESLIDING),
    "viscous": (VISCOUS,),  # dry friction is for somebody to find
    "dry": (PRESLIDING,),
}
MEMORY = ("presliding_hysteresis", "fading_memory", "lugre_friction")  # friction that gives way before it slips
TWO_MASS = ("two mass", "elastic", "undamped")  # as it is; no hysteresis in the joint; no damping there


def plain(axis: Axis) -> Base:
    """An axis of one mass with these facts, presliding friction declared."""
    return Base("presliding", Machine(axis, {}), (Declared("inertia", "axis", (INERTIA,)), VISCOUS, PRESLIDING))


def servo(rng) -> Axis:
    """An axis as a small harmonic-drive servo has it."""
    return Axis(around(rng, 0.0026, 0.3), around(rng, 0.011, 0.3), around(rng, 0.15, 0.3), around(rng, 650.0, 0.4))


def one_mass(rng, name: str, count: float) -> Base:
    """An axis of one mass. Draws the same facts for every base, so that seeds compare."""
    declared = ONE_MASS[name]
    machine = Machine(servo(rng)._replace(count=count), {})
    if name in (
        "coulomb",
        "viscous",
    ):  # light dry friction that gives way by two counts: no log can tell it from a jump
        machine = machine.put("rate", 0.5 / count).put("h0", 0.25 * machine.axis.h0)
    if name == "viscous":
        machine = machine.put("h0", 0.0)
    if name == "dry":
        machine = machine.put("viscous", 0.0)
    if name == "stribeck":
        machine = machine.adding("stribeck", "axis", (rng.uniform(0.03, 0.06), rng.uniform(0.3, 1.2)))
    if name == "gravity":
        machine = machine.adding("weight", "axis", (rng.uniform(0.08, 0.25), rng.uniform(-3.0, 3.0)))
    inertia = Declared("inertia", "axis", (INERTIA,))
    if name == "linear":
        return Base(
            name, machine, (inertia, *declared), metres=rng.uniform(0.03, 0.1), newtons=rng.uniform(30.0, 100.0)
        )
    return Base(name, machine, (inertia, *declared), also=MEMORY if name == "coulomb" else ())


def two_mass(rng, name: str, count: float) -> Base:
    """Motor and load, both seen at the output, with a joint between."""
    axis = Axis(
        around(rng, 0.0021, 0.2), around(rng, 0.0105, 0.2), around(rng, 0.12, 0.2), around(rng, 600.0, 0.3),
        load_inertia=around(rng, 0.0026, 0.2), load_viscous=around(rng, 0.004, 0.2), k2=around(rng, 320.0, 0.2),
        c2=around(rng, 0.03, 0.3), h2=around(rng, 0.09, 0.2), rate2=around(rng, 2600.0, 0.3), count=count,
    )  # fmt: skip
    declared = [
        Declared("inertia", "motor", (INERTIA,)),
        Declared("inertia", "load", (Stated("inertia", "F*s^2/x", "load_inertia", True),)),
        Declared("viscous_friction", "motor", VISCOUS.parameters),
        Declared("viscous_friction", "load", (Stated("viscous", "F*s/x", "load_viscous"),)),
        Declared("presliding_hysteresis", "motor", PRESLIDING.parameters),
        Declared("linear_stiffness", "joint", (Stated("stiffness", "F/x", "k2"),)),
        Declared("presliding_hysteresis", "joint", (Stated("h0", "F", "h2"), Stated("a", "1/x", "rate2"))),
        Declared("linear_damping", "joint", (Stated("damping", "F*s/x", "c2"),)),
    ]
    if name == "elastic":
        axis = axis._replace(h2=0.0, k2=1.5 * axis.k2)
        del declared[-2]
    if name == "undamped":
        axis = axis._replace(c2=0.0)
        del declared[-1]
    return Base(name, Machine(axis, {}), tuple(declared))


def based(rng, name: str, count: float) -> Base:
    return two_mass(rng, name, count) if name in TWO_MASS else one_mass(rng, name, count)


def declaration(
    base: Base, guess: dict[Target, float], title: str, records: Sequence[Planned], starts: Sequence[float],
    locked: Sequence[bool], counts: tuple[float, float], band: float,
) -> str:  # fmt: skip
    """The text of campaign.toml. guess: what is said of each target, in the rig's units. counts: encoder, load encoder."""
    two, drive = base.machine.two, "torque" if base.rotary else "force"
    x = base.metres or 1.0
    kind, limit = ("two mass" if two else "one mass"), LIMIT * base.newtons
    said = [
        f'title = "{title}"',
        f'plant = "{kind}"',
        f'evaluation_bandwidth = {{ value = {band:g}, unit = "Hz" }}',
        'initial_condition = "every record starts at rest with relaxed friction"',
    ]
    said.append(f'actuator_limit = {{ value = {limit:.6g}, unit = "{"N*m" if base.rotary else "N"}" }}')
    if base.rotary:
        said += ["", "[geometry]", f"gear_ratio = {base.ratio:g}", f"pole_pairs = {base.pole_pairs}"]
    said += ["", "[channels.time]", 'column = "time_s"', 'unit = "s"']
    said += ["", f"[channels.{drive}]", f'column = "{drive}"', f'unit = "{"N*m" if base.rotary else "N"}"']
    for channel, count in zip(("position", "load_position")[: 1 + two], counts, strict=False):
        unit = "rad" if base.rotary else "m"
        said += [
            "",
            f"[channels.{channel}]",
            f'column = "{channel}"',
            f'unit = "{unit}"',
            f"resolution = {count * x:.10g}",
        ]
    for e in base.declared:
        said += ["", "[[effects]]", f'effect = "{e.effect}"', f'at = "{e.at}"']
        for s in e.parameters:
            factor, unit = base.outside(s.unit)
            value, fixed = guess[s.target] * factor, str(s.fixed).lower()
            said.append(f'parameters.{s.key} = {{ value = {value:.4g}, unit = "{unit}", fixed = {fixed} }}')
    for r, start, held in zip(records, starts, locked, strict=True):
        said += ["", "[[records]]", f'file = "{r.name}.csv"', f'role = "{r.role}"', f'motion = "{r.motion}"']
        said.append(f"start_time_s = {start}")
        if two:
            said.append(f"load_locked = {str(held).lower()}")
    return "\n".join(said) + "\n"
