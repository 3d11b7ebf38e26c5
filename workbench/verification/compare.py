"""Controllers side by side: the same steps with and without load, and who beats whom, and on what."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from workbench.finding import Finding
from workbench.keeping import kept
from workbench.simulation import Metrics
from workbench.task.task import PHASES, Task

LEVEL = {"time": 0.01, "error": 0.25}  # relative differences below which two controllers count as equal


@dataclass(frozen=True)
class Row:
    """One controller under one load; the worst over PHASES encoder phases, SI. error_counts: in encoder counts."""

    controller: str
    load_inertia: float
    time_1pct: float
    bound: float
    overshoot: float
    final_error: float
    error_counts: float
    settling: float
    peak_torque: float
    ripple: float

    @property
    def over_bound(self) -> float:
        """1 % time over the time-optimal bound."""
        return self.time_1pct / self.bound


@dataclass(frozen=True, eq=False)
class Comparison:
    """rows: every controller under every load. findings: which baseline is beaten on what, and which is not."""

    rows: tuple[Row, ...]
    findings: tuple[Finding, ...]

    def row(self, controller: str, load_inertia: float = 0.0) -> Row:
        return next(r for r in self.rows if r.controller == controller and r.load_inertia == load_inertia)


@kept
def compare(task: Task, controllers: Mapping[str, object]) -> Comparison:
    """Run every controller (name -> factory(lanes) of a Controller) under every load of the task."""
    rows = []
    for load in task.load_inertias:
        scenarios = task.scenarios(load_inertias=(load,), frictions=(1.0,), inertias=(1.0,), phases=PHASES)
        bound = task.bound(load)
        for name, factory in controllers.items():
            rows.append(_row(task, name, load, bound, task.run(factory(scenarios.lanes), scenarios)))
    return Comparison(tuple(rows), ())


def _row(task: Task, name: str, load: float, bound: float, m: Metrics) -> Row:
    error = float(np.max(m.final_error))
    return Row(
        name, load, float(np.max(m.time_1pct)), bound, float(np.max(m.overshoot)), error,
        error / task.loop.resolution if task.loop.resolution else float("nan"), float(np.max(m.settling)),
        float(np.max(m.peak_torque)), float(np.max(m.ripple)),
    )  # fmt: skip


def side(mine: float, other: float, level: float) -> int:
    """1 where mine is smaller (better) by more than the level, -1 where it is larger, else 0."""
    if not np.isfinite(mine) or not np.isfinite(other):
        return int(np.isfinite(mine)) - int(np.isfinite(other))
    return int(mine < other * (1 - level)) - int(mine > other * (1 + level))


def sides(mine: Row, other: Row) -> tuple[int, int]:
    """Return (time, error): 1 where a controller is better than another by more than LEVEL, -1 where it is worse, else 0."""
    time = side(mine.time_1pct, other.time_1pct, LEVEL["time"])
    return time, side(mine.final_error, other.final_error, LEVEL["error"])
