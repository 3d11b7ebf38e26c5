"""Causes that no catalogue has."""

from dataclasses import replace

import numpy as np

from rig.bench.cause import Cause, end, mover, put, timed, walk
from rig.bench.machines import Stand


def shaken(rng, s: Stand) -> Cause:
    f, phase = rng.uniform(11.0, 38.0), rng.uniform(-3, 3)

    def push(t, size):
        return 0.06 * s.effort * size * np.sin(2 * np.pi * f * t + phase)

    return timed(
        "", mover(s), f"a force of {f:.1f} Hz in bench time", push=push, parameters={"frequency": f}, where=("time", [])
    )


def wandering(rng, s: Stand) -> Cause:
    tau, seed = rng.uniform(1.0, 4.0), int(rng.integers(2**31))

    def level(t, size):
        return np.maximum(1.0 + 0.4 * size * walk(seed, tau, t), 0.05)

    return timed(
        "", mover(s), f"the friction's level wanders, {tau:.1f} s", level, parameters={"tau": tau}, where=("time", [])
    )


def windowed(rng, s: Stand) -> Cause:
    low = s.reach.stroke * rng.uniform(-0.5, 0.1)
    high = low + s.reach.stroke * rng.uniform(0.15, 0.35)
    fixed = {"window_from": low, "window_to": high, "window_edge": 0.02 * s.reach.stroke}
    return put(
        "",
        mover(s),
        "a window of the stroke, in one direction",
        {"window": 0.1 * s.effort},
        fixed,
        where=("position", [(low, high)]),
    )


def cushion(rng, s: Stand) -> Cause:
    place = s.reach.stroke * rng.uniform(0.25, 0.5)
    fixed = {"cushion_at": place, "cushion_sinks": rng.uniform(0.3, 1.0), "cushion_recovers": rng.uniform(0.1, 0.4)}
    return put(
        "",
        end(s),
        "a cushion that recovers slowly",
        {"cushion": 0.6 * s.effort / s.reach.stroke},
        fixed,
        where=("position", [(place, s.reach.stroke)]),
    )


def slips(rng, s: Stand) -> Cause:
    moments, ways = np.cumsum(rng.uniform(0.7, 2.2, 200)), rng.choice([-1.0, 1.0], 200)
    length = rng.uniform(0.05, 0.1)

    def push(t, size):
        k = np.clip(np.searchsorted(moments, t, side="right") - 1, 0, 199)
        x = (t - moments[k]) / length
        return np.where(
            (x > 0) & (x < 1) & (t >= moments[0]),
            0.3 * s.effort * size * ways[k] * np.sin(np.pi * np.clip(x, 0, 1)) ** 2,
            0.0,
        )

    return timed(
        "",
        mover(s),
        "kicks at moments of chance",
        push=push,
        where=("time", [(float(m), float(m + length)) for m in moments]),
    )


def packets(rng, s: Stand) -> Cause:
    moments, steps = np.cumsum(rng.uniform(0.7, 2.5, 200)), rng.uniform(0.5, 1.5, 200)

    def on(m, size):
        lost = tuple((float(t), float(-10 * s.load_count * size * x)) for t, x in zip(moments, steps, strict=True))
        return replace(m, reported=replace(m.reported, lost=lost))

    return Cause(
        "",
        "sensor.load_position",
        "the load's encoder falls behind in steps",
        lambda size: {"step": 10 * s.load_count * size},
        on,
        where=("time", []),
    )


def uneven(rng, s: Stand) -> Cause:
    """A joint that yields more at some places than at others: a belt's free strands, an arm's gear; half a wave to two along the stroke."""
    fixed = {
        "uneven_order": 2 * np.pi * rng.uniform(0.25, 1.0) / s.reach.stroke,
        "uneven_phase": rng.uniform(-np.pi, np.pi),
    }
    return put(
        "",
        "joint",
        "a stiffness that changes along the stroke",
        {"uneven": 0.2},
        fixed,
        largest=0.8,
        where=("position", []),
    )
