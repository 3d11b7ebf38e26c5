"""PD gains at each amplitude of the equivalent linear axis: the fastest within stated limits, on the exact sampled loop."""

from workbench.tune.gains import Gains
from workbench.tune.goal import TuningGoal
from workbench.tune.measured import tune_within
from workbench.tune.tuning import OutOfReach, tune

__all__ = ["Gains", "OutOfReach", "TuningGoal", "tune", "tune_within"]
