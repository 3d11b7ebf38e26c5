"""What every controller is asked to do: the same steps with the same limits, their cost, and the physical bound beside them."""

from workbench.public import handed_on

HELD = {
    "Figures": "stepping",
    "Task": "task",
    "Weights": "task",
    "figures_of": "stepping",
    "time_optimal": "bound",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
