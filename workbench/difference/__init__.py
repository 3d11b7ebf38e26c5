"""What changed between two campaigns of one axis: before and after a repair, cold and warm."""

from workbench.difference.changes import Change, Difference, compare
from workbench.difference.comparable import check_models, doubts

__all__ = ["Change", "Difference", "check_models", "compare", "doubts"]
