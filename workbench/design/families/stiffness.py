"""The stiffest Kp along ratios Kp/Kd, with a velocity filter and a notch of the law's own: exact at every point that a search asks for.

    Kp(r) = the largest with |S| <= Ms for L = Kp (1 + V/r) N P, sliding and on the stiffest spring    (`tuning.reach`)

V: of the filtered difference, N: of the notch. A grid over ratio, filter, centre and depth, to be interpolated, would be larger than all
that a search asks for.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from workbench.design.families.linear import Linear
from workbench.design.families.shaped import judged_by
from workbench.tuning.reach import stiffest_along

# Frequencies, rad a sample: a loop as stiff as |S| allows crosses over above a tenth of a rad a sample, for the delay stops it. Kp is known to 1e-3 at
# 99 of 100 points; with half as many to 4e-3, with twice as many to 2e-4. At the rest, beside the largest ratio, Kp jumps, and what is then too
# stiff is refused by its |S|, which a search asks for anyway.
LOWEST, LINES = 0.01, 300
SOFTEST = 1e-3  # a sample: the least ratio, under which a loop takes a thousand samples
KEPT = 10000  # largest ratios that are kept at most
COARSE, CLOSE = 16, 8  # ratios at which the largest of all is sought, and then about it: it is known to 8 %


@dataclass(frozen=True, eq=False)
class _Fine(Linear):
    """Linearisations over frequencies close enough for the peak between two of them."""

    @cached_property
    def theta(self) -> np.ndarray:
        return np.geomspace(LOWEST, np.pi, LINES)


@dataclass(frozen=True, eq=False)
class Stiffness:
    """linear: linearisations of one mass. sensitivity: Ms. Points own (p, 3): velocity filter s, centre of the notch Hz, its depth."""

    linear: Linear
    sensitivity: float

    @cached_property
    def _fine(self) -> _Fine:
        known = self.linear
        return _Fine(known.loop, known.inertia, known.viscous, known.stiffnesses)

    @property
    def least(self) -> float:
        """The least ratio, 1/s."""
        return SOFTEST / self.linear.loop.sample_time

    def along(self, ratio: np.ndarray, own: np.ndarray) -> np.ndarray:
        """Return the stiffest Kp (p, m), N*m/rad or N/m, at ratios (p, m), 1/s, with filters and notches (p, 3)."""
        fine, dt = self._fine, self.linear.loop.sample_time
        met = judged_by(fine, own)
        above = fine.theta > dt * np.sqrt(fine.stiffnesses / fine.inertia)[:, None]
        each = zip(met.rate, met.passed, np.broadcast_to(ratio, (len(own), ratio.shape[1])), strict=True)
        most = [
            stiffest_along(fine.position * n, v, np.ascontiguousarray(r), above, self.sensitivity) for v, n, r in each
        ]
        # of a slow loop no frequency may limit Kp: then it is one that the law may have at half the sampling rate
        free = 1.0 / np.abs(fine.position[:, -1]).max()
        return np.where(np.isfinite(most), most, free)

    def largest(self, own: np.ndarray) -> np.ndarray:
        """Return the ratio (p,) at which the stiffest Kp is largest: beyond, damping is short and Kp has to fall again."""
        keys = [row.tobytes() for row in own]
        new = {k: i for i, k in enumerate(keys) if k not in self._known}
        if len(self._known) > KEPT:
            self._known.clear()
            new = {k: i for i, k in enumerate(keys)}
        if new:
            self._known.update(zip(new, self._largest(own[list(new.values())]), strict=True))
        return np.array([self._known[k] for k in keys])

    @cached_property
    def _known(self) -> dict[bytes, float]:
        """Of filters and notches: most points of a search differ in their ratios alone."""
        return {}

    def _largest(self, own: np.ndarray) -> np.ndarray:
        known = np.geomspace(10.0 * self.least, 1e3 * self.least, COARSE)[None]
        first = known[0, self.along(known, own).argmax(axis=1)]
        about = first[:, None] * np.geomspace(*(known[0, :2] / known[0, 1::-1]), CLOSE)
        return np.take_along_axis(about, self.along(about, own).argmax(axis=1)[:, None], axis=1)[:, 0]
