"""Parameters with intervals from records: separable least squares on inverse dynamics, and what the data do not determine."""

from workbench.public import handed_on

HELD = {
    "Estimate": "result",
    "Fit": "result",
    "HeldOut": "cross_validation",
    "NoValue": "solve",
    "Problem": "problem",
    "Solution": "solve",
    "curve_of": "curves",
    "fitted_on": "fit",
    "identify": "fit",
    "known_together": "intervals",
    "series_of": "fit",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
