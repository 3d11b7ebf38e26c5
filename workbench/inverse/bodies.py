"""Where each body of a plant was: readings with sensor maps undone, joint deflections with angle maps applied.

A body is (raw, q, dq, v, a): the position itself, filtered without phase, its increments behind a dead band of one count,
and the derivatives of the filtered one, as many as are asked for. The joint's is that of its effective deflection, position -
load_position after backlash and kinematic error.
"""

from collections.abc import Callable, Iterable
from functools import lru_cache

import casadi as ca
import numpy as np

from workbench import definition as fx
from workbench.definition import Effect
from workbench.errors import WorkbenchError
from workbench.inverse.shift import shifted
from workbench.kernel import arrays
from workbench.kernel.lanes import map_lanes
from workbench.kernel.program import Program, read
from workbench.kernel.step import Definition, along, apply, build, symbols, view
from workbench.motion import MOTION_BAND, LowPass, Motion, increments
from workbench.plant import ONE_MASS, Plant

CHANNEL = {"axis": "position", "motor": "position", "load": "load_position"}
RAW, POSITION, INCREMENT, VELOCITY, ACCELERATION = range(5)
DERIVED = {"v": 1, "a": 2}  # of a body's position, by the signal that a force reads
NEWTON = (
    2  # steps of the inverse of a sensor map: its slope is within a few per cent of one, and each step squares that
)


def values_of(effect: Effect) -> tuple[float, ...]:
    return tuple(p.value for p in effect.parameters.values())


def path_of(effects: list[Effect]) -> tuple:
    """What a result that went through these effects is kept under."""
    return tuple((e.step, values_of(e)) for e in effects)


def derivatives_in(reads: Iterable[str]) -> int:
    """Return how many times a body's position is differentiated for signals with these names."""
    return max((DERIVED.get(r, 0) for r in reads), default=0)


def sensors(plant: Plant, channel: str) -> list[Effect]:
    """Maps of one channel's reading, in the order in which they act on the true value."""
    return [e for e in plant.effects if e.at == f"sensor.{channel}"]


def _angles(plant: Plant) -> list[Effect]:
    """Maps of the joint's deflection: first those that add to it, then gaps, in the order declared."""
    return [e for e in plant.effects if e.port == fx.ANGLE]


ZERO = "zero"  # parameter of an angle's map: by how much the encoders' zeros differ from where the joint is relaxed
SAME = ("q", "motor_q", "load_q")  # of a sensor's map: the position of the body that it reads


@lru_cache(maxsize=64)
def inverse(definition: Definition) -> Program:
    """Program of the true value from a sensor's reading, by Newton steps on the map's own expression.

    What the map adds where everything it reads is zero is taken off, but for a zero of its own: there the encoder was set to
    zero. Left in, a disc off its axis would wind up a joint that is relaxed.
    """
    effect = definition.effect
    s, z, p = symbols(effect)
    if z.numel():
        raise WorkbenchError(f"effect '{effect.name}' maps a reading with a memory, which cannot be undone.")
    target, q = ca.SX.sym("target"), ca.SX.sym("q")
    named = {n: q if n in SAME else symbol for n, symbol in view(effect.reads, s).items()}
    _, forward, _ = apply(effect, named, z, fx.namespace(**view(effect.parameters, p)))
    own = ca.vertcat(*(p[i] for i, n in enumerate(effect.parameters) if n == ZERO))
    at_zero = ca.substitute(forward, ca.vertcat(q, s, own), ca.SX.zeros(1 + s.numel() + own.numel()))
    forward, slope = forward - at_zero, ca.jacobian(forward, q)
    guess = target
    for _ in range(NEWTON):
        value, rate = ca.substitute([forward, slope], [q], [guess])
        guess = guess - (value - target) / rate
    signals = ca.vertcat(target, *(named[r] for r in effect.reads if r not in SAME))
    return read(ca.Function(f"{effect.name}_inverse", [signals, p], [ca.cse(ca.densify(guess))]))


@lru_cache(maxsize=64)
def partials(definition: Definition) -> Program:
    """Step program, without states, of (output, d output/d motor_q, d output/d load_q) of an angle map."""
    effect = definition.effect
    s, z, p = symbols(effect)
    named = view(effect.reads, s)
    _, output, _ = apply(effect, named, z, fx.namespace(**view(effect.parameters, p)))
    slopes = [ca.jacobian(output, named[n]) if n in named else ca.SX(0) for n in ("motor_q", "load_q")]
    return read(
        ca.Function(f"{effect.name}_partials", [s, z, p], [ca.SX(0, 1), ca.densify(ca.vertcat(output, *slopes))])
    )


