"""The linear loops that a closed drive's gains must be robust on: its current loop's lag, every load and inertia, every spring.

The law's response is that of `control.drive`, its notches included; a measured response joins the cases, stability by a path
of slower gains along which |S| stays within bounds.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from workbench.control.notched import response as notched
from workbench.design.families.family import integrating
from workbench.design.families.linear import Judge
from workbench.frequency import Response
from workbench.frequency.limit import COHERENT
from workbench.simulation import Loop
from workbench.tuning import sampled

SHORTEST = 1e-6  # s: what a current loop without a stated lag has; a sample is a hundred times as long
PATH = np.geomspace(0.05, 1.0, 12)  # slowness of the gains from which stability on a measured response is followed


def slowed(points: np.ndarray, share: np.ndarray | float) -> np.ndarray:
    """Return points (p, 3) of kv, kvp, ki as damped, and slower by `share`: s kv, s kvp, s^2 ki."""
    return points * np.stack([share, share, np.square(share)], axis=-1)


@dataclass(frozen=True, eq=False)
class Lagged(Judge):
    """One mass behind a current loop. inertias, springs (n,): of each case, kg*m^2 or kg, N*m/rad or N/m. viscous: of all.

    lag: time constant of the current loop, s. notches: of the law. measured: a response that joins the cases, with `beside`
    (N*m/rad or N/m) acting beside it.
    """

    loop: Loop
    inertias: np.ndarray
    springs: np.ndarray
    viscous: float
    lag: float
    notches: Sequence = ()
    measured: Response | None = None
    beside: float = 0.0

    @cached_property
    def position(self) -> np.ndarray:
        """Responses (n, f) from command to position, x = [q, v, u'], the notches before them."""
        a = np.zeros((self.inertias.size, 4, 4))
        a[:, 0, 1] = 1.0
        a[:, 1, 0], a[:, 1, 1], a[:, 1, 2] = -self.springs / self.inertias, -self.viscous / self.inertias, 1.0 / self.inertias  # fmt: skip
        a[:, 2, 2], a[:, 2, 3] = -1.0 / max(self.lag, SHORTEST), 1.0 / max(self.lag, SHORTEST)
        plain = sampled.forced(a, self.theta, self.clock)[..., 0]
        return plain * notched(self.notches, self.theta, self.loop.sample_time)

    @property
    def speed(self) -> np.ndarray:
        return self.position

    @property
    def own(self) -> np.ndarray:
        return np.where(self.springs > 0.0, 0, 1 if self.viscous > 0.0 else 2)

    def sensitivity(self, points: np.ndarray) -> np.ndarray:
        """Return Ms (p,) of points (p, 3) of kv, kvp, ki: the largest over the cases and the measured response."""
        kv, kvp, ki = (points[:, k : k + 1] for k in range(3))
        inner = integrating(self.theta, kvp, ki, self.loop.sample_time)
        found = self.peak(inner * kv, inner, integrators=1)
        return found if self.measured is None else np.maximum(found, self._on_measured(points))

    def _on_measured(self, points: np.ndarray) -> np.ndarray:
        """Ms over the measured lines, the largest along the path from slow gains on, whose loop is stable."""
        theta, seen = self._lines
        kv, kvp, ki = np.moveaxis(slowed(points[:, None, :], PATH[None, :]), -1, 0)[..., None]
        law = integrating(theta, kvp, ki, self.loop.sample_time) * (kv + sampled.difference(theta, self.clock) / self.loop.sample_time)  # fmt: skip
        return np.max(1.0 / np.abs(1.0 + law * seen), axis=(1, 2))

    @cached_property
    def _lines(self) -> tuple[np.ndarray, np.ndarray]:
        """(theta, position over command) of the coherent lines: held, delayed, lagged and notched; below the Nyquist frequency."""
        theta = self.measured.omega * self.loop.sample_time
        sure = (self.measured.coherence >= COHERENT) & (theta < np.pi)
        theta, seen = theta[sure], self.measured.receptance[sure]
        seen = seen / (1.0 + self.beside * seen) * notched(self.notches, theta, self.loop.sample_time)
        late = np.sinc(theta / (2 * np.pi)) * np.exp(-1j * theta * (0.5 + self.clock.whole + self.clock.part))
        return theta, seen * late / (1.0 + 1j * theta * self.lag / self.loop.sample_time)
