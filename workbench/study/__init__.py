"""A study: a campaign, what is asked of it, and what it must reach; run, cached and written whole."""

from workbench.public import handed_on

HELD = {
    "MissingData": "configuration",
    "Outcome": "outcome",
    "Part": "outcome",
    "Requirement": "configuration",
    "Study": "configuration",
    "campaign_of": "configuration",
    "limit_cycles": "limit_cycle",
    "run": "running",
    "steps_of": "running",
    "with_part": "outcome",
    "write_gains": "gains",
    "write_table": "gains",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
