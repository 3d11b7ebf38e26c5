"""Families of models on the carried records: one part of the model is exchanged, the rest is fitted anew, and what a review says
of each becomes a verdict with the numbers of these records in it."""

import numpy as np

from workbench.definition import find
from workbench.effects.fading import fading_memory
from workbench.effects.hysteresis import maxwell_slip
from workbench.identification.fit import identify
from workbench.inverse.balances import balances
from workbench.report.numbers import percent, plus_minus

from .saying import CARRIED, EQUAL, NOTHING, Statement, better, verdict

SLIPS = tuple(np.geomspace(2e-5, 4e-3, 12))  # rad, of a Maxwell bank with stiffnesses from the data
LOCKED = "id_locked"
JOINT, MOTOR = "presliding_hysteresis@joint", "presliding_hysteresis@motor"
# Statements that an effect is there, or takes its toll: records that do not hold it cannot speak against them.
PRESENCE = (
    "Trigonometric kinematic error: what it ignores",
    "Kinematic error grows",
    "Friction falls with speed",
    "Friction is periodic",
    "Multi-body compliance",
)


def load_error(inverses, plant, role: str) -> float:
    """Return what the load's balance leaves over the drive, both rms behind the filter, where the load is free."""
    left = power = 0.0
    for p in (p for p in inverses if p.motion.record.role == role and not p.motion.record.locked):
        keep, f = p.motion.keep, p.motion.filter
        left += float(np.sum(f(balances(p, plant)[1])[keep] ** 2))
        power += float(np.sum(f(p.motion.u)[keep] ** 2))
    return float(np.sqrt(left / power))


def families(base) -> dict[str, dict]:
    """Return family -> model -> plant; the base itself under the name that it has in each family."""
    soft = base.without("linear_stiffness").without("cubic_stiffness")
    smooth, sliding = base.without(JOINT), base.without(MOTOR)
    k, h = base["linear_stiffness"].parameters["stiffness"].value, base[JOINT].parameters["h0"].value
    x0 = base[JOINT].parameters["x0"].value
    h_m, x_m = (base[MOTOR].parameters[n].value for n in ("h0", "x0"))
    # the split between flexspline and wave generator is held: searched, it takes minutes and is hardly determined
    body = find("multi_body_compliance")(x_w=1e-4, c=1.0, fixed=True)(torque=2.6, x_f=2.6 / k, fixed=False)
    three = {f"h_{i}": h / 3 for i in (1, 2, 3)} | {f"x0_{i}": x0 * s for i, s in ((1, 0.3), (2, 1.0), (3, 3.0))}
    lugre = sliding + find("lugre_friction")(at="motor", sigma0=h_m / x_m, x0=x_m, ratio=0.1, speed=0.3)
    return {
        "stiffness": {
            "linear": base.without("cubic_stiffness"),
            "piecewise linear": soft + find("piecewise_stiffness")(k1=k, k2=0.2 * k, threshold=2e-3),
            "linear and cubic": base,
            "multi-body compliance": soft + body,
        },
        "hysteresis": {
            "none": smooth,
            "Maxwell slip, exponential virgin curve": base,
            "Maxwell slip, 12 springs from the data": smooth + maxwell_slip(SLIPS)(at="joint"),
            "fading memory (Dahl)": smooth + fading_memory(1)(at="joint", h=h, x0=x0),
            "three fading exponentials": smooth + fading_memory(3)(at="joint", **three),
            "structural damping": smooth + find("structural_damping"),
            "hyperbolic friction": smooth + find("hyperbolic_friction"),
        },
        "friction": {
            "Coulomb and viscous": sliding + find("coulomb_friction")(at="motor"),
            "presliding hysteresis": base,
            "presliding and Stribeck": base + find("stribeck_friction")(at="motor", speed=0.3),
            "LuGre": lugre,
            "LuGre and cyclic": lugre + find("cyclic_friction")(at="motor", order=2 * base.geometry.gear_ratio),
        },
        "kinematic error": {"none": base.without("kinematic_error"), "trigonometric, one wave": base},
    }


def amplitude_of(base, one) -> tuple[float, float]:
    """Return (amplitude, half its interval) in rad of the kinematic error in one record, all else held at the base."""
    held = base
    for e in base.effects:
        free = ("sine", "cosine") if e.name == "kinematic_error" else ()
        held = held.swap(e(fixed=True, **{n: p.value for n, p in e.parameters.items()}).free(*free))
    found = next(e for e in identify(held, [one]).estimates if e.parameter == "amplitude")
    return found.value, (found.high - found.low) / 2


def statements(fits, loads, base, floor, amplitudes, hardening) -> list[Statement]:
    """Return what the carried records say. Where the base leaves no more than NOTHING times what noise and encoders leave, they
    hold none of what its statements of PRESENCE are about."""
    held = base.validation > NOTHING * floor
    return [
        Statement(said, CARRIED, verdict(holds, held or not said.startswith(PRESENCE)), numbers)
        for said, holds, numbers in _judged(fits, loads, base, floor, amplitudes, hardening)
    ]


