"""The angle between two encoders: the deflection of the joint between them, their zeros, and their clocks."""

from workbench.public import handed_on

HELD = {
    "Late": "clocks",
    "deflection_of": "deflection",
    "late_clock": "clocks",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
