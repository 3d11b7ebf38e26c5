"""Gains at each amplitude, optimised on the simulated step: the nonlinear sampled loop with its limits of drive and speed.

    minimise    (T + rise_weight T_rise)/T_0 + error_weight log10(error/reference)
    over        Kp, Kd, as ratio Kp/Kd and stiffness along it
    subject to  overshoot of the own final value, |S| <= Ms of the exact sampled loop (linearised at that amplitude)

T: into the band about the own final value. T_0: what the closed form promises there, so that the sum has no unit. All
amplitudes and scenarios are lanes of one run. The search is a grid that zooms in, from the closed form's optimum and over the
whole range: |S| <= Ms ends each line of constant ratio (`tune.reach`), so that its limit is an edge of the grid and not a
ridge in it; neighbouring amplitudes offer each other their gains. A candidate meets the scenario first that the best so far finds
dearest, and the others only where that alone costs less than the best: a sum over the worst of several is no less than over one.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from workbench.control import fixed_pd
from workbench.design.candidates import Met, Tried
from workbench.keeping import kept
from workbench.processes import shared
from workbench.simulation import ScenarioArrays, simulate
from workbench.task.stepping import FIGURES, Figures, figures_of
from workbench.task.task import Task
from workbench.tuning import Gains, TunedAxis, TuningGoal, sampled
from workbench.tuning.axis import Axis
from workbench.tuning.reach import stiffest
from workbench.tuning.tuning import ACTIVE

RATIOS, WIDE = 12, (-1.2, 2.2)  # of the first grid: so many values of log(ratio), about the closed form's
STIFFNESSES = (0.0, -0.15, -0.35, -0.7, -1.2, -1.8, -2.5)  # of the first grid: log of Kp over the largest
ZOOM, ROUNDS, SHRINK = 5, 9, 0.55  # lines of a grid each way, grids, and each one's span over that of the one before
# The last grid's lines are 0.3/2 * 0.55^8 = 0.1 % apart; half the rounds leave 1.5 %, twice as many change nothing.
LASTS, REST = 1.5, 0.025  # how long a step is simulated for: of the closed form's time, and s beside
GROUPS = 8  # of amplitudes of like duration, each one run


@dataclass(frozen=True, eq=False)
class Stepped:
    """Gains (n,) at amplitudes (n,), SI, and what steps of them come to: the worst over the scenarios, and `nominal` alone.

    friction, inertia: the scenarios' factors. sensitivity_peak, spectral_radius: of the nominal linearisation."""

    amplitude: np.ndarray
    kp: np.ndarray
    kd: np.ndarray
    worst: Figures
    nominal: Figures
    cost: np.ndarray
    sensitivity_peak: np.ndarray
    spectral_radius: np.ndarray
    scenarios: tuple[tuple[float, float], ...]


@dataclass(frozen=True, eq=False)
class Polished:
    """linear: the closed form's optimum. nominal, robust: optimised on the simulated step, for the nominal plant and over the
    scenarios of friction and inertia."""

    linear: Gains
    nominal: Stepped
    robust: Stepped

    @property
    def price(self) -> np.ndarray:
        """Nominal 1 % time under robust gains over that under nominal ones, (n,): what robustness costs."""
        return self.robust.nominal.time / self.nominal.nominal.time

    def gains(self, which: Stepped, goal: TuningGoal) -> Gains:
        """Return one of them as Gains, time and overshoot as simulated on the nominal plant, without continuous-time margins."""
        none = np.full(which.kp.size, np.nan)
        stiffness = self.linear.error_ratio * self.linear.kp / (1.0 - self.linear.error_ratio)
        return replace(
            self.linear,
            kp=which.kp,
            kd=which.kd,
            time=which.nominal.time,
            overshoot=which.nominal.overshoot,
            sensitivity_peak=which.sensitivity_peak,
            spectral_radius=which.spectral_radius,
            gain_margin=none,
            phase_margin=none,
            error_ratio=stiffness / (stiffness + which.kp),
            binding=_binding(which, goal),
            findings=(),
        )


