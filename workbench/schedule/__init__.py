"""Gains over amplitude: a shape-constrained fit at knots even in log2, and what it is worth between them.

Gains (a PD each amplitude) ─► fit_schedule (quadratic program in logs) ─► Schedule (knots, look-up)
                               fewest_knots: the shortest that is close     └─► between_knots, passivity: checks of it
"""

from workbench.schedule.check import BetweenKnots, Passivity, between_knots, passivity
from workbench.schedule.fit import fewest_knots, fit_schedule
from workbench.schedule.table import Schedule

__all__ = ["BetweenKnots", "Passivity", "Schedule", "between_knots", "fewest_knots", "fit_schedule", "passivity"]
