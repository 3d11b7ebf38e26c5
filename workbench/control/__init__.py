"""Controllers as data: a law, its numbers and its tables. What runs them is workbench.simulate."""

from workbench.control.law import Controller, Law
from workbench.control.laws import RULES, fixed_pd, pi_cascade, scheduled_pd
from workbench.control.table import Table, gains_at, grid

__all__ = ["RULES", "Controller", "Law", "Table", "fixed_pd", "gains_at", "grid", "pi_cascade", "scheduled_pd"]
