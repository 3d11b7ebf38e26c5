"""A flex cable that pulls to one side, which the declared model does not hold: what a trace of records makes of it.

Position in m at 0.5 um/V. The drive is a voltage; a trace wants a force, so 1 V counts as 1 N: the motor's constant is not
printed, and every stiffness and mass is over it.
"""

import numpy as np

from workbench.definition import find
from workbench.hysteresis import Bank
from workbench.inverse.dynamics import inverse_dynamics
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record
from workbench.simulation.recorded import record_of

from .loop import CALIBRATED, K0, RATE, TS
from .machine import Given, Machine
from .records import MILLI, Noise

METRE = 0.5e-6  # m a V of the vibrometer
BANDWIDTH = 100.0  # Hz of the comparison: above it windage is all that is left
EVERY = 6  # samples a logged one
STIFFNESS, REST = 0.4e-3, -6.0  # V/V, V: a pull of 2.4 mV, as large as the friction
CANDIDATES = (
    "constant_offset cable_spring gravity linear_stiffness cubic_stiffness viscous_friction coulomb_asymmetry "
    "stribeck_friction friction_drift cogging"
).split()
MOTIONS = (  # (role, [(Hz, V)]): what moves, 2 s each
    (IDENTIFICATION, ((2.0, 1.2), (11.0, 0.15))),
    (IDENTIFICATION, ((10.0, 0.6), (0.5, 0.5))),
    (IDENTIFICATION, ((1.0, 0.3), (25.0, 0.25))),
    (VALIDATION, ((3.0, 0.9), (17.0, 0.2))),
)
DURATION = 2.0


def declared(bank: Bank) -> Plant:
    """Return inertia and the identified pivot (mV/V), its springs free: what the engineer believes, without the cable's pull."""
    keep, creeping = bank.springs > 0.0, bank.creeps > 0.0
    scale = 1.0 / (MILLI * METRE)
    si = Bank(
        0.0, bank.radii[keep] * METRE, bank.springs[keep] * scale, bank.rates[creeping], bank.creeps[creeping] * scale
    )
    inertia = find("inertia")(inertia=1.0 / (K0 * METRE), fixed=True)
    effects = tuple(
        e if e.name != "creep" else e(fixed=True, **{n: p.value for n, p in e.parameters.items()}) for e in si.effects()
    )
    return Plant(ONE_MASS, (inertia, *effects), rotary=False)


def records(noise: Noise) -> tuple[Record, ...]:
    """Return records of the loop with the cable, logged at 2 kHz."""
    found = []
    t = TS * np.arange(round(DURATION * RATE))
    for k, (role, waves) in enumerate(MOTIONS):
        machine = Machine(CALIBRATED, windage=noise.windage, sensor=noise.sensor, bias=(STIFFNESS, REST), seed=100 + k)
        seen = machine.run(Given(sum(a * np.sin(2 * np.pi * f * t) for f, a in waves)))
        mean = {n: seen[n].reshape(-1, EVERY).mean(axis=1) for n in ("u", "y")}
        found.append(
            record_of(
                f"{'val' if role == VALIDATION else 'id'}_{k + 1}",
                role,
                Plant(ONE_MASS, rotary=False),
                t.reshape(-1, EVERY).mean(axis=1),
                {"force": mean["u"], "position": mean["y"] * METRE},
                {},
                " and ".join(f"{f:g} Hz of {a:g} V" for f, a in waves),
            )  # fmt: skip
        )
    return tuple(found)


def inverses(noise: Noise):
    return inverse_dynamics(records(noise), BANDWIDTH)
