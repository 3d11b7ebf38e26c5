"""A campaign and its study from somebody's log files: what the columns are, in which units, and what the records are for.

Every guess is a value with its reason; what cannot be known from a log (a torque constant, counts a revolution) is
written as assumed, and said to be so until its engineer puts the number in.
"""

from workbench.public import handed_on

HELD = {
    "Guess": "columns",
    "quantum": "signals",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
