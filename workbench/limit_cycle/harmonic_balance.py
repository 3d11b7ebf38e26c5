"""Limit cycles predicted: harmonic balance of the sampled loop with the friction's equivalents.

For y = A cos(w t) friction is a spring k_e(A, w) and a loss c_e w(A, w), the command its first harmonic -C y, and the loop is
linear: its zero-order hold, delay and velocity filter are exact. A limit cycle is where

    D(A, theta) = 1 + C(A, theta) P(theta; k_e, c_e) = 0,   theta = w Ts

Each root is then followed as further harmonics join the balance, and counts where they leave it: see `further`.
"""

from dataclasses import dataclass

import numpy as np

from workbench.limit_cycle.axis import COUNTS, Axis
from workbench.limit_cycle.describing import Command
from workbench.limit_cycle.further import Cycle, refined
from workbench.tuning import sampled

AMPLITUDES, THETAS = 36, 72
PHASES = 64  # of a cycle, of the command
LOWEST, HIGHEST = 2e-3, 3.0  # theta, rad a sample
NEWTON = 20
BESIDE = 0.3  # of a cell: a root may lie as far outside, since D bends; two cells may then find one root
HOLLOW = 0.03  # |D| at a point of the grid beside which two roots may hide
CLEARLY = (
    2.0  # times as large as there |D| is beside: where amplitude matters not, the loop is linear and no two roots hide
)
PAIR = (1.0 / 1.15, 1.15)  # amplitudes over that of the point, from which they are sought
SAME = 1e-3  # relative difference of amplitude and frequency below which two roots are one


@dataclass(frozen=True, eq=False)
class Balance:
    """axis: with the loop. amplitude (n, 1), theta (f,): the grid. response (n, f): P from torque to position."""

    axis: Axis
    amplitude: np.ndarray
    theta: np.ndarray
    response: np.ndarray

    @property
    def rate(self) -> np.ndarray:
        """vh over y on the grid, 1/s, (f,)."""
        return sampled.difference(self.theta, self.axis.clock) / self.axis.loop.sample_time

    def describing(self, law: Command) -> np.ndarray:
        """Return C (n, f) on the grid: the first harmonic of the command over that of the reading, negative."""
        q = self.amplitude[:, :, None].astype(complex)
        return -law(q, q * self.rate[None, :, None], np.ones(1), self.theta[None, :], PHASES)[..., 0] / self.amplitude

    def cycles(self, law: Command) -> tuple[Cycle, ...]:
        """Return the limit cycles of a law, the smallest first."""
        d = 1.0 + self.describing(law) * self.response
        roots = [self._root(d, i, j) for i, j in zip(*_candidates(d), strict=True)]
        found = [refined(self.axis, law, *root) for root in roots if root is not None]
        hidden = [r for i, j in zip(*_hollows(d), strict=True) for r in self._beside(i, j)]
        found += [refined(self.axis, law, *r, root=False) for r in hidden]
        found = sorted((c for c in found if c is not None), key=lambda c: c.amplitude)
        return tuple(c for k, c in enumerate(found) if k == 0 or not _same(found[k - 1], c))

    def _root(self, d: np.ndarray, i: int, j: int) -> tuple[float, float] | None:
        """Solve D = 0 about one cell, bilinear in log A and log theta: (A, w), or None."""
        root = _bilinear(d[i, j], d[i + 1, j], d[i, j + 1], d[i + 1, j + 1])
        if root is None:
            return None
        a, t = self.amplitude[:, 0], self.theta
        amplitude = float(a[i] * (a[i + 1] / a[i]) ** root[0])
        return amplitude, float(t[j] * (t[j + 1] / t[j]) ** root[1]) / self.axis.loop.sample_time

    def _beside(self, i: int, j: int) -> list[tuple[float, float]]:
        """Return where the pair of roots may be that two amplitudes have near a point of the grid: (A, w) each."""
        omega = float(self.theta[j]) / self.axis.loop.sample_time
        return [(float(self.amplitude[i, 0]) * apart, omega) for apart in PAIR]


def _hollows(d: np.ndarray):
    """Points of the grid at which |D| is small and clearly smaller than beside: of two roots in one cell no part of D need
    change its sign between the corners."""
    size = np.abs(d)
    low = np.zeros(size.shape, dtype=bool)
    inner = size[1:-1, 1:-1]
    sides = (size[:-2, 1:-1], size[2:, 1:-1], size[1:-1, :-2], size[1:-1, 2:])
    low[1:-1, 1:-1] = (inner < HOLLOW) & np.all([CLEARLY * inner < s for s in sides], axis=0)
    for i, j in zip(*_candidates(d), strict=True):  # these roots are seen
        low[max(i - 1, 0) : i + 3, max(j - 1, 0) : j + 3] = False
    return np.nonzero(low)


def _candidates(d: np.ndarray):
    """Cells in which both parts of D change sign."""

    def changes(x):
        signs = np.sign(x)
        return np.abs(signs[:-1, :-1] + signs[1:, :-1] + signs[:-1, 1:] + signs[1:, 1:]) < 4.0

    return np.nonzero(changes(d.real) & changes(d.imag))


def _bilinear(d00, d10, d01, d11):
    """Return (x, y) of the zero of a bilinear complex function in or beside the unit square, or None."""
    x = y = 0.5
    for _ in range(NEWTON):
        value = d00 * (1 - x) * (1 - y) + d10 * x * (1 - y) + d01 * (1 - x) * y + d11 * x * y
        over_x = (d10 - d00) * (1 - y) + (d11 - d01) * y
        over_y = (d01 - d00) * (1 - x) + (d11 - d10) * x
        area = over_x.real * over_y.imag - over_x.imag * over_y.real
        if area == 0.0:
            return None
        dx = -(value.real * over_y.imag - value.imag * over_y.real) / area
        dy = -(over_x.real * value.imag - over_x.imag * value.real) / area
        x, y = x + dx, y + dy
        if abs(dx) + abs(dy) < 1e-10:
            inside = -BESIDE <= x <= 1.0 + BESIDE and -BESIDE <= y <= 1.0 + BESIDE
            return (x, y) if inside else None
    return None


def _same(one: Cycle, other: Cycle) -> bool:
    """Whether two roots are one that two cells have found."""
    near = abs(other.amplitude / one.amplitude - 1.0) < SAME and abs(other.omega / one.omega - 1.0) < SAME
    return near and one.stable == other.stable


def balance(axis: Axis, largest: float) -> Balance:
    """Return the balance of an axis for amplitudes from ten encoder counts to `largest`, rad or m."""
    loop = axis.loop
    amplitude = np.geomspace(COUNTS * (loop.count or largest / 1e6), largest, AMPLITUDES)[:, None]
    theta = np.geomspace(LOWEST, HIGHEST, THETAS)
    stiffness, loss = axis.equivalents(amplitude, theta / loop.sample_time)
    return Balance(axis, amplitude, theta, axis.response(theta, stiffness, loss))
