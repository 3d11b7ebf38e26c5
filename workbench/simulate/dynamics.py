"""Forward dynamics of a one-mass plant: its one residual, 0 = sum of forces(q, v, a) - u', solved for a.

The same effects, in the same order, as when measured motion is explained: command maps, forces with memory (they provide
`dir`), the other forces. Then a = (u' - forces at a = 0)/mass, with the mass the derivative of the forces with respect
to a, and v <- v + a h, q <- q + v h (semi-implicit Euler).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from workbench import effect as fx
from workbench.effect import Effect, namespace
from workbench.effects.elementary import clip
from workbench.effects.hysteresis import stop_direction
from workbench.errors import WorkbenchError
from workbench.kernel.step import apply, view
from workbench.plant import Plant

SOFT = 0.02  # share of the speed limit over which the accelerating torque falls to zero
DIRECTION = "direction"  # the effect that gives `dir` where the plant has no hysteresis


@dataclass
class Symbols:
    """Names made so far: states, constants and clocks as SX, and how constants follow from an effect's parameters."""

    states: dict[str, ca.SX] = field(default_factory=dict)
    constants: dict[str, ca.SX] = field(default_factory=dict)
    clocks: dict[str, ca.SX] = field(default_factory=dict)
    derive: dict[str, ca.Function] = field(default_factory=dict)  # effect key -> parameters to its constants
    derived: dict[str, tuple[str, ...]] = field(default_factory=dict)  # effect key -> names of its constants

    def state(self, name: str) -> ca.SX:
        return self.states.setdefault(name, ca.SX.sym(name))

    def constant(self, name: str) -> ca.SX:
        return self.constants.setdefault(name, ca.SX.sym(name))

    def clock(self, name: str) -> ca.SX:
        return self.clocks.setdefault(name, ca.SX.sym(name))

    @property
    def all(self) -> dict[str, ca.SX]:
        return self.states | self.constants | self.clocks


def is_friction(effect: Effect) -> bool:
    """Whether a scenario's friction factor scales this force: it is declared passive, reads `dir`, or `v` alone."""
    return effect.port == fx.FORCE and (
        "passive" in effect.holds or "dir" in effect.reads or tuple(effect.reads) == ("v",)
    )


def parameters_of(effect: Effect, symbols: Symbols):
    """Return the effect's (derived) parameters as a namespace of constants, registered under "key.name"."""
    given = ca.SX.sym("p", len(effect.parameters))
    inside = namespace(**view(effect.parameters, given))
    inside = effect.derive(inside) if effect.derive else inside
    fields, names, values = {}, [], []
    for name, value in vars(inside).items():
        value = ca.densify(ca.SX(value))
        own = [
            f"{effect.key}.{name}" if value.numel() == 1 else f"{effect.key}.{name}[{i}]" for i in range(value.numel())
        ]
        fields[name] = ca.vertcat(*(symbols.constant(n) for n in own))
        names += own
        values.append(ca.vec(value))
    symbols.derive[effect.key] = ca.Function("derive", [given], [ca.vertcat(*values, ca.SX(0, 1))])
    symbols.derived[effect.key] = tuple(names)
    return namespace(**fields)


def call(effect: Effect, signals: Mapping[str, ca.SX], symbols: Symbols):
    """Return (name -> next state, output, provided) of one effect on these signals."""
    for name in effect.reads:
        if name not in signals:
            raise WorkbenchError(
                f"effect '{effect.name}' at '{effect.at}' reads '{name}', which is not there when it is its turn in a "
                "simulation; an effect reads only what those before it, or the clock, provide."
            )
    names = [
        f"{effect.key}.{n}" if size == 1 else f"{effect.key}.{n}[{i}]"
        for n, size in effect.states.items()
        for i in range(size)
    ]
    z = ca.vertcat(*(symbols.state(n) for n in names), ca.SX(0, 1))
    after, output, provided = apply(effect, {n: signals[n] for n in effect.reads}, z, parameters_of(effect, symbols))
    return {n: after[i] for i, n in enumerate(names)}, output, provided


def ordered(effects: list[Effect]) -> list[Effect]:
    """Forces in order of evaluation: what an effect reads is provided before it; WorkbenchError where that cannot be."""
    waiting = list(effects)
    result: list[Effect] = []
    while waiting:
        ready = [e for e in waiting if not any(set(e.reads) & set(o.provides) for o in waiting)]
        # Those that provide something go first, so that everything else finds it.
        ready = [e for e in ready if e.provides] or ready
        if not ready:
            first = waiting[0]
            raise WorkbenchError(
                f"effect '{first.name}' reads what it, or an effect that waits for it, provides: an implicit cycle, which "
                "the loop cannot evaluate; let it keep the value of the step before as a state."
            )
        result.append(ready[0])
        waiting.remove(ready[0])
    return result


