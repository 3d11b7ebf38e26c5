"""What gains are worth: baselines tuned alike, comparison on the same scenarios, and the physical bound beside them."""

from workbench.public import handed_on

HELD = {
    "Checks": "checks",
    "ClosedLoop": "closed_loop",
    "Comparison": "compare",
    "Contest": "contest",
    "Designed": "design",
    "DriveGains": "drive_search",
    "Polished": "polish",
    "Promise": "promise",
    "Recommended": "recommend",
    "Regret": "regret",
    "Result": "contest",
    "Task": "task",
    "Weights": "task",
    "close": "closed_loop",
    "equivalent_of": "equivalent",
    "friction_of": "equivalent",
    "gains_of": "design",
    "regret_of": "worth",
    "tune_drive": "drive_search",
    "verdict": "contest",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
