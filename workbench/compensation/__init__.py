"""A named effect, cancelled: compensation from the one definition of the effect, as a part of the control law.

    u = law(r, y, ...) + g D[L[F(p)]]      a force F of the plant, on a position p: measured, asked for, or observed
    r' = r + g (E(r) - r)                  an error E of the angle, undone where the reference enters

L is a first-order low pass, D a delay of whole samples, g a gain. The composed law is one SX program like any other: it
runs in lanes, in the oracle, in a contest and in tables of robustness.
"""

from workbench.compensation.compensator import OBSERVED, READ, REFERENCE, SOURCES, Compensator, compensable, undone
from workbench.compensation.law import Compensated, compensated
from workbench.compensation.prediction import agreement, predicted

__all__ = [
    "OBSERVED",
    "READ",
    "REFERENCE",
    "SOURCES",
    "Compensated",
    "Compensator",
    "agreement",
    "compensable",
    "compensated",
    "predicted",
    "undone",
]
