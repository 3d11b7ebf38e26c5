"""What cancelling a named effect is worth in the loop: along a slow motion, in the closed loop of a trace, and in a contest."""

from workbench.public import handed_on

HELD = {
    "Cancellation": "worth",
    "Cancelled": "closed",
    "Slow": "following",
    "Worth": "following",
    "cancellation_worth": "worth",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
