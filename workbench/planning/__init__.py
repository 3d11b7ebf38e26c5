"""Which motion to record next: trajectories that determine the declared parameters, or part two effects.

records ─► envelope_of (what the axis may do), sensing_of (how well its log sees) ─► pool of motions
pool, plant ─► design: picks that make the covariance small, joined ─► Plan ─► prospects (a sentence a parameter)
pool, two effects ─► separate: the motion along which they lie furthest apart ─► Separation
"""

from workbench.planning.envelope import Envelope, Sensing, envelope_of, load_rest, sensing_of
from workbench.planning.prospect import Prospect, prospects
from workbench.planning.selection import Plan, design
from workbench.planning.separation import Separation, separate

__all__ = [
    "Envelope", "Plan", "Prospect", "Sensing", "Separation", "design", "envelope_of", "load_rest", "prospects", "sensing_of", "separate",
]  # fmt: skip