@kept
def polish(axis: TunedAxis, goal: TuningGoal, task: Task, say: Callable[[str], None] = lambda _: None) -> Polished:
    """Optimise the gains of each amplitude on simulated steps, from those of the closed form, (n,) each.

    task: its plant, loop (without the encoder's counts: small amplitudes are a few of them), weights, frictions and inertias.
    """
    say("optimising the gains of each amplitude on simulated steps")
    rigid, gains = axis.rigid, axis.gains
    search = Search(Axis.of(axis.equivalent, rigid.inertia, rigid.viscous, task.loop), gains, goal, task)
    several = ((f, i) for f in {1.0, *task.frictions} for i in {1.0, *task.inertias})
    corners = tuple(sorted(several, key=lambda s: (s != (1.0, 1.0), s)))  # the nominal plant first
    nominal, *robust = shared(search.run, [((1.0, 1.0),), corners][: len(corners)])
    return Polished(gains, nominal, *robust or [nominal])


@dataclass(frozen=True, eq=False)
class Search:
    """One search, all amplitudes side by side. Candidates are flat arrays: rows (c,) says whose they are."""

    axis: Axis
    start: Gains
    goal: TuningGoal
    task: Task

    def run(self, scenarios) -> Stepped:
        """Return the best gains of every amplitude over scenarios (friction, inertia), the first of which is nominal."""
        n = self.start.amplitude.size
        ratio = np.log(self.start.kp / self.start.kd)
        best = self.tried(np.arange(n), np.log(self.start.kp), ratio, scenarios)
        wide = ratio[:, None] + np.linspace(*WIDE, RATIOS)
        best = self.better(best, *self.lattice(wide, np.array(STIFFNESSES)), scenarios)
        across, along = (WIDE[1] - WIDE[0]) / (RATIOS - 1), 0.5
        for _ in range(ROUNDS):
            best = self.better(best, *self.around(best, across, along), scenarios)
            across, along = across * SHRINK, along * SHRINK
        kp, kd = best.kp, best.kd
        return Stepped(self.start.amplitude, kp, kd, best.worst, best.nominal, best.cost, *self.linear(np.arange(n), kp, kd), scenarios)  # fmt: skip

    def most(self, ratios: np.ndarray) -> np.ndarray:
        """Return log of the largest Kp, SI, at log ratios (n, m)."""
        per = self.axis.unit_kd / self.axis.unit_kp
        return np.log(stiffest(self.axis, np.exp(ratios) * per, self.goal.sensitivity) * self.axis.unit_kp)

    def lattice(self, ratios: np.ndarray, below: np.ndarray):
        """Return flat (rows, log kp, log ratio): log kp is `below` (k,) under the largest at each of the ratios (n, m)."""
        kp = self.most(ratios)[:, :, None] + below
        shape = kp.shape
        rows = np.broadcast_to(np.arange(shape[0])[:, None, None], shape)
        return rows.ravel(), kp.ravel(), np.broadcast_to(ratios[:, :, None], shape).ravel()

    def around(self, best: "Stepped", across: float, along: float):
        """Return flat candidates on a grid about the best, cut at the largest Kp, and the gains of both neighbours."""
        kp, ratio = np.log(best.kp), np.log(best.kp / best.kd)
        lines = np.linspace(-1.0, 1.0, ZOOM)
        ratios = ratio[:, None] + across * lines
        ratios = np.concatenate([ratios, np.roll(ratio, 1)[:, None], np.roll(ratio, -1)[:, None]], axis=1)
        most = self.most(ratios)
        below = np.minimum(kp - self.most(ratio[:, None])[:, 0], 0.0)
        levels = np.minimum(below[:, None] + along * lines, 0.0)
        levels = np.concatenate([levels, np.zeros((kp.size, 1))], axis=1)  # the edge is asked in every round
        kps = most[:, :, None] + levels[:, None, :]
        rows = np.broadcast_to(np.arange(len(kps))[:, None, None], kps.shape)
        return rows.ravel(), kps.ravel(), np.broadcast_to(ratios[:, :, None], kps.shape).ravel()

    def better(self, best: Tried, rows, kp, ratio, scenarios) -> Tried:
        """Return the best of what is known and of flat candidates, at each amplitude."""
        new = self.tried(rows, kp, ratio, scenarios, best)
        n = best.kp.size
        order = np.lexsort((new.cost, rows))
        first = order[np.searchsorted(rows[order], np.arange(n))]
        return best.or_where(new.cost[first] < best.cost, new.take(first))

    def tried(self, rows, kp, ratio, scenarios, best: Tried | None = None) -> Tried:
        """Simulate flat candidates; those beyond |S| are not, nor those that cannot cost less than the best, and cost without end."""
        kp, kd = np.exp(kp), np.exp(kp - ratio)
        peak, radius = self.linear(rows, kp, kd)
        met = Met(np.full((len(FIGURES), len(scenarios), kp.size), np.inf), rows, kp, kd)
        left = np.flatnonzero((peak <= self.goal.sensitivity * (1.0 + ACTIVE)) & (radius < 1.0))
        others = np.arange(len(scenarios))[:, None]
        if best is not None and len(scenarios) > 1:
            first = best.dearest[rows[left]]
            self.meet(met, scenarios, first, left)
            promising = self.cost(rows[left], Figures(*met.figures[:, first, left])) < best.cost[rows[left]]
            left, others = left[promising], (first[promising] + others[1:]) % len(scenarios)
        at, which = np.broadcast_arrays(left, others)
        self.meet(met, scenarios, which.ravel(), at.ravel())
        return self.of(rows, kp, kd, met.figures)

    def of(self, rows, kp, kd, figures: np.ndarray) -> Tried:
        """Return candidates (c,) with figures (4, scenarios, c)."""
        worst = Figures(*figures.max(axis=1))
        dearest = np.argmax([self.cost(rows, Figures(*own)) for own in figures.swapaxes(0, 1)], axis=0)
        return Tried(kp, kd, worst, Figures(*figures[:, 0]), self.cost(rows, worst), dearest)

    def meet(self, met: Met, scenarios, which: np.ndarray, at: np.ndarray) -> None:
        """Simulate candidates at (m,) in scenarios which (m,), amplitudes of like duration together, and put down what they come to."""
        for group in np.array_split(np.arange(self.start.amplitude.size), GROUPS):
            own = np.isin(met.rows[at], group)
            if own.any():
                k, i = which[own], at[own]
                corner = np.array(scenarios)[k]
                met.figures[:, k, i] = self.simulated(met.rows[i], met.kp[i], met.kd[i], corner, self.duration(group))

    def duration(self, group: np.ndarray) -> float:
        return LASTS * float(self.start.time[group].max()) + REST

    def simulated(self, rows, kp, kd, corner: np.ndarray, duration: float) -> np.ndarray:
        """Return the figures (4, c) of candidates (c,), each in a corner (c, 2) of friction and inertia."""
        target, loop = self.start.amplitude[rows], replace(self.task.loop, resolution=0.0)
        lanes = ScenarioArrays(target.size, target=target, phase=0.5, friction=corner[:, 0], inertia=corner[:, 1])
        q = simulate(self.task.plant, loop, fixed_pd(kp, kd), lanes, duration, ("q",)).trajectories["q"]
        every = figures_of(q, np.zeros(target.size), target, loop.sample_time, self.goal.band)
        return np.array([getattr(every, n) for n in FIGURES])

    def linear(self, rows, kp, kd) -> tuple[np.ndarray, np.ndarray]:
        """Return (Ms, spectral radius) of the nominal linearisation at flat candidates."""
        part = self.axis.take(rows)
        kp, kd = kp / part.unit_kp, kd / part.unit_kd
        motion = part.steps(kp)
        peak, _ = sampled.sensitivity_peak(kp, kd, motion, part.clock)
        return peak, sampled.spectral_radius(kp, kd, motion, part.clock)

    def cost(self, rows, f: Figures) -> np.ndarray:
        w, promised = self.task.weights, self.start.time[rows]
        count = max(self.task.loop.count, 1e-12)
        with np.errstate(all="ignore"):
            value = (f.time + w.rise * f.rise) / promised + w.error * np.log10(np.maximum(f.error, count) / w.reference)
            value = value + w.steepness * np.maximum(f.overshoot - self.goal.allowed, 0.0)
        return np.where(np.isfinite(f.time), value, np.inf)


def _binding(which: Stepped, goal: TuningGoal) -> tuple[tuple[str, ...], ...]:
    """The limits that are met at each amplitude; of the drive, where the step begins at its limit."""
    met = {
        "overshoot": which.worst.overshoot >= 0.9 * goal.allowed,
        "drive": which.kp * which.amplitude >= goal.drive,
        "sensitivity": which.sensitivity_peak >= goal.sensitivity * 0.995,
    }
    return tuple(tuple(name for name, where in met.items() if where[i]) for i in range(which.kp.size))
