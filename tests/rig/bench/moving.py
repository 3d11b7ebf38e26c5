"""Causes over position, of parts and memory, of drives, encoders and clocks, drawn at random within their class."""

from dataclasses import replace

import numpy as np

from rig.bench.cause import Cause, end, harmonics, mover, put, sign, turns, waves
from rig.bench.machines import Stand


def cogging(rng, s: Stand) -> Cause:
    many = int(rng.integers(1, 4))
    return waves("cogging", mover(s), f"{many} orders", "cogging", harmonics(rng, 0.05 * s.effort, turns(rng, s), many))


def cable(rng, s: Stand) -> Cause:
    fixed = {"rest": s.reach.stroke * rng.uniform(-0.8, 0.8)}
    return put("cable_spring", end(s), "linear", {"spring": 0.1 * s.effort / s.reach.stroke}, fixed)


def gravity(rng, s: Stand) -> Cause:
    return put("gravity", end(s), "sine", {"weight": 0.08 * s.effort}, {"weight_phase": rng.uniform(-3, 3)})


def offset(rng, s: Stand) -> Cause:
    return put("constant_offset", mover(s), "constant", {"offset": 0.06 * s.effort * sign(rng)})


def creep(rng, s: Stand) -> Cause:
    """A spectrum of relaxation: several elements whose rates lie even in the logarithm."""
    many = int(rng.integers(2, 7))
    rates = np.geomspace(*np.sort(np.exp(rng.uniform(np.log(0.15), np.log(15.0), 2)) * [0.7, 1.4]), many)
    shares = rng.dirichlet(np.full(many, 3.0))

    def rows(size):
        return np.column_stack([rates, 0.2 * s.effort / s.reach.stroke * size * shares])

    return Cause(
        "creep",
        "axis",
        f"{many} rates",
        lambda size: {"elements": rows(size).tolist()},
        lambda m, size: m.waved("creeping", rows(size)),
    )


def mode(rng, s: Stand) -> Cause:
    fixed = {"mode_frequency": rng.uniform(15.0, 45.0), "mode_damping": rng.uniform(0.01, 0.08)}
    return put(
        "flexible_mode", "axis", "a part on a spring", {"mode": 0.08 * s.machine.facts.inertia}, fixed, largest=8.0
    )


def backlash(rng, s: Stand) -> Cause:
    f = s.machine.facts
    if s.machine.two:
        return put("backlash", "joint", "gap in the joint", {"gap": 0.1 * s.effort / f.k2}, largest=12.0)
    return put(
        "backlash",
        "axis",
        "friction behind a gap",
        {"series_gap": max(s.reach.stroke * 1e-3, 8 * f.count)},
        largest=60.0,
    )


def cubic(rng, s: Stand) -> Cause:
    f = s.machine.facts
    return put("cubic_stiffness", "joint", "cubic", {"k3": f.k2 * (f.k2 / s.effort) ** 2})


# --- drive, encoders, clocks ---


def delay(rng, s: Stand) -> Cause:
    return put("transport_delay", "command", "delay", {"delay": 5e-4}, largest=8.0)


def lag(rng, s: Stand) -> Cause:
    return put("actuator_lag", "command", "first order", {"lag": 5e-4}, largest=8.0)


def saturation(rng, s: Stand) -> Cause:
    kind = int(rng.integers(3))
    fixed = {"fall_kind": float(kind)}
    return put(
        "torque_constant_saturation",
        "command",
        ("tanh", "cubic", "root")[kind],
        {"fall": 0.4 / s.effort},
        fixed,
        largest=2.2 if kind == 1 else 5.0,
    )


def trend(rng, s: Stand) -> Cause:
    """The reported drive drifts."""
    rate = 2e-3 * s.effort * sign(rng)

    def on(m, size):
        return replace(m, reported=replace(m.reported, trend=rate * size))

    return Cause(
        "sensor_trend",
        "sensor.force" if s.linear else "sensor.torque",
        "of the reported drive",
        lambda size: {"rate": rate * size},
        on,
    )


def kinematic(rng, s: Stand) -> Cause:
    many = int(rng.integers(1, 4))
    name = "tooth" if s.machine.two else "reading"
    rows = harmonics(rng, 1e-4 * s.reach.stroke, turns(rng, s), many)
    return waves(
        "kinematic_error", "joint" if s.machine.two else "sensor.position", f"{many} orders", name, rows, largest=300.0
    )


def eccentric(rng, s: Stand) -> Cause:
    name, at = ("load_reading", "sensor.load_position") if s.machine.two else ("reading", "sensor.position")
    return waves(
        "encoder_eccentricity", at, "one a turn", name, np.array([[5e-4, 1.0, rng.uniform(-3, 3)]]), largest=200.0
    )


def skew(rng, s: Stand) -> Cause:
    late = 2e-4 * sign(rng)

    def on(m, size):
        return replace(m, reported=replace(m.reported, late=late * size))

    at = "sensor.load_position" if s.machine.two else "sensor.position"
    return Cause("clock_skew", at, "late", lambda size: {"late": late * size}, on, largest=25.0)


def wrong(rng, s: Stand) -> Cause:
    at = str(rng.choice(["motor", "load"])) if s.machine.two else "axis"
    way = sign(rng)
    return Cause(
        "inertia", at, "a data sheet is wrong", lambda size: {"share": 0.1 * way * size}, wrong=at, largest=3.5
    )
