"""What happens to the command before it acts: time and command maps on the measured drive, and back again.

What the drive's own channel adds to the command (an offset that moves) is taken off first, and put on last.
"""

from collections.abc import Callable
from functools import lru_cache

import casadi as ca
import numpy as np

from workbench import definition as fx
from workbench.definition import Effect
from workbench.inverse.bodies import inverse, path_of, sensors, values_of
from workbench.inverse.shift import FINER, finer, shifted
from workbench.kernel import scan
from workbench.kernel.lanes import map_lanes
from workbench.kernel.program import Program, read
from workbench.kernel.step import Definition, apply, build, symbols, view
from workbench.motion import Motion
from workbench.plant import DRIVES, Plant

REACH = 1.2  # times its limit: more no drive is taken to give, and a plan still sees that it is too much
NEWTON = 4  # steps of the inverse of a command map: exact after one where the map is affine in u


@lru_cache(maxsize=64)
def inverse_program(definition: Definition) -> Program:
    """Program of u from u' for a command map, by Newton steps on its own expression; states advance with the found u."""
    effect = definition.effect
    s, z, p = symbols(effect)
    target = ca.SX.sym("target")
    named = view(effect.reads, s)
    parameters = fx.namespace(**view(effect.parameters, p))
    _, forward, _ = apply(effect, named, z, parameters)
    u = named["u"]
    slope = ca.jacobian(forward, u)
    guess = target
    for _ in range(NEWTON):
        value, rate = ca.substitute([forward, slope], [u], [guess])
        guess = guess - (value - target) / rate
    after, _, _ = apply(effect, named | {"u": guess}, z, parameters)
    signals = ca.vertcat(target, *(named[r] for r in effect.reads if r != "u"))
    return read(ca.Function(f"{effect.name}_inverse", [signals, z, p], [after, ca.densify(guess)]))


class Command:
    """The command of one motion. keep(key, make): the store that all of a motion share."""

    def __init__(self, motion: Motion, keep: Callable):
        self.motion = motion
        self.keep = keep

    def applied(self, plant: Plant) -> np.ndarray:
        """Return the applied drive u' (n,): time and command maps on the measured one, its channel's maps undone."""
        u, path = self.motion.u, ("u",)
        for e in reversed(_channel_maps(plant)):
            path = (*path, *path_of([e]))
            u = self.keep(("true", path), lambda e=e, u=u: self._true(e, u))
        path = ("true", path)  # a delay here and one of the command have the same step, and may have the same value
        for e in command_maps(plant):
            before, path = path, (*path, *path_of([e]))
            u = self.keep(("applied", path), lambda e=e, u=u, b=before: self._forward(e, u, b))
        return u

    def _forward(self, effect: Effect, u: np.ndarray, path: tuple) -> np.ndarray:
        values = _named(effect)
        many = _steps_a_sample(effect)
        fine = self.keep(("finer", path), lambda: finer(u)) if many > 1 else u
        signals = {"u": fine, **self._clock(many)}
        output = build(effect).run(signals, values, states=self._rest(effect, u))[0][::many]
        return shifted(u, output, self.motion.dt) if effect.port == fx.TIME else output

    def _true(self, effect: Effect, reported: np.ndarray) -> np.ndarray:
        """Return the drive (n,) behind its channel's reading."""
        clock = self._clock(1)
        if effect.port == fx.TIME:
            return shifted(reported, -build(effect).run(clock, _named(effect))[0], self.motion.dt)
        signals = [reported, *(np.broadcast_to(clock[r], reported.shape) for r in effect.reads if r != "q")]
        return map_lanes(inverse(Definition(effect)), np.stack(signals), values_of(effect))[0]

    def _clock(self, many: int) -> dict[str, np.ndarray | float]:
        """Time and its step where each sample is taken in `many` steps."""
        m = self.motion
        ahead = np.arange(many) * (m.dt / many)
        return {"dt": m.dt / many, "t": (m.t[:, None] + ahead).ravel() if many > 1 else m.t}

    def _rest(self, effect: Effect, u: np.ndarray) -> np.ndarray:
        """States of a command map that has settled at the first command."""
        return np.full(sum(effect.states.values()), u[0])

    def undone(self, plant: Plant, required: np.ndarray) -> np.ndarray:
        """Return the drive u that the command maps turn into `required` (n,), as far as a drive gives it.

        No command makes more of a drive that saturates than its bound, and close to it the inverse asks for anything: no more
        than REACH times the drive's limit or the largest command that was logged, where there is one.
        """
        m, u = self.motion, required
        known = [x for x in (float(np.abs(m.u).max()), plant.limits.drive) if 0.0 < x < np.inf]
        most = REACH * max(known, default=np.inf)
        for e in reversed(command_maps(plant)):
            values = _named(e)
            if e.port == fx.TIME:
                delay = build(e).run({"t": m.t}, values)[0]
                u = shifted(u, -delay, m.dt)
            else:
                many = _steps_a_sample(e)
                fine = finer(u) if many > 1 else u
                rest = self._clock(many)
                signals = np.stack([fine, *(np.broadcast_to(rest[r], fine.shape) for r in e.reads if r != "u")])
                found = scan.scan(
                    inverse_program(Definition(e)), signals, self._rest(e, u), np.array(list(values.values()))
                )[0][::many]
                u = np.clip(np.where(np.isfinite(found), found, np.copysign(most, u)), -most, most)
        for e in _channel_maps(plant):
            read = build(e).run({"q": u, **self._clock(1)}, _named(e))[0]
            u = shifted(u, read, m.dt) if e.port == fx.TIME else read
        return u


def _named(effect: Effect) -> dict[str, float]:
    return {n: p.value for n, p in effect.parameters.items()}


def _steps_a_sample(effect: Effect) -> int:
    return FINER if effect.states and "dt" in effect.reads else 1


def _channel_maps(plant: Plant) -> list[Effect]:
    """Maps of the drive's own channel, in the order in which they act on the true drive."""
    return sensors(plant, DRIVES[plant.rotary])


def drive_path(plant: Plant) -> tuple:
    """What a result is kept under that went through all that lies between the measured drive and the applied one: maps of the
    channel, maps of the command."""
    return path_of(_channel_maps(plant)), path_of(command_maps(plant))


def command_maps(plant: Plant) -> list[Effect]:
    """Time maps, then command maps, in the order in which they act on the command."""
    at = [e for e in plant.effects if e.at == "command"]
    return [e for e in at if e.port == fx.TIME] + [e for e in at if e.port == fx.COMMAND]
