"""Limit cycles of the sampled loop: predicted by harmonic balance, confirmed or refuted by simulation, over a region of gains.

Plant ─► axis_of (mass, friction over a cycle) ─► balance (first harmonic, then odd ones) ─► Cycle ─┐
Controller x two factors (dials) ─► command (waveform over a cycle)                                 ├─► region ─► Region
                          └──────► simulated (released from several starts, in lanes) ─► Motion ────┘
"""

from workbench.limit_cycle.axis import Axis, axis_of
from workbench.limit_cycle.describing import command, dials, turned
from workbench.limit_cycle.further import Cycle
from workbench.limit_cycle.gain_region import Region, region
from workbench.limit_cycle.harmonic_balance import Balance, balance
from workbench.limit_cycle.options import Options, regions
from workbench.limit_cycle.simulation import Motion, simulated

__all__ = [
    "Axis",
    "Balance",
    "Cycle",
    "Motion",
    "Options",
    "Region",
    "axis_of",
    "balance",
    "command",
    "dials",
    "region",
    "regions",
    "simulated",
    "turned",
]
