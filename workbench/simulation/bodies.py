"""Forward dynamics: one residual a body, 0 = sum of forces(q, v, a) - u', solved for its own acceleration.

The same effects, in the same order, as when measured motion is explained: command maps, angle maps of the joint, forces
with memory (they provide `dir`), the other forces, those that follow the load (`plant.carried`). Then
a = (u' - forces at a = 0)/mass, with the mass the derivative of the forces with respect to a, and v <- v + a h, q <- q + v h (semi-implicit Euler; both bodies' v before either q).

Two masses: the motor (q, v) is driven, the load (load.q, load.v) is not, and may be held. The joint's torque follows from
the effective deflection x(motor position, load position), and enters each body by x's derivative with respect to its position.
"""

from collections.abc import Collection, Iterable, Mapping

import casadi as ca

from workbench import definition as fx
from workbench.definition import Effect
from workbench.effects.elementary import clip
from workbench.errors import WorkbenchError
from workbench.plant import ONE_MASS, TWO_MASS, carried, reads_load
from workbench.simulation.dynamics import (
    DIRECTION,
    Symbols,
    angle_maps,
    call,
    command_maps,
    fixed_signals,
    is_friction,
    ordered,
)

KINKED = 3  # Newton's steps to an acceleration on which friction depends: one a side of the kink, and one to come there
SOFT = 0.02  # share of the speed limit over which the accelerating torque falls to zero
BODIES = {ONE_MASS: {"axis": ""}, TWO_MASS: {"motor": "", "load": "load."}}  # place -> before the names of its rows
LAST = "joint.before"  # the effective deflection one substep ago
OUTPUT = {ONE_MASS: "q", TWO_MASS: "load.q"}  # what a target is about


def substep(kind: str, effects: tuple[Effect, ...], symbols: Symbols, *, speed_limited: bool, noisy: bool):
    """Return (name -> next value of every state that one substep moves, name -> mass of each body).

    Reads the rows q, v, u (the command), noise; constants h, limit, speed_slope, and the scenario's factors.
    """
    h = symbols.constant("h")
    u, after = _drive(effects, symbols, speed_limited=speed_limited)
    common = fixed_signals(symbols) | {"dt": h}
    lever, torque, inertial = {}, None, ca.SX(0)
    if kind == TWO_MASS:
        moved, torque, drawn, lever = joint(effects, common, symbols)
        after |= moved
    masses, bodies = {}, BODIES[kind]
    for place, prefix in bodies.items():
        q, v, a = symbols.state(f"{prefix}q"), symbols.state(f"{prefix}v"), ca.SX.sym("a")
        signals = common | {"q": q, "v": v, "a": a, "dq": v * h}
        moved, parts, signals = _forces(effects, place, signals, symbols)
        total = _summed(effects, parts)
        if lever:
            total += lever[place] * torque
        mass, rest = _affine(total, a, "plant" if kind == ONE_MASS else place)
        mass = symbols.constant("inertia") * mass
        driven, outer = place != "load", place != "motor"
        push = (u + symbols.state("noise") if noisy else u) if driven else ca.SX(0)
        if outer:
            mass, rest = mass + symbols.constant("load_inertia"), rest + symbols.constant("load")
        if kind == ONE_MASS:
            drawn, inertial = _load_of(effects, place, parts, mass, a, symbols)
        load = {"tau": drawn, "tau_inertia": inertial}
        more, follows = _following(effects, place, signals | load, symbols)
        moved |= more
        acceleration = _accelerated(a, push, rest, mass, follows, prefix, symbols)
        v_after = v + acceleration * h
        after |= {f"{prefix}q": q + v_after * h, f"{prefix}v": v_after}
        after |= {n: ca.substitute(x, a, acceleration) for n, x in moved.items()}
        masses[f"{prefix}mass"] = mass
    return after, masses


