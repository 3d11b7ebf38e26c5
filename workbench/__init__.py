"""Optimisation-driven controller design workbench: from measured records of a servo axis to the gains its firmware runs.

    import workbench as wb

    campaign = wb.load("my_campaign")     # a folder with campaign.toml and its records
    print(*wb.check(campaign))            # what is wrong with them
    found = wb.trace(campaign)            # what the declared model lacks
    gains = wb.tune(found, wb.Loop(sample_time=1e-4), amplitudes=[1e-4, 1e-3, 1e-2])

Every name is documented where it is: help(wb.trace). SI throughout. Packages beneath hold what each of these is made of.
"""

__version__ = "0.1.0"

# What `import workbench as wb` hands on, and the module that holds it: imported where it is first asked for. The file
# __init__.pyi beside this one says the same to editors and type checkers.
HELD = {
    "Loop": "workbench.simulation.scenario",
    "Parameter": "workbench.parameter",
    "Plant": "workbench.plant",
    "Record": "workbench.record",
    "Scenario": "workbench.simulation.scenario",
    "TuningGoal": "workbench.tuning.goal",
    "check": "workbench.front.fitting",
    "compensate": "workbench.front.loops",
    "describe": "workbench.front.loops",
    "diff": "workbench.front.fitting",
    "effect": "workbench.definition",
    "export": "workbench.exporting",
    "find": "workbench.definition",
    "fit_schedule": "workbench.front.loops",
    "identify": "workbench.front.fitting",
    "load": "workbench.campaign",
    "open_loop": "workbench.simulation.closed",
    "plan": "workbench.front.motions",
    "response": "workbench.front.motions",
    "separate": "workbench.front.motions",
    "simulate": "workbench.front.loops",
    "trace": "workbench.front.fitting",
    "tune": "workbench.front.loops",
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
