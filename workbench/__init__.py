"""Optimisation-driven controller design workbench: from measured records of a servo axis to the gains its firmware runs."""

__version__ = "0.1.0"

# What `import workbench as wb` hands on, and the module that holds it: imported where it is first asked for.
HELD = {
    "trace": "workbench.tracing.tracing",
}

__all__ = ["__version__", *HELD]


def __getattr__(name: str):
    """Return a name of the front door, importing the module that holds it."""
    if name not in HELD:
        raise AttributeError(f"module 'workbench' has no attribute '{name}'; it hands on {', '.join(sorted(HELD))}")
    from importlib import import_module

    return getattr(import_module(HELD[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
