"""Operator banks of hysteresis and creep (Prandtl-Ishlinskii): what they do to a motion, and their weights from one.

    F[x] = k0 x + sum_i k_i (x - play_ri[x]) + sum_j c_j (x - l_j[x]),   dl_j/dt = rate_j (x - l_j)

All weights at or above 0 make it passive: x - play is a spring that slips (a Maxwell-slip element), x - l a spring that
creeps. The literature's a x + sum wb_i play_i + sum wc_j l_j is the same operator with a = k0 + sum k + sum c, wb = -k and
wc = -c: negative weights there are passive elements here.
"""

from workbench.hysteresis.bank import Bank
from workbench.hysteresis.fit import Fitted, nonnegative, pruned, shaped

__all__ = ["Bank", "Fitted", "nonnegative", "pruned", "shaped"]
