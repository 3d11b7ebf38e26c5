"""Which controller to take: the least worst case among those that keep what was asked, with what is known of each beside it."""

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


@dataclass(frozen=True, eq=False)
class Recommended:
    """name: of the controller to take. rows: every candidate, the best first. sentence: why."""

    name: str
    rows: tuple[Candidate, ...]
    sentence: str

    @property
    def row(self) -> Candidate:
        return self.rows[0]


def recommend(task: Task, tuned: Mapping[str, object], unit: str) -> Recommended:
    """Judge every tuned controller (name -> family, point, controller(lanes)) nominally and over the grid, and pick one.

    unit: of position, "rad" or "m".
    """
    bound = task.bound()
    rows = [_candidate(task, n, t.controller, t.family.sensitivity(t.point[None, :]), known_to(t), bound) for n, t in tuned.items()]  # fmt: skip
    least = min((r.cost for r in rows if r.allowed), default=np.inf)
    order = sorted(
        rows, key=lambda r: (not r.allowed, r.cost > least + TIE, r.numbers if r.cost <= least + TIE else 0, r.cost)
    )
    return Recommended(order[0].name, tuple(order), _said(order, unit))


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


def _said(rows: Sequence[Candidate], unit: str) -> str:
    """Say which to take and why, against the next."""

    def micro(value: float) -> str:
        return f"{1e6 * value:.3g} µ{unit}"

    one = rows[0]
    if not one.allowed:
        return (
            f"No controller keeps an overshoot of {GRID_OVERSHOOT:.1%} over half to one and a half times inertia and friction; "
            f"{one.name} comes nearest, with {one.overshoot_grid:.1%}."
        )
    text = (
        f"Take {one.name}: a 1 % time of {1e3 * one.time:.1f} ms and an error of {micro(one.error)} on the nominal plant, "
        f"{1e3 * one.time_grid:.1f} ms and {micro(one.error_grid)} in the worst case of half to one and a half times inertia and "
        f"friction, at Ms = {one.sensitivity:.2f}."
    )
    others = [r for r in rows[1:] if r.allowed]
    if others:
        r = others[0]
        text += (
            f" {r.name[0].upper()}{r.name[1:]} comes next, with {1e3 * r.time:.1f} ms and {micro(r.error)}, in the worst case "
            f"{1e3 * r.time_grid:.1f} ms and {micro(r.error_grid)}."
        )
    return text
