"""What a design is worth, all at once: its controllers compared, one of them recommended, its promises held, its ladder climbed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.cancellation.contestant import SUFFIX
from workbench.design.design import Designed, regrets_on_ladder
from workbench.design.regret import Regret
from workbench.task.task import Task
from workbench.verification.compare import Comparison, compare
from workbench.verification.promise import Promise, promise
from workbench.verification.recommend import Recommended, recommend
from workbench.verification.wording import verdicts


@dataclass(frozen=True, eq=False)
class Judged:
    """ours: name of the gain table. comparison: of every controller on the task. choice: which to take. promise: of the gains at each
    amplitude. fewer, alone: regrets on the table's ladder of what has fewer levels, and of controllers tuned for one step."""

    ours: str
    comparison: Comparison
    choice: Recommended
    promise: Promise
    fewer: Mapping[str, Regret]
    alone: Mapping[str, Regret]

    @property
    def of_ours(self) -> Comparison:
        """The comparison's rows of the gain table alone."""
        return Comparison(tuple(r for r in self.comparison.rows if r.controller == self.ours), ())

    def table_figures(self, made: Designed, against: str) -> dict[str, float]:
        """Return the figures by which the gain table of a design may be judged, SI. against: the controller that it is held against."""
        first = self.comparison.rows[0].load_inertia
        mine = self.of_ours.rows
        other, free = (self.comparison.row(name, first) for name in (against, self.ours))
        return {
            "sensitivity_peak": float(np.max(made.gains.sensitivity_peak)),
            "schedule_interpolation_error": float(made.schedule.interpolation_error),
            "schedule_knots": float(made.schedule.knots.size),
            "scheduled_time_over_bound": free.over_bound,
            "scheduled_time_over_bound_worst": max(r.over_bound for r in mine),
            "scheduled_final_error": free.final_error,
            "scheduled_final_error_worst": max(r.final_error for r in mine),
            "scheduled_error_over_fixed": free.final_error / other.final_error,
        }

    def recommended_figures(self, count: float) -> dict[str, float]:
        """Return what the recommended controller leaves nominally, in counts (rad or m each), and the gain table's worst over the grid."""
        mine = next(r for r in self.choice.rows if r.name == self.ours)
        return {
            "recommended_error_counts": self.choice.row.error / count if count else float("nan"),
            "scheduled_error_grid": mine.error_grid,
            "scheduled_overshoot_grid": mine.overshoot_grid,
        }


def judged(made: Designed, task: Task, ours: str, baselines: Sequence[str]) -> Judged:
    """Return what a design is worth on the plant of a task. baselines: names of what its gain table is held against."""
    plant = task.plant
    factories = {name: tuned.controller for name, tuned in made.tuned.items()}
    comparison = verdicts(compare(task, factories), ours, baselines, plant.displacement)
    choice = recommend(task, made.tuned, plant.displacement)
    kept = promise(plant, made.polished, task)
    fewer, alone = regrets_on_ladder(made, [n for n in made.tuned if n in baselines or n.endswith(SUFFIX)])
    return Judged(ours, comparison, choice, kept, fewer, alone)
