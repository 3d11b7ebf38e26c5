"""A plant that follows a reference: the record that it would leave, without noise."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from workbench.definition import Effect
from workbench.inverse.balances import balances, predicted
from workbench.inverse.dynamics import LOAD_DRIVE, InverseDynamics
from workbench.motion import motion
from workbench.planning.envelope import Sensing
from workbench.planning.joint import deflection
from workbench.planning.motions import Reference
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, Record, Source

SOURCE = Source(Path("planned"), "", "planned", {})


def followed(reference: Reference, plant: Plant, sensing: Sensing) -> InverseDynamics:
    """Return the inverse dynamics over the record of a plant whose encoder reads the reference: the drive that this takes.

    Of two masses the load follows the reference, and the motor is where the joint needs it; what no deflection balances is
    taken for a drive of the load, so that the plant explains its own record. Raises WorkbenchError where an
    effect reads a channel that a plan does not have.
    """
    given = np.array(reference.position)
    if plant.kind == ONE_MASS:
        inverse = _recorded(reference, plant, sensing, {"position": given})
    else:

        def make(deflection: np.ndarray) -> InverseDynamics:
            positions = {"position": given + deflection, "load_position": given.copy()}
            return _recorded(reference, plant, sensing, positions)

        inverse = make(deflection(plant, make, sensing.counts, given.size))
    return _driven(inverse, predicted(inverse, plant), balances(inverse, plant)[1:])


def _recorded(
    reference: Reference, plant: Plant, sensing: Sensing, positions: dict[str, np.ndarray]
) -> InverseDynamics:
    """Return the inverse dynamics over a record of these positions, its drive zero."""
    channel = "torque" if plant.rotary else "force"
    channels = {channel: np.zeros(reference.position.size), **positions}
    counts = dict.fromkeys(positions, sensing.counts)
    record = Record("planned", IDENTIFICATION, reference.time, channels, {}, SOURCE, counts)
    return InverseDynamics(motion(record, sensing.bandwidth))


def _driven(inverse: InverseDynamics, drive: np.ndarray, of_load: np.ndarray) -> InverseDynamics:
    """Return the inverse dynamics over the same motion under another drive (n,). of_load: that of the load, (0 or 1, n)."""
    m = inverse.motion
    channel = "torque" if "torque" in m.record.channels else "force"
    channels = {**m.record.channels, channel: drive}
    if len(of_load):
        channels[LOAD_DRIVE] = of_load[0]
    record = replace(m.record, channels=channels)
    return InverseDynamics(replace(m, record=record, u=drive))


def with_effect(plant: Plant, effect: Effect) -> Plant:
    """Return the plant with an effect: in place of the one of the same name and place, or added."""
    return plant.swap(effect) if effect.key in (e.key for e in plant.effects) else plant + effect
