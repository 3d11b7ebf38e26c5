"""Causes in friction: laws over speed, direction, distance, load and time, drawn at random within their class."""

from dataclasses import replace

import numpy as np

from rig.bench import kernel
from rig.bench.cause import Cause, mover, put, sign, timed, turns
from rig.bench.contacts import lognormal
from rig.bench.machines import Stand, log_uniform


def stribeck(rng, s: Stand) -> Cause:
    shape, name = [
        (kernel.GAUSS, "Gaussian"),
        (kernel.LORENTZ, "Lorentzian"),
        (kernel.RATIONAL, "1/(1+v/vs)"),
        (None, "exponent"),
    ][rng.integers(4)]
    shape = rng.choice([0.55, 1.4, 3.0]) if shape is None else shape
    fixed = {"drop_speed": s.reach.speed * log_uniform(rng, 0.02, 0.12), "drop_shape": float(shape)}
    return put("stribeck_friction", mover(s), f"peak: {name} {shape:g}", {"drop": 0.08 * s.effort}, fixed, largest=12.0)


def nonlinear_viscous(rng, s: Stand) -> Cause:
    if rng.random() < 0.3:
        fixed = {"curved_kind": float(kernel.SATURATING), "curved_speed": s.reach.speed * rng.uniform(0.15, 0.4)}
        return put("nonlinear_viscous_friction", mover(s), "saturating: tanh", {"curved": 0.2 * s.effort}, fixed)
    power = float(rng.choice([0.45, 0.6, 1.5, 2.0]))
    fixed = {"curved_power": power, "curved_speed": s.reach.speed}
    return put("nonlinear_viscous_friction", mover(s), f"power {power:g}", {"curved": 0.15 * s.effort}, fixed)


def asymmetry(rng, s: Stand) -> Cause:
    scaled = {
        "asymmetry": 0.06 * s.effort * sign(rng),
        "asymmetry_viscous": 0.03 * s.effort / s.reach.speed * rng.uniform(0.2, 1),
    }
    return put("coulomb_asymmetry", mover(s), "|d| and |v|", scaled)


def loaded(rng, s: Stand) -> Cause:
    return put(
        "load_dependent_friction",
        mover(s),
        "mu of what the gear transmits, filtered",
        {"mu": 0.1},
        {"behind": rng.uniform(0.3, 0.95)},
        largest=8.0,
    )


def drift(rng, s: Stand) -> Cause:
    """Warm-up: friction decays or grows exponentially over the bench clock."""
    tau, way = rng.uniform(15.0, 70.0), -sign(rng) * (1.0 if rng.random() < 0.3 else -1.0)
    way = abs(way)  # friction falls as an axis warms up

    def level(t, size):
        return 1.0 + 0.4 * size * way * np.exp(-t / tau)

    return timed("friction_drift", mover(s), f"exponential, {tau:.0f} s", level, parameters={"tau": tau})


def cyclic(rng, s: Stand) -> Cause:
    fixed = {"cyclic_order": turns(rng, s) / 4, "cyclic_phase": rng.uniform(-3, 3)}
    return put(
        "cyclic_friction",
        mover(s),
        "one order",
        {"cyclic": 0.06 * s.effort},
        fixed,
        largest=1.0 / 0.06 * s.machine.facts.h0 / s.effort,
    )


def presliding(rng, s: Stand) -> Cause:
    """Coulomb friction is declared, and the contact gives way over many counts."""
    median = max(s.reach.stroke * 1.5e-3, 12 * s.machine.facts.count)
    sigma = rng.uniform(0.4, 0.9)

    def length(size):
        return max(median * size, 4 * s.machine.facts.count)

    def on(m, size):
        return replace(m, lists=m.lists._replace(bristles=lognormal(length(size), sigma)))

    law = f"lognormal bristles, sigma {sigma:.2f}"
    return Cause("presliding_hysteresis", mover(s), law, lambda size: {"median": length(size)}, on, largest=60.0)


def fading(rng, s: Stand) -> Cause:
    fixed = {"fading_distance": s.reach.stroke * log_uniform(rng, 0.03, 0.2)}
    return put("fading_memory", mover(s), "forgets over a distance", {"fading": 0.08 * s.effort}, fixed)