def _load_of(
    effects: tuple[Effect, ...], place: str, parts: Mapping[str, ca.SX], mass: ca.SX, a: ca.SX, symbols: Symbols
):
    """Return (tau, tau_inertia) of one mass, a scenario's load and inertias with them: see `plant.carried`."""
    still, moving = (_summed(effects, parts, part) for part in carried(ONE_MASS, place, effects))
    return still + symbols.constant("load"), moving + (mass - ca.jacobian(moving, a)) * a


def _accelerated(
    a: ca.SX, push: ca.SX, rest: ca.SX, mass: ca.SX, follows: ca.SX, prefix: str, symbols: Symbols
) -> ca.SX:
    """Return the acceleration of a body: mass a + rest + follows(a) = push. follows: what friction by load adds."""
    implicit = ca.depends_on(follows, a)
    left = push - rest if implicit else push - (rest + follows)
    free = 1.0 if prefix == "" else 1.0 - symbols.constant("locked")
    # A mass that is the same in every step is divided by once a run, outside the loop.
    if ca.depends_on(mass, ca.vertcat(*symbols.states.values(), *symbols.clocks.values())):
        acceleration = left / mass
        acceleration = acceleration if prefix == "" else acceleration * free
    else:
        acceleration = left * symbols.constant(f"{prefix}per_mass")
    if not implicit:
        return acceleration
    return _balanced(mass * a + follows - left, a, acceleration) * free


def _drive(effects: tuple[Effect, ...], symbols: Symbols, *, speed_limited: bool) -> tuple[ca.SX, dict[str, ca.SX]]:
    """Return (what acts on the driven body, name -> next state of the command maps)."""
    q, v, u = (symbols.state(n) for n in ("q", "v", "u"))
    after: dict[str, ca.SX] = {}
    signals = fixed_signals(symbols) | {"q": q, "v": v, "dt": symbols.constant("h"), "u": u}
    for e in command_maps(effects):
        moved, u, _ = call(e, signals, symbols)
        after |= moved
        signals = signals | {"u": u}
    limit = symbols.constant("limit")
    u = clip(u, -limit, limit) if command_maps(effects) else u  # the controller's command obeys the limit already
    return _limited_by_speed(u, v, symbols.constant("speed_slope")) if speed_limited else u, after


def _forces(effects: tuple[Effect, ...], place: str, signals: Mapping[str, ca.SX], symbols: Symbols):
    """Return (name -> next state, key -> force, signals with what these provide) at a place, of what follows no load."""
    after: dict[str, ca.SX] = {}
    outputs, signals = {}, dict(signals)
    for e in ordered([e for e in effects if e.port == fx.FORCE and e.at == place and not reads_load(e)]):
        moved, output, provided = call(e, signals, symbols)
        after |= moved
        signals |= provided
        if e.name != DIRECTION:
            outputs[e.key] = symbols.constant("friction") * output if is_friction(e) else output
    return after, outputs, signals


def _summed(effects: Iterable[Effect], outputs: Mapping[str, ca.SX], only: Collection[Effect] | None = None) -> ca.SX:
    """Return the sum of forces in the plant's order, whatever the order of evaluation. only: these."""
    keys = {e.key for e in (effects if only is None else only)}
    return sum((outputs[e.key] for e in effects if e.key in outputs and e.key in keys), ca.SX(0))


def _following(effects: tuple[Effect, ...], place: str, signals: Mapping[str, ca.SX], symbols: Symbols):
    """Return (name -> next state, sum) of the forces at a place that follow the load."""
    after: dict[str, ca.SX] = {}
    total = ca.SX(0)
    for e in effects:
        if reads_load(e) and e.at == place:
            moved, output, _ = call(e, signals, symbols)
            after |= moved
            total += symbols.constant("friction") * output if is_friction(e) else output
    return after, total


