"""Controllers as data: a law, its numbers and its tables. What runs them is workbench.simulation."""

from workbench.control.drive import drive_cascade
from workbench.control.law import Controller, Law
from workbench.control.laws import RULES, fixed_pd, pi_cascade, scheduled_pd
from workbench.control.named import law_named
from workbench.control.profile import FeedForward, profile_pi
from workbench.control.table import Table, gains_at, grid

__all__ = [
    "RULES",
    "Controller",
    "FeedForward",
    "Law",
    "Table",
    "drive_cascade",
    "fixed_pd",
    "gains_at",
    "grid",
    "law_named",
    "pi_cascade",
    "profile_pi",
    "scheduled_pd",
]
