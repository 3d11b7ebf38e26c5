"""A compensated controller in the contest: tuned anew with its compensation by the search that tunes the others, and its margin.

Compensation from the reference closes no path, so the margin is the controller's own. From the measured position it feeds the
named force back: beside friction of equivalent stiffness k(A) the loop meets the plant

    P' = P/(1 - F P),   F = g H (N(A) k_c(A) + b_c s'),   S = 1/(1 + C P')

k_c(A): of what is cancelled, by its describing function; b_c: its linear viscous friction on the filtered velocity s';
N(A): of the dead band of one count (a play operator); H: delay and low pass of the compensation, and its observer.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from workbench.compensation import OBSERVED, REFERENCE, Compensator, compensated
from workbench.control.notched import OWN, behind
from workbench.description.bank import bank_equivalent
from workbench.description.friction import equivalent_of, friction_of
from workbench.design.baselines import baseline_families, best_of, seeds_of
from workbench.design.climb import Climb
from workbench.design.design import Designed, linear_of
from workbench.design.families.family import Family
from workbench.design.families.linear import Judge, Linear, checked, peak_of
from workbench.design.optimise import Tuned
from workbench.plant import Plant
from workbench.simulation import Loop
from workbench.task.task import Task

SUFFIX = ", compensated"
LEAST, WIDEST, COUNT = 2.0, 1e4, 12  # counts, and how many amplitudes: where friction holds wholly to where it slides


@dataclass(frozen=True, eq=False)
class Returned(Judge):
    """The linearisations of one mass with a compensation that feeds back what the encoder shows, at each amplitude.

    linear: of the axis without it, its springs those of all friction at amplitude (n - 1,), the last one of gross sliding.
    fed (n, f): F at each of these.
    """

    linear: Linear
    amplitude: np.ndarray
    fed: np.ndarray

    @property
    def loop(self) -> Loop:
        return self.linear.loop

    @property
    def inertia(self) -> float:
        return self.linear.inertia

    @property
    def theta(self) -> np.ndarray:
        return self.linear.theta

    @property
    def rate(self) -> np.ndarray:
        return self.linear.rate

    @property
    def position(self) -> np.ndarray:
        return self.linear.position

    def peak(
        self, position: np.ndarray, speed: np.ndarray, integrators: int = 0, velocity_filter: np.ndarray | None = None
    ) -> np.ndarray:
        """Return the largest |1/(1 + C P')| over the amplitudes, (points,); infinite where any of the loops is unstable."""
        c = position + speed * (self.rate if velocity_filter is None else self.rate_of(velocity_filter))
        return np.max([self._at(k, c, integrators) for k in range(self.fed.shape[0])], axis=0)

    def _at(self, k: int, c: np.ndarray, integrators: int = 0) -> np.ndarray:
        return returned(c, self.linear.position[k], self.fed[k], self.linear.own[k] + integrators)

    def scheduled_peak(
        self,
        knots: np.ndarray,
        kp: np.ndarray,
        kd: np.ndarray,
        velocity_filter: np.ndarray | None = None,
        behind: np.ndarray | None = None,
    ) -> np.ndarray:
        """Return Ms (points,) of schedules: the gains at some knots beside the friction of that amplitude, and of gross sliding."""
        near = [int(np.argmin(np.abs(np.log(self.amplitude / knots[i])))) for i in checked(knots)]
        rate = self.rate if velocity_filter is None else self.rate_of(velocity_filter)
        n = 1.0 if behind is None else behind
        laws = [n * (kp[:, i, None] + kd[:, i, None] * rate) for i in checked(knots)]
        return np.max([self._at(k, c) for at, c in zip(near, laws, strict=True) for k in (at, -1)], axis=0)


def returned(c: np.ndarray, plant: np.ndarray, fed: np.ndarray, integrators: int) -> np.ndarray:
    """Return Ms (points,) of laws c (points, f) on P' = P/(1 - F P); P, F (f,). Whether all is stable is asked of (C - F) P."""
    whole = (c - fed) * plant
    # one real pole turns the curve by half a turn only: what is cancelled of the spring must leave the whole stiff at rest
    stable = np.isfinite(peak_of(whole, integrators)) & (((1.0 + whole[:, 0]) / plant[0]).real > 0.0)
    size = np.abs(1.0 - fed * plant) / np.maximum(np.abs(1.0 + whole), 1e-300)
    return np.where(stable, size.max(axis=-1), inf)


def judge(linear: Linear, plant: Plant, compensator: Compensator) -> Judge:
    """Return what the sensitivity of laws on a one-mass plant is asked of once this compensation acts beside them."""
    if compensator.source == REFERENCE:
        return linear
    a = amplitudes(plant, linear.loop)
    friction, _, _ = friction_of(plant)
    omega = np.full(
        a.size, 0.1 / linear.loop.sample_time
    )  # friction that follows the speed is described well within the band
    springs = equivalent_of(friction, a, omega, linear.loop.resolution).stiffness
    held, _, viscous = friction_of(_only(plant, compensator))
    named = equivalent_of(held, a, omega, linear.loop.resolution).stiffness if held.effects else np.zeros(a.size)
    shape = compensator.gain * _passed(compensator, linear)
    stop = bank_equivalent(np.ones(1), np.array([0.5 * linear.loop.count]), a)
    band = 1.0 - stop.stiffness - 1j * stop.loss  # a play operator is what its stop leaves of the motion
    at = replace(linear, stiffnesses=np.append(springs, 0.0))  # and in gross sliding, where friction is no spring
    fed = np.append(named * band, 0.0)[:, None] * shape + viscous * shape * linear.rate
    return Returned(at, a, fed)


def amplitudes(plant: Plant, loop: Loop) -> np.ndarray:
    """Return amplitudes, rad or m, over which a compensation's loop is looked at: from two counts to gross sliding."""
    count = loop.count or 1e-9
    return count * np.geomspace(LEAST, WIDEST, COUNT)


def _only(plant: Plant, compensator: Compensator) -> Plant:
    """Return the plant with the forces alone that are cancelled, and what gives them their direction."""
    keys = {e.key for e in (*compensator.forces, *compensator.guides)}
    for e in plant.effects:
        plant = plant if e.key in keys else plant.without(e.key)
    return plant


def _passed(compensator: Compensator, linear: Linear) -> np.ndarray:
    """Return the response (f,) from the reading to the position that the effects see, and from their force to the command."""
    dt, s = linear.loop.sample_time, 1j * linear.theta / linear.loop.sample_time
    out = np.exp(-1j * linear.theta * compensator.delay)
    if compensator.low_pass:
        rate = -np.expm1(-2.0 * np.pi * compensator.low_pass * dt)
        out = out * rate / (1.0 - (1.0 - rate) * np.exp(-1j * linear.theta))
    if (
        compensator.source == OBSERVED
    ):  # what the command tells it is left out: between its corrections it sees friction as motion
        w = 2.0 * np.pi * compensator.bandwidth
        out = out * (2.0 * w * s + w * w) / (s + w) ** 2
    return out


def entered(family: Family, compensator: Compensator, start: np.ndarray, sensitivity=None) -> Family:
    """Return a family with a compensation beside its law, whose search starts at tuned numbers.

    sensitivity: of points; the family's own where absent.
    """

    def controller(points, lanes):
        return compensated(family.controller(points, lanes), compensator)

    more = {} if sensitivity is None else {"sensitivity": sensitivity}
    return replace(family, name=f"{family.name}{SUFFIX}", start=np.asarray(start), controller=controller, **more)


def contestant(
    made: Designed, task: Task, name: str, compensator: Compensator, seeds: Sequence[int], say: Callable[[str], None]
) -> Tuned | Climb:
    """Return a designed controller with a compensation. Baselines are tuned anew by the search that tuned them; a gain table
    keeps its numbers, for what its ladder asks of each move is not the reference's motion alone."""
    judged, base = _judge_of(made, task, compensator), made.tuned[name]
    if isinstance(base, Climb):
        return replace(base, family=entered(base.family, compensator, base.point, _tabled(base.family, judged)))
    own = task.on(made.plant)
    every = baseline_families(own, judged, made.gains)
    family = next(f for f in every if f.name == name)
    ours = entered(family, compensator, base.point)
    say(f"tuning {ours.name} on the simulated loop")
    (best,) = best_of(own, [(ours, seeds_of(seeds))])
    return best


def _judge_of(made: Designed, task: Task, compensator: Compensator) -> Judge:
    """Return what sensitivities of laws on a designed plant are asked of beside a compensation."""
    return judge(linear_of(friction_of(made.plant), made.equivalent, task.loop), made.plant, compensator)


def _tabled(family: Family, judged: Judge) -> Callable[[np.ndarray], np.ndarray]:
    """Return points -> Ms (points,) of a family of gain tables."""

    def sensitivity(points):
        made = family.controller(points, 1)
        kp, kd = (np.stack([t.columns[n] for t in made.tables]) for n in ("kp", "kd"))
        own = None if made.velocity_filter is None else np.reshape(made.velocity_filter, (-1, 1))
        notch = tuple(np.reshape(made.parameters[n], (-1, 1)) for n in OWN if n in made.parameters)
        passed = behind(notch, judged.theta) if notch else None
        return judged.scheduled_peak(made.tables[0].knots, kp, kd, own, passed)

    return sensitivity


def margins(
    made: Designed, task: Task, name: str, compensator: Compensator, gains: Sequence[float]
) -> dict[float, float]:
    """Return gain of the compensation -> Ms of a designed controller, its own numbers kept."""
    base, found = made.tuned[name], {}
    for g in gains:
        judged = _judge_of(made, task, compensator.but(gain=g))
        if isinstance(base, Climb):
            ms = _tabled(base.family, judged)(base.point[None, :])
        else:
            every = baseline_families(task.on(made.plant), judged, made.gains)
            ms = next(f for f in every if f.name == name).sensitivity(base.point[None, :])
        found[g] = float(ms[0])
    return found
