"""Optimisation-driven controller design workbench: from measured records of a servo axis to the gains its firmware runs."""

__version__ = "0.1.0"


def __getattr__(name: str):
    """Import `workbench.trace` where it is used: it can be called (workbench.trace(fit, passes))."""
    if name == "trace":
        from importlib import import_module

        return import_module("workbench.trace")
    raise AttributeError(f"module 'workbench' has no attribute '{name}'")