class Bodies:
    """Bodies of one motion. keep(key, make): the store that all of a motion share."""

    def __init__(self, motion: Motion, keep: Callable):
        self.motion = motion
        self.keep = keep

    def clock(self) -> dict:
        return {"t": self.motion.t, "dt": self.motion.dt}

    def body(self, plant: Plant, place: str, derivatives: int = 2) -> tuple[tuple, np.ndarray]:
        """Return (what it is kept under, (3 + derivatives or more, n)) of the body at a place; path () where it is the position
        as measured. Each derivative is a transform of the whole record: trials of maps are many."""
        if place == "joint":
            return self.joint(plant, derivatives)
        channel = CHANNEL[place]
        maps = sensors(plant, channel)
        if channel == "position" and not maps:
            m = self.motion
            return (), self.keep(("measured",), lambda: np.stack([m.q, m.q, m.dq, m.v, m.a]))
        path = (channel, path_of(maps))

        def make():
            raw = self.reading(channel, maps)
            return _together(raw, self.smooth(raw, derivatives), increments(raw, self.counts(channel)))

        return path, self.keep(("body", path, derivatives), make)

    def counts(self, channel: str) -> float:
        return self.motion.record.resolution.get(channel, 0.0)

    def smooth(self, raw: np.ndarray, derivatives: int) -> np.ndarray:
        """Return a position, filtered without phase, and its derivatives, (1 + derivatives, n)."""
        m = self.motion
        return LowPass(MOTION_BAND * m.filter.bandwidth, 1 / m.dt, raw.size).derivatives(raw, 1 + derivatives)

    def reading(self, channel: str, maps: list[Effect]) -> np.ndarray:
        """Return the true value (n,) behind a channel's reading."""
        x = self.motion.record.channels[channel]
        for e in reversed(maps):
            values = {n: p.value for n, p in e.parameters.items()}
            if e.port == fx.TIME:
                delay = build(e).run(self.clock() | {"q": x}, values)[0]
                x = shifted(x, -delay, self.motion.dt)
            else:
                clock = self.clock()
                signals = [x, *(np.broadcast_to(clock[r], x.shape) for r in e.reads if r not in SAME)]
                (x,) = map_lanes(inverse(Definition(e)), np.stack(signals), values_of(e))
        return x

    def joint(self, plant: Plant, derivatives: int = 2) -> tuple[tuple, np.ndarray]:
        """Return the effective deflection as a body."""
        motor, load = sensors(plant, "position"), sensors(plant, "load_position")
        path = ("joint", path_of(motor), path_of(load), path_of(_angles(plant)))

        def make():
            q_motor, q_load = self.reading("position", motor), self.reading("load_position", load)
            raw = self.mapped(plant, q_motor - q_load, q_motor, q_load)[0]
            smooth = self.smooth(raw, derivatives)
            # a difference of two encoders jumps by the counts of both, several within one presliding stroke: what drives
            # memory here is the filtered deflection, in which they mean out where there are several in the filter's time
            bands = [self.unread("position", motor, q_motor), self.unread("load_position", load, q_load)]
            return _together(raw, smooth, increments(smooth[0], np.maximum(*bands)))

        return path, self.keep(("body", path, derivatives), make)

    def unread(self, channel: str, maps: list[Effect], raw: np.ndarray) -> np.ndarray:
        """Return the dead band (n,) that an encoder's counts ask of the joint's deflection.

        One count at rest; where counts pass within the filter's time, they mean out, and the finer encoder's count is left.
        """
        counts = self.counts(channel)
        finest = min((c for c in map(self.counts, CHANNEL.values()) if c > 0), default=0.0)
        if counts <= 0.0:
            return np.full_like(raw, finest)

        def make():
            band = MOTION_BAND * self.motion.filter.bandwidth
            speed = np.abs(LowPass(band, 1 / self.motion.dt, raw.size)(raw, 1))
            return np.maximum(counts * (1.0 - speed / (2.0 * band * counts)), finest)

        return self.keep(("unread", channel, path_of(maps)), make)

    def mapped(self, plant: Plant, deflection, motor, load) -> tuple:
        """Return (effective deflection, and by what the joint's torque enters the motor's and the load's balance), (n,) each.

        A map of the deflection alone (a gap) lies in series with the joint, and what is in series carries the same
        torque; what a map draws from a body's own position (a gear's error) is a change of ratio, and works on that body.

        What a map adds where both encoders read zero is taken off: they were set to zero with the joint relaxed, so a
        constant is nothing but where their zeros are. Left in, it would wind up a joint that is at rest. Encoders that were set
        to zero elsewhere leave it in part: that is the map's own parameter of this name.
        """
        by_motor, by_load = 1.0, -1.0
        for e in _angles(plant):
            program, values = partials(Definition(e)), values_of(e)
            signals = {"q": deflection, "motor_q": motor, "load_q": load, **self.clock()}
            output, more_motor, more_load = along(program, [signals[r] for r in e.reads], values, deflection.size)
            signals |= {"q": 0.0, "motor_q": 0.0, "load_q": 0.0}
            relaxed = tuple(0.0 if n == ZERO else v for n, v in zip(e.parameters, values, strict=True))
            at_zero = arrays.evaluate(program, [signals[r] for r in e.reads], (), relaxed)[1][0]
            by_motor, by_load = by_motor + more_motor, by_load + more_load
            deflection = output - at_zero
        return deflection, by_motor, by_load

    def leverage(self, plant: Plant) -> tuple[tuple, np.ndarray]:
        """Return what the joint's torque is multiplied by in the motor's and in the load's balance, (2, n) or (2, 1)."""
        maps = _angles(plant)
        if not maps:
            return (), np.array([[1.0], [-1.0]])
        path = path_of(maps)

        def make():
            (_, motor), (_, load) = self.body(plant, "motor", 0), self.body(plant, "load", 0)
            q_motor, q_load = motor[POSITION], load[POSITION]
            _, by_motor, by_load = self.mapped(plant, q_motor - q_load, q_motor, q_load)
            by = np.stack([np.broadcast_to(np.asarray(x, float), q_motor.shape) for x in (by_motor, by_load)])
            return by[:, :1].copy() if np.all(by == by[:, :1]) else by

        return path, self.keep(("leverage", path), make)


def _together(raw: np.ndarray, smooth: np.ndarray, increment: np.ndarray) -> np.ndarray:
    """Return a body of a position (n,), what is smooth of it (1 + derivatives, n) and its increments (n,)."""
    return np.stack([raw, smooth[0], increment, *smooth[1:]])


def rows(plant: Plant, locked: bool) -> int:
    """Balances that a record holds: one body; motor and load; the motor alone where the load is locked."""
    return 1 if plant.kind == ONE_MASS or locked else 2