def _balanced(residual: ca.SX, a: ca.SX, start: ca.SX) -> ca.SX:
    """Return the acceleration at which a residual is zero: Newton's steps, exact where it is straight but for one kink."""
    slope = ca.jacobian(residual, a)
    for _ in range(KINKED):
        value, rate = ca.substitute([residual, slope], [a], [start])
        start = start - value / rate
    return start


def deflection(effects: tuple[Effect, ...], symbols: Symbols) -> tuple[dict[str, ca.SX], ca.SX, dict[str, ca.SX]]:
    """Return (name -> next state, effective deflection, place -> lever): motor less load, through the angle maps.

    As in identification: what a map adds where both positions are zero is taken off, for there the joint is relaxed; and
    only what a map draws from a body's own position changes by what the joint's torque enters that body's balance.
    """
    motor, load = symbols.state("q"), symbols.state("load.q")
    signals = fixed_signals(symbols) | {"dt": symbols.constant("h")}
    free = {n: ca.SX.sym(n) for n in ("q", "motor_q", "load_q")}
    after: dict[str, ca.SX] = {}
    x = motor - load
    lever = {"motor": ca.SX(1.0), "load": ca.SX(-1.0)}
    for e in angle_maps(effects):
        at_zero = call(e, signals | dict.fromkeys(free, ca.SX(0.0)), symbols)[1]
        moved, out, _ = call(e, signals | free, symbols)
        found = [*moved.values(), out - at_zero, ca.jacobian(out, free["motor_q"]), ca.jacobian(out, free["load_q"])]
        *states, x, by_motor, by_load = ca.substitute(found, list(free.values()), [x, motor, load])
        lever = {"motor": lever["motor"] + ca.densify(by_motor), "load": lever["load"] + ca.densify(by_load)}
        after |= dict(zip(moved, states, strict=True))
    return after, x, lever


def joint(effects: tuple[Effect, ...], common: Mapping[str, ca.SX], symbols: Symbols):
    """Return (name -> next state, torque of the joint, what of it follows no load, place -> by what it enters that body)."""
    after, x, lever = deflection(effects, symbols)
    slope = {p: ca.densify(ca.jacobian(x, symbols.state(f"{prefix}q"))) for p, prefix in BODIES[TWO_MASS].items()}
    v = slope["motor"] * symbols.state("v") + slope["load"] * symbols.state("load.v")
    # Increments from positions, which a gap's edge or a gear's error cannot let drift from the deflection itself.
    signals = {**common, "q": x, "v": v, "dq": x - symbols.state(LAST)}
    moved, parts, signals = _forces(effects, "joint", signals, symbols)
    drawn = _summed(effects, parts)
    more, follows = _following(effects, "joint", signals | {"tau": drawn, "tau_inertia": ca.SX(0)}, symbols)
    return after | moved | more | {LAST: x}, drawn + follows, drawn, lever


def _affine(total: ca.SX, a: ca.SX, body: str) -> tuple[ca.SX, ca.SX]:
    """Return (mass, rest) of total = mass a + rest; WorkbenchError where it is not affine in a, or has no mass."""
    mass = ca.jacobian(total, a)
    if ca.depends_on(mass, a):
        raise WorkbenchError(f"the {body}'s forces are not affine in acceleration, so they cannot be solved for it.")
    if not ca.depends_on(total, a):
        where = "" if body == "plant" else f" at the {body}"
        raise WorkbenchError(
            f"the {body} has no inertia, so a torque has no acceleration; add the effect 'inertia'{where}."
        )
    return ca.densify(mass), ca.substitute(total, a, ca.SX(0))


def _limited_by_speed(u: ca.SX, v: ca.SX, slope: ca.SX) -> ca.SX:
    """Return u with the part that accelerates reduced to zero over the last SOFT of the speed limit; slope = 1/(SOFT limit)."""
    forward = clip(1.0 / SOFT - v * slope, 0.0, 1.0)
    backward = clip(1.0 / SOFT + v * slope, 0.0, 1.0)
    return ca.fmax(u, 0.0) * forward + ca.fmin(u, 0.0) * backward
