"""Records of a joint between two encoders, made in closed form without the workbench: the load moves as chosen, the joint
carries what that takes, and each encoder is read by its own clock."""

from pathlib import Path

import numpy as np

from workbench.definition import find
from workbench.plant import TWO_MASS, Geometry, Plant
from workbench.record import Record, Source

RATE, BAND = 500.0, 30.0
JM, JL, BM, BL, K = 300.0, 700.0, 900.0, 700.0, 4e6
SOURCE = Source(Path("made"), "", "made", {})


def stop_loop(torque: np.ndarray, radius: float) -> np.ndarray:
    """A play operator by hand: what lags behind a torque by `radius`."""
    out, z = np.empty_like(torque), 0.0
    for i, x in enumerate(torque):
        z = min(max(z, x - radius), x + radius)
        out[i] = z
    return out


def waved(t: np.ndarray, seed: int, derivative: int) -> np.ndarray:
    """A sum of four sines of 0.2 to 3 Hz, its second derivative of one size each."""
    rng = np.random.default_rng(seed)
    total = np.zeros_like(t)
    for f in (0.2, 0.55, 1.3, 3.1):
        w, phase = 2 * np.pi * f * rng.uniform(0.9, 1.1), rng.uniform(0, 2 * np.pi)
        total += 1.5 / w**2 * w**derivative * np.sin(w * t + phase + derivative * np.pi / 2)
    return total


def joint(
    seed: int,
    *,
    late=0.0,
    gains=0.0,
    motor=False,
    loop=0.0,
    zero=0.0,
    viscous=BL,
    weight=0.0,
    coulomb=0.0,
    count=3e-6,
    name="",
    seconds=12.0,
) -> Record:
    """One record. late, gains: of the load's clock, or of the motor's (motor). loop: of the joint's deflection, the share that
    lags behind the torque. zero: of one encoder against the other, rad. viscous: behind the joint.
    weight: of the load out of balance, N*m. coulomb: dry friction at the motor, N*m."""
    t = np.arange(round(seconds * RATE)) / RATE

    def passing(t):
        return JL * waved(t, seed, 2) + viscous * waved(t, seed, 1) + weight * np.sin(waved(t, seed, 0))

    def motor_at(t):
        torque = passing(t)
        lagging = stop_loop(torque, 0.3 * np.abs(torque).max()) if loop else 0.0
        return waved(t, seed, 0) + ((1.0 - loop) * torque + loop * lagging) / K

    told = t - late - gains * t
    q, load = motor_at(told if motor else t) + zero, waved(t if motor else told, seed, 0)
    through, at, speed = passing(t), waved(t, seed, 0), waved(t, seed, 1)
    winding = JL * waved(t, seed, 4) + viscous * waved(t, seed, 3)
    winding += weight * (np.cos(at) * waved(t, seed, 2) - np.sin(at) * speed**2)
    acceleration = waved(t, seed, 2) + winding / K
    rng = np.random.default_rng(seed + 1000)
    turning = waved(t, seed, 1) + (JL * waved(t, seed, 3) + viscous * waved(t, seed, 2)) / K
    u = through + JM * acceleration + BM * speed + coulomb * np.sign(turning) + rng.normal(0.0, 5.0, t.size)
    read = {n: count * np.round(x / count) for n, x in (("position", q), ("load_position", load))}
    steps = dict.fromkeys(read, count)
    return Record(name or f"r{seed}", "identification", t, {"torque": u, **read}, {}, SOURCE, steps)


def jointed(**fixed: bool) -> Plant:
    """The plant that is declared of it. fixed: whether inertia and viscous friction are known."""
    inertia, viscous = fixed.get("inertia", False), fixed.get("viscous", False)
    return (
        Plant(TWO_MASS, geometry=Geometry(gear_ratio=100.0))
        + find("inertia")(at="motor", inertia=JM, fixed=inertia)
        + find("inertia")(at="load", inertia=JL, fixed=inertia)
        + find("viscous_friction")(at="motor", viscous=BM, fixed=viscous)
        + find("viscous_friction")(at="load", viscous=BL, fixed=viscous)
        + find("linear_stiffness")(at="joint", stiffness=K)
        + find("linear_damping")(at="joint", damping=10.0)
    )
