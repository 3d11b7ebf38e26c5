"""What may be missing of a bench's declared model: causes of the catalogue's classes, and others; and where each may be."""

from collections.abc import Callable

from rig.bench import moving, outside, rubbing
from rig.bench.machines import Stand

ONE, TWO = "one", "two"

CAUSES: dict[str, tuple[Callable, tuple[str, ...]]] = {
    "stribeck_friction": (rubbing.stribeck, (ONE, TWO)), "nonlinear_viscous_friction": (rubbing.nonlinear_viscous, (ONE, TWO)),
    "coulomb_asymmetry": (rubbing.asymmetry, (ONE, TWO)), "load_dependent_friction": (rubbing.loaded, (ONE, TWO)), "friction_drift": (rubbing.drift, (ONE, TWO)),
    "cyclic_friction": (rubbing.cyclic, (ONE,)), "presliding_hysteresis": (rubbing.presliding, (ONE, TWO)), "fading_memory": (rubbing.fading, (ONE,)),
    "cogging": (moving.cogging, (ONE, TWO)), "cable_spring": (moving.cable, (ONE, TWO)), "gravity": (moving.gravity, (ONE, TWO)),
    "constant_offset": (moving.offset, (ONE, TWO)), "creep": (moving.creep, (ONE,)), "flexible_mode": (moving.mode, (ONE,)),
    "backlash": (moving.backlash, (ONE, TWO)), "cubic_stiffness": (moving.cubic, (TWO,)), "transport_delay": (moving.delay, (ONE, TWO)),
    "actuator_lag": (moving.lag, (ONE, TWO)), "torque_constant_saturation": (moving.saturation, (ONE, TWO)), "sensor_trend": (moving.trend, (ONE, TWO)),
    "kinematic_error": (moving.kinematic, (ONE, TWO)), "encoder_eccentricity": (moving.eccentric, (ONE, TWO)), "clock_skew": (moving.skew, (TWO,)),
    "inertia": (moving.wrong, (ONE, TWO)),
}  # fmt: skip
OUTSIDE: dict[str, tuple[Callable, tuple[str, ...]]] = {
    "floor vibration": (outside.shaken, (ONE, TWO)), "wandering friction": (outside.wandering, (ONE, TWO)), "window": (outside.windowed, (ONE, TWO)),
    "cushion": (outside.cushion, (ONE,)), "slips": (outside.slips, (ONE, TWO)), "lost packets": (outside.packets, (TWO,)),
    "uneven joint": (outside.uneven, (TWO,)),
}  # fmt: skip


def possible(name: str, s: Stand) -> bool:
    """Whether this may be missing of the machine: of its masses, and not declared already."""
    masses = (CAUSES.get(name) or OUTSIDE[name])[1]
    if (TWO if s.machine.two else ONE) not in masses:
        return False
    effects = {(d.effect, d.at) for d in s.declared}
    if name in ("gravity", "encoder_eccentricity") and s.linear:
        return False
    taken = {("linear_stiffness", "axis")} if name == "cable_spring" else {(name, "axis")}
    if name == "presliding_hysteresis":
        return s.coulomb
    if name == "backlash" and not s.machine.two:
        return not s.coulomb  # behind a gap, what gives way within a count is a gap alone
    return name == "inertia" or not taken & effects
