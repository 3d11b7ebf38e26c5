"""One measured record: frozen, SI, with its source."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from types import MappingProxyType

import numpy as np

IDENTIFICATION, VALIDATION = "identification", "validation"
ROLES = (IDENTIFICATION, VALIDATION)


@dataclass(frozen=True)
class Source:
    """Where a record came from: path as given, sha256 of the bytes read, reader, and channel -> column."""

    path: Path
    sha256: str
    reader: str
    columns: Mapping[str, str]


MADE = Source(Path("made"), "", "made", {})  # of a record that a program made, and no file holds


@dataclass(frozen=True)
class Payload:
    """What was added to the axis (to its load) for a record, and is known: inertia a + mgl sin(q + phase) beside the model.

    inertia: kg*m^2 or kg. mgl: N*m, its weight times the lever; rotary axes only. phase: rad.
    """

    inertia: float = 0.0
    mgl: float = 0.0
    phase: float = 0.0

    def force(self, q: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Return the torque or force (n,) that it takes."""
        return self.inertia * a + self.mgl * np.sin(q + self.phase)


@dataclass(frozen=True, eq=False)
class Record:
    """Channels sampled at one uniform rate.

    name: the file's stem. role: "identification" or "validation". time: (n,) s, the bench clock, uniform.
    channels: name -> (n,) array in SI; "torque" or "force", "position", and further channels as measured.
    units: name -> SI unit string, of drive and positions known without. resolution: name -> encoder step in SI, where known. locked: the load is held.
    counts_from: s; before it no error counts: earlier samples only bring operators with memory into their state. zero: rad
    or m that was added to load_position because the two encoders' zeros lie apart; None where they are one. payload: what
    was added to the axis, or None. history: rad or m by which the axis moved before, from relaxed friction; None where nobody
    knows. found: the same, as a fit found it where nobody knows. unseen: spans of time, s, in which a log that was put on one rate has no
    sample. All arrays are made read-only.
    """

    name: str
    role: str
    time: np.ndarray
    channels: Mapping[str, np.ndarray]
    units: Mapping[str, str] = field(default_factory=dict)
    source: Source = MADE
    resolution: Mapping[str, float] = field(default_factory=dict)
    motion: str = ""
    locked: bool = False
    counts_from: float = -inf
    zero: float | None = None
    payload: Payload | None = None
    history: float | None = 0.0
    found: float | None = None
    unseen: tuple[tuple[float, float], ...] = ()

    def __post_init__(self):
        for array in (self.time, *self.channels.values()):
            array.setflags(write=False)
        rotary = "force" not in self.channels
        known = {
            "torque": "N*m",
            "force": "N",
            **dict.fromkeys(("position", "load_position"), "rad" if rotary else "m"),
        }
        object.__setattr__(self, "units", {n: u for n, u in known.items() if n in self.channels} | dict(self.units))
        for name in ("channels", "units", "resolution"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))

    @property
    def dt(self) -> float:
        """Sample time in s."""
        return float((self.time[-1] - self.time[0]) / (self.time.size - 1))

    @property
    def drive(self) -> np.ndarray:
        """The drive's torque or force as reported, in N*m or N."""
        return self.channels["torque" if "torque" in self.channels else "force"]
