"""What a controller does on axes that differ: draws, both perspectives, statements with confidence, worst cases kept.

Varied (name, Distribution) ─► Cases (independent, grid or even) ─► work ─► blocks ─► run here or on a cluster ─► joined
columns (controller -> metric -> (cases,)) ─► perspectives, share_beyond, influences; worst cases replay to the same bits
"""

from workbench.robustness.cases import Cases, Varied, even, grid, independent
from workbench.robustness.distribution import Distribution, fixed, log_uniform, normal, uniform
from workbench.robustness.influence import Influence, influences
from workbench.robustness.perspective import Perspectives, Share, perspectives, share_beyond
from workbench.robustness.series import Options, series_of
from workbench.robustness.workload import Block, Work, blocks, joined, work

__all__ = [
    "Block",
    "Cases",
    "Distribution",
    "Influence",
    "Options",
    "Perspectives",
    "Share",
    "Varied",
    "Work",
    "blocks",
    "even",
    "fixed",
    "grid",
    "independent",
    "influences",
    "joined",
    "log_uniform",
    "normal",
    "perspectives",
    "series_of",
    "share_beyond",
    "uniform",
    "work",
]
