"""What a compensation does in one sample, in SX: signals of each side, forces, what shapes them, and angle maps undone."""

from collections.abc import Mapping

import casadi as ca
import numpy as np

from workbench.compensation.compensator import READ, REFERENCE
from workbench.compensation.structure import PREFIX, Structure, names
from workbench.definition import ANGLE, Effect, namespace
from workbench.effects.direction import CONTACT, DIRECTION
from workbench.effects.elementary import clip, expm1, maximum
from workbench.kernel.step import apply

LEAST = 1e-12  # width of a direction where a position is not quantised, as in a simulation
SOLVED = 8  # fixed-point steps of an angle map's inverse: the slope of a gear's error is below a tenth, so 1e-8 is left


def parameters(i: int, e: Effect, p, width=None):
    """Return the (derived) parameters of effect i as its step sees them."""
    given = {n: getattr(p, name) for n, name in zip(e.parameters, names(i, e), strict=True)}
    if width is not None and (e.name == DIRECTION or CONTACT in e.states):
        given["width"] = width
    inside = namespace(**given)
    return e.derive(inside) if e.derive else inside


def asked(s: Structure, signals, p):
    """Return the law's signals with the reference at which every angle map reads what is asked for."""
    if not s.maps:
        return signals
    r = signals.r
    for i, e in enumerate(s.maps, len(s.order)):
        constants = {"ratio": getattr(p, f"{PREFIX}_ratio"), "pole_pairs": getattr(p, f"{PREFIX}_pole_pairs")}

        def value(x, motor, load, i=i, e=e, constants=constants):
            given = constants | {"q": x, "motor_q": motor, "load_q": load}
            return apply(e, {n: given[n] for n in e.reads}, ca.SX(0, 1), parameters(i, e, p))[1]

        def mapped(x, motor, load, value=value):  # what a map reads at zero is taken off, as in a simulation
            nothing = ca.SX(0)
            return value(x, motor, load) - value(nothing, nothing, nothing)

        if (
            e.port == ANGLE
        ):  # the motor's position at which the joint is not wound up with the load where it is asked for
            motor = r
            for _ in range(SOLVED):
                motor = motor - mapped(motor - r, motor, r)
            r = motor
        else:  # the reading of the position that is asked for
            r = mapped(r, r, r)
    r = signals.r + getattr(p, f"{PREFIX}_gain") * (r - signals.r)
    return namespace(**{**vars(signals), "r": r, "e": r - signals.y})


def forces(s: Structure, signals, z, p, u) -> tuple[dict, ca.SX]:
    """Return (next states, force that cancels) of one sample. u: the law's own command."""
    after, total = {}, ca.SX(0)
    for side in s.sides:
        moved, given = _moving(s, side, signals, z, p, u)
        following, force = acted(s, side, given, z, p, signals.count)
        after |= moved | following
        total = total + force
    shaped, total = late(s, signals, z, p, total)
    limited = clip(u + total, -signals.limit, signals.limit)
    clock = {f"{PREFIX}_clock": _z_of(z, "clock") + signals.dt, f"{PREFIX}_whole": limited}
    return after | shaped | clock, total


def acted(s: Structure, side: str, given: dict, z, p, count, known: Mapping | None = None) -> tuple[dict, ca.SX]:
    """Return (next states, force) of the effects of one side on its signals.

    known: key -> function of the signals that stands for an effect, such as a table of it.
    """
    after, total = {}, ca.SX(0)
    width = maximum(2.0 * count, LEAST)
    for i, e in enumerate(s.order):
        if e.at != side:
            continue
        if known and e.key in known:
            total = total + known[e.key](given)
            continue
        own = [f"{PREFIX}_{i}_{n}_{k}" for n, m in e.states.items() for k in range(m)]
        before = ca.vertcat(*(getattr(z, n) for n in own), ca.SX(0, 1))
        following, output, provided = apply(e, {n: given[n] for n in e.reads}, before, parameters(i, e, p, width))
        given |= provided
        after |= {n: following[k] for k, n in enumerate(own)}
        total = total + output if e.key not in s.silent else total
    return after, total


def _z_of(z, name: str):
    return getattr(z, f"{PREFIX}_{name}")


def _moving(s: Structure, side: str, signals, z, p, u) -> tuple[dict, dict]:
    """Return (next states, signals) of one side's position: as read, as asked for, or as observed."""
    before, speed = _z_of(z, f"at_{side}"), _z_of(z, f"speed_{side}")
    more: dict = {}
    if s.source == REFERENCE:
        at, held = signals.r, signals.r
        v = (at - before) / signals.dt
    elif s.source == READ:
        at = getattr(signals, f"{side}_y", signals.y)
        v = getattr(signals, f"{side}_vh", signals.vh)
        # increments behind a dead band one count wide, as in identification: an encoder that flickers does not rub
        held = clip(before, at - 0.5 * signals.count, at + 0.5 * signals.count)
    else:
        at, v = _observed(signals, z, p, u, before)
        held, more = at, {f"{PREFIX}_speed_seen": v}
    fixed = {n: getattr(p, f"{PREFIX}_{n}") for n in ("ratio", "pole_pairs")}
    given = fixed | {
        "q": at, "dq": held - before, "v": v, "a": (v - speed) / signals.dt, "dt": signals.dt, "t": _z_of(z, "clock"),
        # of the sample before: what acts includes what is asked for here
        "u": _z_of(z, "whole"), "motor_q": at, "load_q": at, "locked": ca.SX(0),
    }  # fmt: skip
    first = len(s.order) + len(s.maps)
    given["tau"] = _carrying(s.still, first, given, p)
    given["tau_inertia"] = ca.SX(0) if s.source == READ else _carrying(s.inertial, first + len(s.still), given, p)
    return {f"{PREFIX}_at_{side}": held, f"{PREFIX}_speed_{side}": v} | more, given


def _carrying(effects: tuple[Effect, ...], first: int, given: dict, p) -> ca.SX:
    """Return the sum of forces without memory, whose parameters are named from `first` on."""
    total = ca.SX(0)
    for i, e in enumerate(effects, first):
        total = total + apply(e, {n: given[n] for n in e.reads}, ca.SX(0, 1), parameters(i, e, p))[1]
    return total


def _observed(signals, z, p, u, before):
    """Return (position, speed) of the observer of this sample: semi-implicit Euler, both poles at its bandwidth.

    The law's own command drives it: what the compensation adds is what friction takes.
    """
    w = 2.0 * np.pi * getattr(p, f"{PREFIX}_bandwidth")
    e = signals.y - before
    v = _z_of(z, "speed_seen") + signals.dt * (u / getattr(p, f"{PREFIX}_mass") + w * w * e)
    return before + signals.dt * (v + 2.0 * w * e), v


def late(s: Structure, signals, z, p, total) -> tuple[dict, ca.SX]:
    """Return (next states, force) behind gain, low pass and delay."""
    after = {}
    total = getattr(p, f"{PREFIX}_gain") * total
    if s.smooth:
        rate = -expm1(-2.0 * np.pi * getattr(p, f"{PREFIX}_cut") * signals.dt)
        total = _z_of(z, "smooth") + rate * (total - _z_of(z, "smooth"))
        after[f"{PREFIX}_smooth"] = total
    if s.delay:
        line = [_z_of(z, f"late_{k}") for k in range(s.delay)]
        after |= {f"{PREFIX}_late_{k}": v for k, v in enumerate((total, *line[:-1]))}
        total = line[-1]
    return after, total
