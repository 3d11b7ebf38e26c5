"""Output error: a loop, or the drive alone, simulated and compared with what was measured, and parameters moved until it agrees."""

from workbench.public import handed_on

HELD = {
    "FreeRun": "free_run",
    "Rerun": "rerun",
    "refine_free_run": "free_run",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
