"""What the declared model lacks: find the residual, name the effect, add it, and report the error before and after."""

from workbench.public import handed_on

HELD = {
    "Budget": "budget",
    "Cause": "result",
    "Criteria": "criteria",
    "Evidence": "evidence",
    "Trace": "result",
    "Verdict": "decide",
    "calibrate": "power_up",
    "trace": "tracing",
    "trace_campaign": "of_campaign",
    "write": "output",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
