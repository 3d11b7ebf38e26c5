"""What changed between two campaigns of one axis: before and after a repair, cold and warm.

two campaigns, one model (check_models) ─► each fitted, every value free ─► compare ─► Difference (a Change a parameter)
                                      └──► doubts: where the records themselves are not alike
"""

from workbench.difference.changes import Change, Difference, compare
from workbench.difference.comparable import check_models, doubts

__all__ = ["Change", "Difference", "check_models", "compare", "doubts"]
