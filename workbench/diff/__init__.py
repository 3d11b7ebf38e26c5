"""What changed between two campaigns of one axis: before and after a repair, cold and warm."""

from workbench.diff.changes import Change, Difference, compare
from workbench.diff.comparable import check_models, doubts

__all__ = ["Change", "Difference", "check_models", "compare", "doubts"]
