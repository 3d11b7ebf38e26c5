"""PD gains at each amplitude of the equivalent linear axis: the fastest within stated limits, on the exact sampled loop."""

from workbench.tuning.axis_gains import TunedAxis, tuned_axis
from workbench.tuning.gains import Gains
from workbench.tuning.goal import TuningGoal
from workbench.tuning.measured import tune_within
from workbench.tuning.tuning import OutOfReach, tune

__all__ = ["Gains", "OutOfReach", "TunedAxis", "TuningGoal", "tune", "tune_within", "tuned_axis"]
