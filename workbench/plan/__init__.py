"""Which motion to record next: trajectories that determine the declared parameters, or part two effects."""

from workbench.plan.envelope import Envelope, Sensing, envelope_of, sensing_of
from workbench.plan.separate import Separation, separate

__all__ = ["Envelope", "Sensing", "Separation", "envelope_of", "sensing_of", "separate"]
