"""Records and simulations: what an assumed plant would have logged as a record, marked as such, and what a record gives a simulation."""

import hashlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from workbench.plant import Plant
from workbench.record import Record, Source
from workbench.simulation.given import TEMPERATURE

MARK = "simulated by this study"


def record_of(
    name: str, role: str, plant: Plant, time: np.ndarray, channels: Mapping[str, np.ndarray], counts: Mapping[str, float],
    motion: str, *, locked: bool = False,
) -> Record:  # fmt: skip
    """Return a record of simulated channels: the drive ("torque" or "force") and positions, SI. counts: channel -> one
    encoder count, rad or m."""
    effort, x = plant.effort, plant.displacement
    held = {n: np.ascontiguousarray(v, dtype=float) for n, v in channels.items()}
    digest = hashlib.sha256(b"".join(n.encode() + v.tobytes() for n, v in held.items())).hexdigest()
    return Record(
        name=name,
        role=role,
        time=np.ascontiguousarray(time, dtype=float),
        channels=held,
        units={n: effort if n in ("torque", "force") else x for n in held},
        source=Source(Path(f"{name} ({MARK})"), digest, MARK, {n: n for n in held}),
        resolution=dict(counts),
        motion=f"{MARK}: {motion}",
        locked=locked,
    )


def temperature_of(plant: Plant, record: Record) -> np.ndarray | None:
    """Return the temperature (n,) that was logged, in K, where something of a plant reads it; None else."""
    return record.channels.get(TEMPERATURE) if any(TEMPERATURE in e.reads for e in plant.effects) else None
