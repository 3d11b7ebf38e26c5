"""Gains of a closed drive: one set a size of move, robust on its linear loops, beside the scheduled law."""

from workbench.public import handed_on

HELD = {
    "ComparedDrive": "comparison",
    "ClosedDrive": "gains",
    "DriveGains": "gains",
    "compared_drive": "comparison",
    "tune_drive": "search",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
