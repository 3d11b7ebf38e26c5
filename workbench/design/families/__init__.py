"""Controllers with free numbers: how a point of a search becomes a controller, and what its linearisations say."""

from workbench.public import handed_on

HELD = {
    "Family": "family",
    "GainTable": "gain_table",
    "Judge": "linear",
    "Linear": "linear",
    "OfFamily": "family",
}

__all__ = [*HELD]
__getattr__, __dir__ = handed_on(__name__, HELD)