def _judged(fits, loads, base, floor, amplitudes, hardening) -> list[tuple[str, bool, str]]:
    """Return (what is said, whether the rule on validation errors bears it out, the numbers)."""

    def error(family, model):
        return fits[family, model].validation

    def worse(family, model, least=EQUAL):
        return error(family, model) > (1 + least) * base.validation

    def against(family, model, own):
        return f"{percent(error(family, model))} on validation with it, {percent(base.validation)} with {own}."

    (slow, s_slow), (fast, s_fast) = amplitudes["id_slow_sine"], amplitudes["id_staircase"]
    faster = fast - slow > 2 * np.hypot(s_slow, s_fast)
    none, wave = error("kinematic error", "none"), base.validation
    order = next(e for e in base.estimates if (e.effect, e.parameter) == ("kinematic_error", "order"))
    loop = [fits["hysteresis", m].nrmse[LOCKED] for m in ("none", "Maxwell slip, exponential virgin curve")]
    maxwell, fading = "the exponential Maxwell bank", "fading memory (Dahl)"
    springs, body = "Maxwell slip, 12 springs from the data", "multi-body compliance"
    soft, stiff = hardening
    balance = [loads["kinematic error", m] for m in ("none", "trigonometric, one wave")]
    presliding = "presliding hysteresis"
    return [
        ("Trigonometric kinematic error: easily identified, dominant at two waves a turn", abs(order.value - 2 * base.plant.geometry.gear_ratio) < 0.1,
         f"order {plus_minus(order.value, (order.high - order.low) / 2)}; validation falls from {percent(none)} to {percent(wave)}."),
        ("Trigonometric kinematic error: what it ignores limits accuracy", wave > 1.5 * floor,
         f"it leaves {wave / floor:.2f} times what encoders and torque noise alone leave."),
        ("Lagrangian: an error inside the compliant joint describes motor and load together", balance[1] < 0.5 * balance[0],
         f"the load's balance leaves {percent(balance[0])} without and {percent(balance[1])} with it."),
        ("Kinematic error grows with speed", faster,
         f"its amplitude is {1e6 * slow:.1f} ± {1e6 * s_slow:.1f} µrad in the slow sine and {1e6 * fast:.1f} ± "
         f"{1e6 * s_fast:.1f} µrad in the velocity staircase."),
        ("Static Coulomb and viscous friction is too simple", worse("friction", "Coulomb and viscous"),
         against("friction", "Coulomb and viscous", presliding)),
        ("LuGre misrepresents the hysteresis", worse("friction", "LuGre"), against("friction", "LuGre", presliding)),
        ("Friction falls with speed before it rises (Stribeck)",
         better(error("friction", "presliding and Stribeck"), wave),
         against("friction", "presliding and Stribeck", "presliding alone")),
        ("Friction is periodic in the motor's turn", better(error("friction", "LuGre and cyclic"), error("friction", "LuGre")),
         f"LuGre leaves {percent(error('friction', 'LuGre'))}, with a cyclic part {percent(error('friction', 'LuGre and cyclic'))}."),
        ("Stiffness hardens with torque", worse("stiffness", "linear"),
         f"from {soft:.0f} to {stiff:.0f} N·m/rad at the largest torque of the locked record; a linear joint leaves "
         f"{percent(error('stiffness', 'linear'))}, the cubic one {percent(wave)}."),
        ("Piecewise linear: its kinks cost accuracy", worse("stiffness", "piecewise linear"),
         against("stiffness", "piecewise linear", "the smooth cubic")),
        ("Cubic polynomial: cannot describe the hysteresis of both directions", loop[0] > (1 + EQUAL) * loop[1],
         f"alone it leaves {percent(loop[0])} of the locked record, with Maxwell slip {percent(loop[1])}."),
        ("Multi-body compliance: the wave generator's share describes what a polynomial does not",
         better(error("stiffness", body), wave), against("stiffness", body, "the cubic")),
        ("Memory model: few parameters, but fading does not fit", worse("hysteresis", fading),
         against("hysteresis", fading, maxwell)),
        ("Maxwell: presliding hysteresis without decay is accurate",
         wave <= (1 + EQUAL) * min(f.validation for (g, _), f in fits.items() if g == "hysteresis"),
         f"{percent(wave)}, the best of its family {percent(min(f.validation for (g, _), f in fits.items() if g == 'hysteresis'))}."),
        ("Maxwell: a bank with free stiffnesses is hard to identify", worse("hysteresis", springs),
         f"12 springs by one bounded least squares leave {percent(error('hysteresis', springs))}, a bank tied to a curve of two "
         f"parameters {percent(wave)}."),
    ]  # fmt: skip
