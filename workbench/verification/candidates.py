"""What every controller comes to nominally and in the worst case that it has to bear, the one to take first."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.compensation import Compensated
from workbench.control import Controller
from workbench.simulation import Metrics
from workbench.task.task import PHASES, Task

LEVELS = (0.5, 1.0, 1.5)  # of inertia and friction: what a controller has to bear, whatever it was tuned for
GRID_OVERSHOOT = 0.025  # of the step, at the grid's corners: beyond it a motion is no longer a point-to-point one
TIE = 0.01  # of the cost: two controllers this close are equal, and the simpler law is taken


@dataclass(frozen=True)
class Candidate:
    """time, error, overshoot: nominal, the worst of PHASES encoder phases; time_grid, error_grid, overshoot_grid: the worst over
    LEVELS of inertia and friction and every load; sensitivity: Ms. cost: of the grid. numbers: how many a law has."""

    name: str
    time: float
    error: float
    overshoot: float
    time_grid: float
    error_grid: float
    overshoot_grid: float
    sensitivity: float
    cost: float
    numbers: int

    @property
    def allowed(self) -> bool:
        return bool(np.isfinite(self.time_grid) and self.overshoot_grid <= GRID_OVERSHOOT)


def candidates(task: Task, tuned: Mapping[str, object]) -> tuple[Candidate, ...]:
    """Judge every tuned controller (name -> family, point, controller(lanes)) nominally and over the grid, the best first."""
    bound = task.bound()
    rows = [_candidate(task, n, t.controller, t.family.sensitivity(t.point[None, :]), known_to(t), bound) for n, t in tuned.items()]  # fmt: skip
    least = min((r.cost for r in rows if r.allowed), default=np.inf)
    order = sorted(
        rows, key=lambda r: (not r.allowed, r.cost > least + TIE, r.numbers if r.cost <= least + TIE else 0, r.cost)
    )
    return tuple(order)


def known_to(tuned) -> int:
    """Return how many numbers a tuned law has, those of the effects that it cancels among them."""
    controller = tuned.controller(1)
    cancelled = controller.compensator.effects if isinstance(controller, Compensated) else ()
    return len(tuned.numbers) + sum(len(e.parameters) for e in cancelled)


def _candidate(
    task: Task, name: str, make: Callable[[int], Controller], sensitivity: Sequence[float], numbers: int, bound: float
) -> Candidate:
    """Return what one controller comes to."""
    nominal = _ran(task, make, task.scenarios(task.load_inertias[:1], (1.0,), (1.0,), PHASES))
    grid = _ran(task, make, task.scenarios(task.load_inertias, LEVELS, LEVELS, 2))
    worst = [float(np.max(v)) for m in (nominal, grid) for v in (m.time_1pct, m.final_error, m.overshoot)]
    w = task.weights
    cost = worst[3] / bound + w.error * np.log10(max(worst[4], task.loop.count, 1e-12) / w.reference)
    return Candidate(name, *worst, float(np.max(sensitivity)), float(cost), numbers)


def _ran(task: Task, make: Callable[[int], Controller], scenarios) -> Metrics:
    return task.run(make(scenarios.lanes), scenarios)
