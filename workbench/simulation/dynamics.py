"""Effects as parts of a loop: their names, their constants, and the order in which they are evaluated."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from workbench import definition as fx
from workbench.definition import Effect, namespace
from workbench.effects.direction import CONTACT, DIRECTION, in_parallel, stop_direction
from workbench.errors import WorkbenchError
from workbench.kernel.step import apply, view
from workbench.plant import Plant
from workbench.simulation.given import TEMPERATURE


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
    """Whether a scenario's friction factor scales this force: it is passive, reads or gives `dir`, or reads `v` alone."""
    return effect.port == fx.FORCE and (
        "passive" in effect.holds
        or "dir" in (*effect.reads, *effect.provides)
        or CONTACT in effect.states
        or tuple(effect.reads) == ("v",)
    )


def _parameters_of(effect: Effect, symbols: Symbols):
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
    after, output, provided = apply(effect, {n: signals[n] for n in effect.reads}, z, _parameters_of(effect, symbols))
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
    """Effects, with a stop operator of two counts at each place where one reads `dir` and none provides it, or within what
    stands beside friction with memory (`in_parallel`)."""
    places = dict.fromkeys(e.at for e in effects if e.port == fx.FORCE)
    beside = {o.key: o for place in places for o in in_parallel([e for e in effects if e.at == place], 1.0)}
    effects = tuple(beside.get(e.key, e) for e in effects)
    forces = [e for e in effects if e.port == fx.FORCE]
    reading = dict.fromkeys(e.at for e in forces if "dir" in e.reads)
    given = {e.at for e in forces if "dir" in e.provides}
    return (*effects, *(stop_direction(1.0)(at=place) for place in reading if place not in given))


def command_maps(effects: tuple[Effect, ...]) -> list[Effect]:
    """Maps of the command's value, in their order; time maps are the loop's delay."""
    return [e for e in effects if e.at == "command" and e.port == fx.COMMAND]


def sensor_maps(effects: tuple[Effect, ...], channel: str) -> list[Effect]:
    """Maps of one channel's reading, in their order; time maps are of what logged it, not of what the loop reads."""
    return [e for e in effects if e.at == f"sensor.{channel}" and e.port == fx.SENSOR]


def angle_maps(effects: tuple[Effect, ...]) -> list[Effect]:
    """Maps of the joint's deflection, in their order."""
    return [e for e in effects if e.port == fx.ANGLE]


def fixed_signals(symbols: Symbols) -> dict[str, ca.SX]:
    """Signals that any effect may read; a temperature over time where the run is given one, else a scenario's own."""
    constants = {n: symbols.constant(n) for n in ("ratio", "pole_pairs", "locked")}
    warm = (symbols.clocks | symbols.states).get(TEMPERATURE)
    return constants | {"t": symbols.clock("t"), TEMPERATURE: symbols.constant(TEMPERATURE) if warm is None else warm}


def constants_of(plant: Plant, symbols: Symbols, widths: Mapping[str, float]) -> dict[str, float]:
    """Return the values of the effects' constants. widths: place -> of its stop operator, where no effect gives `dir`."""
    values = {"ratio": plant.geometry.gear_ratio, "pole_pairs": plant.geometry.pole_pairs}
    for e in directed(plant.effects):
        if e.key not in symbols.derive:
            continue
        e = e(width=widths[e.at]) if e.name == DIRECTION or CONTACT in e.states else e
        inside = symbols.derive[e.key](np.array([p.value for p in e.parameters.values()], dtype=float))
        values |= dict(zip(symbols.derived[e.key], np.asarray(inside).ravel().tolist(), strict=True))
    return values