def directed(effects: tuple[Effect, ...]) -> tuple[Effect, ...]:
    """Effects, with a stop operator of two counts where one reads `dir` and none provides it."""
    forces = [e for e in effects if e.port == fx.FORCE]
    if any("dir" in e.reads for e in forces) and not any("dir" in e.provides for e in forces):
        return (*effects, stop_direction(1.0))
    return effects


def command_maps(effects: tuple[Effect, ...]) -> list[Effect]:
    """Maps of the command's value, in their order; time maps are the loop's delay."""
    return [e for e in effects if e.at == "command" and e.port == fx.COMMAND]


def sensor_maps(effects: tuple[Effect, ...]) -> list[Effect]:
    """Maps of the position's reading, in their order."""
    return [e for e in effects if e.at == "sensor.position" and e.port == fx.SENSOR]


def fixed_signals(symbols: Symbols) -> dict[str, ca.SX]:
    """Signals that any effect may read."""
    named = {n: symbols.constant(n) for n in ("ratio", "pole_pairs")}
    return named | {"locked": ca.SX(0.0), "t": symbols.clock("t")}


def substep(effects: tuple[Effect, ...], symbols: Symbols, *, speed_limited: bool, noisy: bool) -> dict[str, ca.SX]:
    """Return name -> next value of every state that one substep moves, and "mass" besides.

    Reads the rows q, v, u (the command), noise; constants h, limit, speed_slope, and the scenario's factors.
    """
    h = symbols.constant("h")
    q, v, u = (symbols.state(n) for n in ("q", "v", "u"))
    after: dict[str, ca.SX] = {}
    signals = fixed_signals(symbols) | {"q": q, "v": v, "dt": h, "u": u}
    for e in command_maps(effects):
        moved, u, _ = call(e, signals, symbols)
        after |= moved
        signals = signals | {"u": u}
    limit = symbols.constant("limit")
    u = clip(u, -limit, limit) if command_maps(effects) else u  # the controller's command obeys the limit already
    if speed_limited:
        u = limited_by_speed(u, v, symbols.constant("speed_slope"))
    a = ca.SX.sym("a")
    signals |= {"a": a, "dq": v * h, "u": u, "tau": u}
    outputs = {}
    for e in ordered([e for e in effects if e.port == fx.FORCE]):
        moved, outputs[e.key], provided = call(e, signals, symbols)
        after |= moved
        signals |= provided
    total = ca.SX(0)
    for e in effects:  # in the plant's order, whatever the order of evaluation
        if e.key in outputs and e.name != DIRECTION:
            total += symbols.constant("friction") * outputs[e.key] if is_friction(e) else outputs[e.key]
    mass, rest = affine(total, a)
    mass = symbols.constant("inertia") * mass + symbols.constant("load_inertia")
    rest = rest + symbols.constant("load")
    drive = u + symbols.state("noise") if noisy else u
    # A mass that is the same in every step is divided by once a run, outside the loop.
    moves = ca.depends_on(mass, ca.vertcat(*symbols.states.values(), *symbols.clocks.values()))
    acceleration = (drive - rest) / mass if moves else (drive - rest) * symbols.constant("per_mass")
    v_after = v + acceleration * h
    after = {n: ca.substitute(x, a, acceleration) for n, x in after.items()}
    return {"q": q + v_after * h, "v": v_after, **after, "mass": mass}


def affine(total: ca.SX, a: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return (mass, rest) of total = mass a + rest; WorkbenchError where it is not affine in a, or has no mass."""
    mass = ca.jacobian(total, a)
    if ca.depends_on(mass, a):
        raise WorkbenchError("the plant's forces are not affine in acceleration, so they cannot be solved for it.")
    if not ca.depends_on(total, a):
        raise WorkbenchError("the plant has no inertia, so a torque has no acceleration; add the effect 'inertia'.")
    return ca.densify(mass), ca.substitute(total, a, ca.SX(0))


def limited_by_speed(u: ca.SX, v: ca.SX, slope: ca.SX) -> ca.SX:
    """Return u with the part that accelerates reduced to zero over the last SOFT of the speed limit; slope = 1/(SOFT limit)."""
    forward = clip(1.0 / SOFT - v * slope, 0.0, 1.0)
    backward = clip(1.0 / SOFT + v * slope, 0.0, 1.0)
    return ca.fmax(u, 0.0) * forward + ca.fmin(u, 0.0) * backward


def constants_of(plant: Plant, symbols: Symbols, width: float) -> dict[str, float]:
    """Return the values of the effects' constants. width: of the stop operator that gives `dir` where no effect does."""
    values = {"ratio": plant.geometry.gear_ratio, "pole_pairs": plant.geometry.pole_pairs}
    for e in directed(plant.effects):
        if e.key not in symbols.derive:
            continue
        e = e(width=width) if e.name == DIRECTION else e
        inside = symbols.derive[e.key](np.array([p.value for p in e.parameters.values()], dtype=float))
        values |= dict(zip(symbols.derived[e.key], np.asarray(inside).ravel().tolist(), strict=True))
    return values
