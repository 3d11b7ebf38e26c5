"""What gains are worth: controllers compared on the same scenarios, checked, and recommended; the loop of a trace, closed."""

from workbench.public import handed_on

HELD = {
    "Checks": "checks",
    "ClosedLoop": "closed_loop",
    "Comparison": "compare",
    "Contest": "contest",
    "Judged": "judged",
    "Promise": "promise",
    "Recommended": "recommend",
    "Result": "contest",
    "close": "closed_loop",
    "verdict": "wording",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
