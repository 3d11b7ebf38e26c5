"""A family with a velocity filter and a notch of its own among its numbers, tuned with the gains.

    velocity_filter (s): time constant of the filtered difference that the law reads as speed
    notch (Hz), notch depth: of N behind the law (`control.notched`); |S| = 1/|1 + N (C_q P_q + C_v P_v)|

A filter as fast as the loop allows costs the least phase, a slow one takes a resonance out of the speed; a notch takes it out of
the command. At a depth of 1 there is no notch. Its width is fixed at that of the widest notch that is proposed for a mode: the
load moves a resonance further than any narrow one would follow. On the two masses of FHA-8C-50, with and without a disc, a fixed PD
of Kp/Kd = 56/s then keeps Ms = 2 up to 750 N*m/rad; with a damping of 0.5 up to 680, of 1 up to 840, without a notch up to 415.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np

from workbench.control.notched import notched, response
from workbench.design.families.family import Family, pd_family
from workbench.design.families.linear import Judge
from workbench.frequency.notch import DAMPEST

FILTER, NOTCH = ("velocity_filter",), ("notch", "notch depth")
FASTEST, SLOWEST = 0.2, 64.0  # samples: range of the filter; at a fifth of one it passes 99 % of a new difference
LOW, HIGH = 0.01, 0.45  # of the sampling rate: where a notch may lie
WIDE, STEEP = 16.0, 100.0  # of `stiffest`: range of log Kp each way, cost of Ms
DEEPEST = 0.05  # of a notch at its centre


@dataclass(frozen=True, eq=False)
class Shaped(Judge):
    """Linearisations as a law meets them that filters the speed by itself, and has a notch. velocity_filter (points, 1), s.
    notch: with centre, damping, depth (points, 1), or None."""

    base: Judge
    velocity_filter: np.ndarray
    notch: SimpleNamespace | None

    @property
    def loop(self):
        return self.base.loop

    @property
    def theta(self) -> np.ndarray:
        return self.base.theta

    @property
    def rate(self) -> np.ndarray:
        """Response (points, f) of the law's own filtered difference."""
        return self.base.rate_of(self.velocity_filter)

    @property
    def passed(self) -> np.ndarray:
        """Response of the notch, (points, f), or 1."""
        if self.notch is None:
            return np.ones((1, 1))
        return response([self.notch], self.theta, self.loop.sample_time)

    def peak(self, position, speed, integrators=0, velocity_filter=None):
        return self.base.peak(position * self.passed, speed * self.passed, integrators, self.velocity_filter)

    def scheduled_peak(self, knots, kp, kd, velocity_filter=None, behind=None):
        own = self.passed if self.notch is not None else None
        return self.base.scheduled_peak(knots, kp, kd, self.velocity_filter, own)


def shaped(
    make: Callable[[Judge], Family], judge: Judge, velocity_filter: float, notch: tuple[float, float] | None = None
) -> Family:
    """Return the family that `make` makes for a judge, with its filter and notch among its numbers.

    velocity_filter: s, where the search for it begins. notch: (Hz, depth), likewise; without it there is none.
    """
    base, dt = make(judge), judge.loop.sample_time
    rows = [(FASTEST * dt, velocity_filter, SLOWEST * dt)]
    if notch is not None:
        rows += [(LOW / dt, notch[0], HIGH / dt), (DEEPEST, notch[1], 1.0)]
    lower, start, upper = np.array(rows).T
    count = base.start.size

    def parts(points):
        own = points[:, count:]
        return points[:, :count], own[:, 0], own[:, 1:] if notch is not None else None

    def controller(points, lanes):
        gains, filtered, behind = parts(points)
        made = replace(base.controller(gains, lanes), velocity_filter=np.repeat(filtered, lanes))
        return made if behind is None else notched(made, notches(behind, lanes=lanes), dt)

    def sensitivity(points):
        gains, filtered, behind = parts(points)
        each = None if behind is None else notches(behind, (-1, 1))
        return make(Shaped(judge, filtered[:, None], each)).sensitivity(gains)

    return replace(
        base,
        numbers=(*base.numbers, *FILTER, *(NOTCH if notch is not None else ())),
        lower=np.append(base.lower, lower),
        upper=np.append(base.upper, upper),
        start=np.append(base.start, start),
        soft=None if base.soft is None else np.append(base.soft, start),
        controller=controller,
        sensitivity=sensitivity,
    )


def stiffest(
    judge: Judge, ratio: float, sensitivity: float, seed: int = 1, *, population: int = 12, generations: int = 80
) -> dict[str, float]:
    """Return kp, velocity_filter, notch and notch depth with which a fixed PD of Kp/Kd = ratio, 1/s, is as stiff as |S| allows.

    Where a search on the simulated loop begins: of linearisations alone this takes a second, and from elsewhere it may end with the
    notch where it does nothing. Differential evolution; SciPy's own settings but the population and its generations.
    """
    from scipy.optimize import differential_evolution

    dt, unit = judge.loop.sample_time, 1.0 / np.abs(judge.position).max()
    begin = 2.0 * dt, (LOW / dt, 0.5)  # bounds are what is taken of it
    family = shaped(lambda one: pd_family(one, (1.0, 1.0 / ratio)), judge, *begin)
    bounds = [(np.log(unit) - WIDE, np.log(unit) + WIDE), *np.log([family.lower[2:], family.upper[2:]]).T]

    def softness(logs: np.ndarray) -> np.ndarray:
        kp, rest = np.exp(logs[0]), np.exp(logs[1:]).T
        peak = family.sensitivity(np.column_stack([kp, kp / ratio, rest]))
        return STEEP * np.clip(peak / sensitivity - 1.0, 0.0, 10.0) - logs[0]

    found = differential_evolution(
        softness, bounds, popsize=population, maxiter=generations, polish=False, vectorized=True, updating="deferred",
        rng=np.random.default_rng(seed),
    )  # fmt: skip
    return dict(zip(("kp", *FILTER, *NOTCH), map(float, np.exp(found.x)), strict=True))


def judged_by(judge: Judge, own: np.ndarray) -> Judge:
    """Return the linearisations as laws meet them with filters and notches own (points, 3): s, Hz, depth."""
    return Shaped(judge, own[:, :1], notches(own[:, 1:], (-1, 1)))


def judged(judge: Judge, numbers: Mapping[str, float]) -> Judge:
    """Return the linearisations as a tuned law meets them. numbers: of a shaped family's point, by name."""
    behind = None
    if NOTCH[0] in numbers:
        behind = notches(np.array([[numbers[n] for n in NOTCH]]), (-1, 1))
    return Shaped(judge, np.array([[numbers[FILTER[0]]]]), behind)


def notches(numbers: np.ndarray, shape=-1, lanes: int = 1) -> SimpleNamespace:
    """Return notches of numbers (points, 2), centre and depth, each repeated for so many lanes, in a shape."""
    values = {"centre": numbers[:, 0], "damping": np.full(len(numbers), DAMPEST), "depth": numbers[:, 1]}
    return SimpleNamespace(**{n: np.repeat(v, lanes).reshape(shape) for n, v in values.items()})
