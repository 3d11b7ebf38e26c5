"""What the tests of the firmware share: controllers of every law, golden vectors, and the C called with arrays."""

import ctypes
import importlib.util
import shutil

import numpy as np
import pytest

from workbench.control import FeedForward, drive_cascade, fixed_pd, grid, pi_cascade, profile_pi, scheduled_pd
from workbench.control.laws import RULES
from workbench.control.notched import notched
from workbench.firmware import host
from workbench.frequency.notch import Notch
from workbench.plant import ONE_MASS, TWO_MASS, Limits, Plant
from workbench.simulation import Loop

COUNT = 4.8e-6  # rad: one arc second
AXIS = Plant(ONE_MASS, limits=Limits(3.3, 20.9))
PAIR = Plant(TWO_MASS, limits=Limits(3.3, 20.9))
LOOP = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, COUNT)
DUAL = Loop(2.5e-4, 4, 2.5e-4, 2.5e-4, COUNT, 0.75 * COUNT, "load_position")


class Gains:
    """A schedule like those that are tuned: gains fall with amplitude."""

    knots = grid(1e-5, 2.5, 2)
    kp = 2200.0 / (1.0 + knots / 3e-4) + 20.0
    kd = 12.0 / (1.0 + knots / 1e-3) + 0.6
    rule, reversal = "following", None


def fed() -> FeedForward:
    speeds = grid(0.01, 20.0, 1)
    return FeedForward(0.0074, speeds, 0.3 + 0.05 * speeds)


def drive(notches: int):
    """A closed drive's cascade with feed-forward, and so many notches."""
    given = [Notch(180.0 * (i + 1), 60.0, 0.1) for i in range(notches)]
    return drive_cascade(60.0, 5.0, 300.0, 12.0, sample_time=2.5e-4, notches=given, forward=1.0, mass=0.0074)


def every() -> dict:
    """Name -> (controller, loop, plant) of every law of one encoder, and of laws that read two."""
    one = {
        "fixed": fixed_pd(900.0, 5.0),
        "cascade": pi_cascade(60.0, 5.0, 300.0, 12.0),
        "profile": profile_pi(60.0, 5.0, 300.0, 400.0, 0.01, 12.0),
        "drive": drive(0),
        "drive, notch": drive(1),
        "fed forward": profile_pi(60.0, 5.0, 300.0, 400.0, 0.01, 12.0, feed_forward=fed()),
    }
    for rule in RULES:
        one[rule] = scheduled_pd(Gains, rule)
        one[f"{rule}, profiled"] = scheduled_pd(Gains, rule, deceleration=300.0, speed_limit=12.0)
    wide = Notch(300.0, 420.0, 0.8)  # as a gain table is tuned with one
    one |= {f"{rule}, notch": notched(scheduled_pd(Gains, rule), wide, 2.5e-4) for rule in ("error", "closing")}
    two = {
        "joint": scheduled_pd(Gains, follows="joint", motor_speed=True),
        "motor speed": scheduled_pd(Gains, "frozen", motor_speed=True),
        "on the motor": pi_cascade(60.0, 5.0, 300.0, 12.0, motor_position=True),
    }
    found = {n: (c, LOOP, AXIS) for n, c in one.items()}
    return found | {n: (c, DUAL, PAIR) for n, c in two.items()}


def need(module: str, reason: str) -> None:
    """Skip where a package of the extra `firmware` is not installed."""
    if importlib.util.find_spec(module) is None:
        pytest.skip(reason)


def need_compiler() -> None:
    if not any(map(shutil.which, ("gcc", "clang", "cc"))):
        pytest.skip("no C compiler here")


