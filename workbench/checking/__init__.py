"""What is wrong with records, said before anything long starts: each check a function of what is seen; the words are in `wording`."""

from workbench.public import handed_on

HELD = {
    "Seen": "seen",
    "check": "checking",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
