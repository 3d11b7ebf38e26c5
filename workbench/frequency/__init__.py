"""Frequency responses of records, their modes, a notch for each, and the loop gain that they allow.

records ─► shaken (which one) ─► response_of ─► Response ─► fit_modes ─► Modes ─► notch_for, flexible_modes (parts of a plant)
                                                   └─► gain_limit, sensitivity_peak: of a loop closed around it
"""

from workbench.frequency.limit import GainLimit, gain_limit, sensitivity_peak
from workbench.frequency.modes import Mode, Modes, fit_modes
from workbench.frequency.notch import Notch, notch_for
from workbench.frequency.parts import flexible_modes
from workbench.frequency.response import Response, response_of, shaken

__all__ = [
    "GainLimit", "Mode", "Modes", "Notch", "Response", "fit_modes", "flexible_modes", "gain_limit", "notch_for",
    "response_of", "sensitivity_peak", "shaken",
]  # fmt: skip