class Host:
    """The firmware compiled for this machine, its table loaded."""

    def __init__(self, made, options=("-O2",), change=lambda files: files):
        need_compiler()
        self.made = made
        self.library = host.compiled(change(made.files | made.source.vectors()), options)
        data = made.image.bytes()
        assert self.library.wb_vectors_load(data, len(data)) == 0

    def call(self, name: str, words) -> int:
        words = np.ascontiguousarray(words, np.uint32)
        return getattr(self.library, f"wb_vectors_{name}")(words.ctypes.data_as(ctypes.c_void_p)) & 0xFFFFFFFF

    def run(self, words: np.ndarray, fresh: np.ndarray) -> np.ndarray:
        """Return the commands' bits of samples `words` (n, 4)."""
        words, fresh = np.ascontiguousarray(words, np.uint32), np.ascontiguousarray(fresh, np.uint8)
        out = np.zeros(len(words), np.uint32)
        pointers = [x.ctypes.data_as(ctypes.c_void_p) for x in (words, fresh, out)]
        self.library.wb_vectors_run(*pointers, len(words))
        return out

    def vectors(self, states: np.ndarray, words: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return commands (n,) and states after (n, k), as bits, of single samples from given states (n, k)."""
        after, out = np.zeros_like(states), np.zeros(len(words), np.uint32)
        for i, (state, word) in enumerate(zip(states, words, strict=True)):
            self.call("set", state)
            out[i] = self.call("step", word)
            self.library.wb_vectors_get(after[i].ctypes.data_as(ctypes.c_void_p))
        return out, after


def axes_of(reference, states: np.ndarray):
    """The reference's axes in given states (n, k) as bits."""
    from workbench.firmware.reference import Axes, signed

    kept = {n: states[:, 3 + i].view(reference.dtype).copy() for i, n in enumerate(reference.stages.states)}
    return Axes(kept, states[:, 0].copy(), signed(states[:, 1]), states[:, 2] != 0)


def bits_of(reference, axes) -> np.ndarray:
    """States (n, k) as bits."""
    head = [axes.origin, (axes.position & 0xFFFFFFFF).astype(np.uint32), axes.fault.astype(np.uint32)]
    return np.stack([*head, *(np.asarray(x, reference.dtype).view(np.uint32) for x in axes.state.values())], axis=1)


ODD = np.array([np.nan, np.inf, -np.inf, 1e-45, -1e-40, 3.4e38, -0.0], np.float32).view(np.uint32)


def memories(draw, made, position: np.ndarray, size: np.ndarray) -> dict[str, np.ndarray]:
    """What axes may remember, as real numbers (float64), in counts: near a reversal, far from one, and at rest."""
    n, limit = position.size, made.numbers.limit
    near = np.round(draw.normal(size=n) * np.where(draw.uniform(size=n) < 0.5, 3.0, size))
    speed = draw.normal(size=n) * np.exp(draw.uniform(0.0, np.log(made.numbers.speed), n)) / 40.0
    speed[::19] = draw.choice([0.0, 1e-45, -1e-41], speed[::19].size)
    way = draw.choice([-1.0, 0.0, 1.0], n)
    found = {
        "y": position, "motor.y": position + np.round(draw.normal(size=n) * 3.0), "furthest": position + near, "vh": speed, "motor.vh": speed, "way": way,
        "turned": position + near - way * size, "share": np.where(way == 0.0, 1.0, draw.choice([0.5, 1.0], n)),
        "law.held": np.abs(near), "law.integral": limit * draw.uniform(-1, 1, n),
        "law.asked": position, "law.asked_rate": 1e-3 * speed,
    }  # fmt: skip
    states = made.reference.stages.states
    found |= {
        m: limit * draw.uniform(-1, 1, n) for m in states if m.startswith(("law.first", "law.second", "law.notch"))
    }
    return {m: found[m] for m in states}


def golden(made, n: int = 1000, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Return states (n, k) and samples (n, 4) as bits: motion, reversals, both ends of the table, limits, denormals, wrap."""
    draw, reference = np.random.default_rng(seed), made.reference
    size = np.exp(draw.uniform(np.log(1.0), np.log(6e6), n))  # how far, in counts
    position = np.round(draw.uniform(-1, 1, n) * size)
    way = np.round(draw.normal(size=n) * np.exp(draw.uniform(0.0, np.log(made.numbers.jump), n)) / 3.0)
    way[::17] = 0.0
    way[7::97] = made.numbers.jump + 1  # no motion any more
    raw = draw.integers(0, 2**32, n, np.uint32)
    raw[::11] = 2**32 - draw.integers(1, 50, raw[::11].size)  # about to wrap
    if made.reference.stages.both:  # two encoders share an origin that does not move
        position = np.clip(position, -3e5, 3e5)
        raw = (position.astype(np.int64) & 0xFFFFFFFF).astype(np.uint32)
    origin = (raw - (position.astype(np.int64) & 0xFFFFFFFF).astype(np.uint32)).astype(np.uint32)
    values = {m: reference.stored(m, x) for m, x in memories(draw, made, position, size).items()}
    head = [origin, (position.astype(np.int64) & 0xFFFFFFFF).astype(np.uint32), np.zeros(n, np.uint32)]
    states = np.stack([*head, *(values[m].view(np.uint32) for m in reference.stages.states)], axis=1)
    now = (raw + (way.astype(np.int64) & 0xFFFFFFFF).astype(np.uint32)).astype(np.uint32)
    to = np.round(draw.normal(size=n) * size**0.6).astype(np.int64)
    to[::13], to[5::29] = 0, 2**31 - 7  # on the target, and far beyond what is told apart
    target = (now + (to & 0xFFFFFFFF).astype(np.uint32)).astype(np.uint32)
    if "law.asked" in reference.stages.states:  # the reference of the sample before, mostly this one's
        asked = (target - origin).view(np.int32) + np.where(
            draw.uniform(size=n) < 0.2, np.round(draw.normal(size=n)), 0.0
        )
        states[:, 3 + reference.stages.states.index("law.asked")] = reference.stored("law.asked", asked).view(np.uint32)
    other = (now.view(np.int32) * 0.75 + draw.normal(size=n) * 30.0).astype(np.int32).view(np.uint32)
    added = np.where(draw.uniform(size=n) < 0.3, draw.normal(size=n) * made.numbers.limit, 0.0)
    words = reference.stored("added", added).view(np.uint32)
    words[3::41] = np.resize(ODD, words[3::41].size)
    return np.ascontiguousarray(states), np.stack([now, other, target, words], axis=1)
