"""Records too long to be held at once: banks of operators fitted from streamed blocks of columns."""

from workbench.public import handed_on

HELD = {
    "fit_operators": "stream",
    "identify_bank": "bank",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
