"""PD gains at each amplitude of the equivalent linear axis: the fastest within stated limits, on the exact sampled loop."""

from workbench.tuning.gains import Gains
from workbench.tuning.goal import TuningGoal
from workbench.tuning.measured import tune_within
from workbench.tuning.tuning import OutOfReach, tune

__all__ = ["Gains", "OutOfReach", "TuningGoal", "tune", "tune_within"]
