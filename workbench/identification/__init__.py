"""Parameters with intervals from records: inverse dynamics, separable least squares, and what the data do not determine."""

from workbench.public import handed_on

HELD = {
    "Estimate": "result",
    "Fit": "result",
    "InverseDynamics": "passes",
    "NoValue": "solve",
    "Problem": "problem",
    "Solution": "solve",
    "balances": "passes",
    "curve_of": "curves",
    "fit_operators": "stream",
    "fitted_on": "fit",
    "identify": "fit",
    "identify_bank": "bank",
    "inverse_dynamics": "fit",
    "known_together": "intervals",
    "late_clock": "clocks",
    "predicted": "passes",
    "required": "passes",
    "series_of": "fit",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
