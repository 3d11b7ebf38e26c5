"""Inverse dynamics: the drive that a plant asks for along a measured motion, force by force, and its balances."""

from workbench.public import handed_on

HELD = {
    "Bodies": "bodies",
    "InverseDynamics": "dynamics",
    "force_along": "forces",
    "inverse_dynamics": "dynamics",
    "predicted": "balances",
    "required": "balances",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
