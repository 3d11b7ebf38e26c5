"""What a count of an encoder makes of the drive that a plant asks for: a slow axis goes from count to count."""

from dataclasses import replace

import numpy as np

from workbench.inverse.balances import required
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import motion
from workbench.plant import Plant
from workbench.record import Record
from workbench.residual.noise_floor import ENCODERS

NEAR = 5.0  # periods of the evaluation band about a step of an encoder, in which the filters let it show


def edge(p: InverseDynamics, plant: Plant) -> float:
    """Return by how much, N*m or N, the drive that a plant asks for changes at most where an encoder goes on by one count; 0 without counts.

    A slow axis goes from count to count, each of which is a jerk of what inertia asks for, far outside what is usual where it stands. Friction,
    which would turn by its whole level, is left out.
    """
    m, record = p.motion, p.motion.record
    after = np.arange(m.u.size) >= m.u.size // 2
    width = round(NEAR / m.filter.bandwidth / m.dt)
    near = slice(max(0, m.u.size // 2 - width), m.u.size // 2 + width)
    smooth = replace(plant, effects=tuple(e for e in plant.effects if not (e.states or "dir" in e.reads)))

    def asked(record: Record) -> np.ndarray:
        """Return the drive that is asked for on a record, behind the evaluation filter."""
        return m.filter(required(InverseDynamics(motion(record, m.filter.bandwidth)), smooth))

    alone, largest = asked(record), 0.0
    for name, count in record.resolution.items():
        if name in ENCODERS and name in record.channels and count > 0.0:
            read = record.channels[name] + count * after
            change = asked(replace(record, channels={**record.channels, name: read})) - alone
            largest = max(largest, float(np.abs(change[near]).max()))
    return largest
