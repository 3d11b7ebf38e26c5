"""The equivalent stiffness and loss of all friction of a plant together, by the settled first harmonic of its forces.

Effects that read the direction (Stribeck, asymmetry) have no describing function of their own: they ride on the hysteresis.
So the forces are stepped together through q = A cos(w t), as identification steps them along a record.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from workbench import definition as fx
from workbench.description.result import Equivalent
from workbench.inverse.forces import force_along
from workbench.plant import Plant

CYCLES = 3  # the last one is taken: a hysteresis is settled after the first reversal pair
SAMPLES = 1024  # a cycle
MASS = {"inertia": "inertia", "flexible_mode": "mass"}  # effect -> its parameter that the rigid axis carries


class RigidAxis(NamedTuple):
    """friction: the plant with only forces that are neither inertia nor linear viscous. inertia, viscous: coefficients, SI."""

    friction: Plant
    inertia: float
    viscous: float


def friction_of(plant: Plant) -> RigidAxis:
    """Return what a plant is as a rigid axis. Parts that swing on it move with it far below their modes, and count as inertia."""
    inertia = sum(e.parameters[MASS[e.name]].value for e in plant.effects if e.name in MASS)
    viscous = sum(e.parameters["viscous"].value for e in plant.effects if e.name == "viscous_friction")
    rest = plant
    for e in plant.effects:
        if e.name in (*MASS, "viscous_friction") or e.port != fx.FORCE:
            rest = rest.without(e.key)
    return RigidAxis(rest, inertia, viscous)


def equivalent_of(plant: Plant, amplitudes: Sequence[float], omegas: Sequence[float], counts: float) -> Equivalent:
    """Return the Equivalent of a plant's friction at amplitudes (n,), rad or m, each at its frequency omegas (n,), rad/s.

    counts: encoder resolution, the width of the direction where no hysteresis gives it.
    """
    return equivalent_from(amplitudes, cycles_of(plant, amplitudes, omegas, counts))


def equivalent_from(amplitudes: Sequence[float], force: np.ndarray) -> Equivalent:
    """Return the Equivalent of forces (n, SAMPLES) along settled cycles A cos f; see cycles_of."""
    a, phase = np.asarray(amplitudes), 2 * np.pi * np.arange((CYCLES - 1) * SAMPLES, CYCLES * SAMPLES) / SAMPLES
    stiffness = [2 * np.mean(f * np.cos(phase)) / x for f, x in zip(force, a, strict=True)]
    loss = [-2 * np.mean(f * np.sin(phase)) / x for f, x in zip(force, a, strict=True)]
    return Equivalent(a, np.maximum(stiffness, 0.0), np.maximum(loss, 0.0))


def drawn_away(plant: Plant, amplitudes: Sequence[float]) -> np.ndarray:
    """Return -k_e (n,), N*m/rad or N/m, of a plant's springs at amplitudes (n,) where they draw away from the middle; 0 where they hold."""
    springs = plant
    for e in plant.effects:
        if not e.signed_at:
            springs = springs.without(e.key)
    if not springs.effects:
        return np.zeros(len(amplitudes))
    phase = 2 * np.pi * np.arange(SAMPLES) / SAMPLES
    force = cycles_of(springs, amplitudes, np.ones(len(amplitudes)), counts=0.0)
    return np.maximum([-2 * np.mean(f * np.cos(phase)) / x for f, x in zip(force, amplitudes, strict=True)], 0.0)


def cycles_of(plant: Plant, amplitudes: Sequence[float], omegas: Sequence[float], counts: float) -> np.ndarray:
    """Return the forces (n, SAMPLES), N*m or N, along settled cycles q = A cos(f); arguments as of equivalent_of."""
    out = np.empty((len(amplitudes), SAMPLES))
    phase = 2 * np.pi * np.arange(CYCLES * SAMPLES + 1) / SAMPLES
    for k, (amplitude, omega) in enumerate(zip(amplitudes, omegas, strict=True)):
        q = amplitude * np.cos(phase)
        forces = force_along(
            plant,
            2 * np.pi / SAMPLES / omega,
            counts,
            q=q,
            dq=np.diff(q, prepend=0.0),  # from the relaxed state at zero out to A
            v=-amplitude * omega * np.sin(phase),
            a=-amplitude * omega**2 * np.cos(phase),
        )
        out[k] = forces[(CYCLES - 1) * SAMPLES : CYCLES * SAMPLES]
    return out
