"""What every controller is asked to do: the same steps, on the same axis, with the same limits."""

from dataclasses import dataclass, field, replace

import numpy as np

from workbench.plant import Plant
from workbench.simulation import Criteria, Loop, Metrics, ScenarioArrays, simulate
from workbench.simulation.run import LANES
from workbench.task.bound import time_optimal

PHASES = 8  # encoder phases and noise seeds that a judged controller is the worst of


@dataclass(frozen=True)
class Weights:
    """How a worst case becomes one number: time over the bound, plus `error` per decade of final error over `reference`.

    rise: of the rise time beside the 1 % time, at each amplitude: the earlier of two that settle alike; half of it or twice as
    much moves those gains by under 1 %. overshoot: share of the step that is allowed. ripple: rms of the command at rest that is allowed, share of the drive's
    limit. sensitivity: Ms that no linearisation may exceed. steepness: what a violation costs, per unit of it.
    """

    error: float = 0.15
    rise: float = 0.1
    reference: float = 1e-5
    overshoot: float = 0.002
    ripple: float = 0.05
    sensitivity: float = 2.0
    steepness: float = 200.0


@dataclass(frozen=True, eq=False)
class Task:
    """plant: what runs. loop, criteria, duration (s): of the simulation. step: from rest at `start` to the target, rad or m.

    load_inertias: loads that are put on, kg*m^2 or kg, the first usually zero. frictions, inertias: factors that tuning
    meets beside 1. nominal: whether time and error count where both are 1 alone, and only overshoot and ripple everywhere: a
    controller that is to be accurate on the axis as it is, and still behave on others. noise: torque noise rms. phases: encoder phases a scenario is repeated at. lanes: scenarios that one
    kernel moves side by side; where a search runs few at a time, the rest of the lanes would be moved for nothing.
    """

    plant: Plant
    loop: Loop
    step: float
    duration: float
    load_inertias: tuple[float, ...] = (0.0,)
    frictions: tuple[float, ...] = (1.0,)
    inertias: tuple[float, ...] = (1.0,)
    noise: float = 0.0
    phases: int = 2
    weights: Weights = field(default_factory=Weights)
    criteria: Criteria = field(default_factory=Criteria)
    start: float = 0.0
    lanes: int = LANES
    nominal: bool = False

    def scenarios(self, load_inertias=None, frictions=None, inertias=None, phases: int | None = None) -> ScenarioArrays:
        """Return every combination of loads, frictions, inertias and phases, as lanes in that order."""
        loads = self.load_inertias if load_inertias is None else load_inertias
        grids = np.meshgrid(
            loads,
            self.frictions if frictions is None else frictions,
            self.inertias if inertias is None else inertias,
            np.arange(phases or self.phases),
            indexing="ij",
        )
        load, friction, inertia, _ = (g.ravel() for g in grids)
        lanes = load.size
        k = np.arange(lanes)
        # Targets a fraction of a count apart and phases spread evenly: no controller is tuned to one landing.
        golden = 0.6180339887498949
        return ScenarioArrays(
            lanes,
            target=self.start + (self.step + self.loop.count * ((k * golden) % 1.0)),
            start=self.start,
            load_inertia=load,
            friction=friction,
            inertia=inertia,
            phase=((k + 0.5) * golden) % 1.0,
            noise=self.noise,
            seed=1 + k,
        )

    def bound(self, load_inertia: float = 0.0) -> float:
        """Time-optimal 1 % time, s."""
        return time_optimal(
            self.plant, self.step, load_inertia=load_inertia, counts=self.loop.count, band=self.criteria.band
        )

    def run(
        self, controller, scenarios: ScenarioArrays, record=(), every: int = 1, threads: int | None = None
    ) -> Metrics:
        return simulate(
            self.plant, self.loop, controller, scenarios, self.duration, record,
            every=every, criteria=self.criteria, threads=threads, lanes=self.lanes,
        )  # fmt: skip

    def on(self, plant: "Plant | list[Plant]") -> "Task":
        """Return the same task on another plant, or on one a scenario."""
        return replace(self, plant=plant)


def cost(task: Task, metrics: Metrics, bound: float, lanes: int) -> np.ndarray:
    """Return the worst case over each group of `lanes` scenarios as one number, (groups,); lower is better.

    To the worst of time and error comes what the worst of overshoot and ripple are beyond their limits, each in whichever
    scenario that is: a scenario that overshoots may not pay with an error that is small there.
    """
    value, beyond, rough = (np.max(v.reshape(-1, lanes), axis=1) for v in each(task, metrics, bound))
    return value + task.weights.steepness * beyond + rough


def each(task: Task, metrics: Metrics, bound: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return what time and error cost in each scenario, and its overshoot and ripple beyond their limits, (scenarios,) each.

    A step that never settles costs 10 and more, graded by its error, so that a search finds its way back. Where the nominal axis is
    what counts, time and error elsewhere cost nothing.
    """
    w = task.weights
    with np.errstate(all="ignore"):
        error = np.nan_to_num(np.maximum(metrics.final_error, 1e-12), nan=1e6, posinf=1e6)
        never = 10.0 + np.minimum(np.log10(error / w.reference), 20.0)
        settled = metrics.time_1pct / bound + w.error * np.log10(np.maximum(error, task.loop.count) / w.reference)
        value = np.where(np.isfinite(metrics.time_1pct), settled, never)
        beyond = np.nan_to_num(np.maximum(metrics.overshoot - w.overshoot, 0.0), nan=1.0, posinf=10.0)
        limit = w.ripple * task.plant.limits.drive
        rough = np.nan_to_num(np.maximum(metrics.ripple / limit - 1.0, 0.0), nan=10.0, posinf=10.0)
    if task.nominal:
        own = task.scenarios()
        here = (np.asarray(own.friction) == 1.0) & (np.asarray(own.inertia) == 1.0)
        value = np.where(np.tile(here, value.size // here.size), value, -np.inf)
    return value, beyond, rough


def least(task: Task) -> float:
    """Return what no controller costs less than, whatever it does: on its target at once, within a count."""
    w, nothing = task.weights, 1e-12
    within = w.error * np.log10(max(nothing, task.loop.count) / w.reference)
    return float(min(within, 10.0 + np.log10(nothing / w.reference)))
