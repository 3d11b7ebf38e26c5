"""From a symbolic step to machine speed: CasADi graph -> scalar instructions -> NumPy or one numba kernel, same bits."""

from workbench.public import handed_on

HELD = {
    "Choice": "choice",
    "Definition": "step",
    "Line": "program",
    "Program": "program",
    "apply": "step",
    "build": "step",
    "evaluate": "arrays",
    "load": "cache",
    "map_lanes": "lanes",
    "read": "program",
    "symbols": "step",
    "view": "step",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
