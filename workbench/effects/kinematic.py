"""Errors of the angle itself: the gear's kinematic error, and an encoder disc off its axis."""

from math import atan2, hypot

from workbench.border import Border
from workbench.definition import ANGLE, SENSOR, Effect, effect
from workbench.effects.elementary import cos, sin
from workbench.effects.periodic import ORDER
from workbench.parameter import Parameter

PHASE = Parameter(0.0, "rad", "phase")


def _border(*rest: str) -> Border:
    """Amplitude and phase outside, A sin(angle + phase); sine and cosine amplitudes inside; `rest` unchanged."""
    others = {"order": ORDER, "turns": TURNS, "zero": ZERO}
    outside = {"amplitude": Parameter(0.0, "x", "amplitude of the error", lower=0.0), "phase": PHASE}

    def inward(o):
        a, phase = o["amplitude"], o["phase"]
        return {"sine": a * cos(phase), "cosine": a * sin(phase)} | {n: o[n] for n in rest}

    def outward(i):
        s, c = i["sine"], i["cosine"]
        return {"amplitude": hypot(s, c), "phase": atan2(c, s)} | {n: i[n] for n in rest}

    return Border(parameters=outside | {n: others[n] for n in rest}, inward=inward, outward=outward, linear=())


ZERO = Parameter(0.0, "x", "by how much one encoder's zero is off where the joint is relaxed", scale="number")
TURNS = Parameter(1.0, "1", "turns of the encoder per turn of the output", lower=1e-9, fixed=True, scale="number")
AMPLITUDES = {
    "sine": Parameter(0.0, "x", "sine amplitude of the error"),
    "cosine": Parameter(0.0, "x", "cosine amplitude of the error"),
}


@effect
def kinematic_error() -> Effect:
    """x_eff = x + A sin(k q_m + p): what a gear adds to the angle, k per radian of motor position seen at the output.

    At a joint, x is the deflection (motor less load, all positions output-side) and x_eff what the joint's forces see; the
    plant multiplies the joint torque by the map's partial derivatives, so power balances. On one mass, where the encoder
    is on the far side of the gear, x is the position and x_eff its reading. Two waves per turn of the wave generator are
    k = 2 ratio.
    """

    def step(s, z, p):
        angle = p.order * s.motor_q
        return {}, s.q + (p.sine * sin(angle) + p.cosine * cos(angle)) - p.zero

    return Effect(
        name="kinematic_error",
        cause="tooth and wave-generator errors of the gear: the output leads and lags, periodic in the motor's turn",
        formula="x_eff = x + A sin(k q_m + p) - x0",
        source="Tuttle and Seering 1996; Ghorbel, Gandhi, Alpeter 2001",
        port=ANGLE,
        family="angle over angle",
        reduces={"order": (1.0, "encoder_eccentricity")},
        parameters=AMPLITUDES | {"order": ORDER, "zero": ZERO},
        free_at={"zero": ("joint",)},
        reads=("q", "motor_q"),
        step=step,
        places=("joint", "sensor"),
        at="joint",
        border=_border("order", "zero"),
    )


@effect
def encoder_eccentricity() -> Effect:
    """y = q + A sin(n q + p), n the turns of the encoder per turn of the output: once per turn of its disc, and its harmonics."""

    def step(s, z, p):
        angle = p.turns * s.q
        return {}, s.q + (p.sine * sin(angle) + p.cosine * cos(angle)) - p.zero

    return Effect(
        name="encoder_eccentricity",
        cause="an encoder disc off its axis, or a resolver's uneven windings: the reading errs by what repeats every turn",
        formula="y = q + A sin(n q + p) - x0",
        source="geometry of a disc read at one place",
        port=SENSOR,
        family="angle over angle",
        parameters=AMPLITUDES | {"turns": TURNS, "zero": ZERO},
        free_at={"zero": ("sensor.load_position",)},
        harmonic="turns",
        reads=("q",),
        step=step,
        places=("sensor",),
        motions=("rotary",),
        at="sensor.position",
        border=_border("turns", "zero"),
    )
