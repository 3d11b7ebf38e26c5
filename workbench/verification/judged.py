"""What a design is worth, all at once: its controllers compared, one of them recommended, its promises held, its ladder climbed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from workbench.cancellation.contestant import SUFFIX
from workbench.design.design import Designed, regrets_on_ladder
from workbench.design.regret import Regret
from workbench.task.task import Task
from workbench.verification.compare import Comparison, compare, verdicts
from workbench.verification.promise import Promise, promise
from workbench.verification.recommend import Recommended, recommend


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


def judged(made: Designed, task: Task, ours: str, baselines: Sequence[str]) -> Judged:
    """Return what a design is worth on the plant of a task. baselines: names of what its gain table is held against."""
    plant = task.plant
    factories = {name: tuned.controller for name, tuned in made.tuned.items()}
    comparison = verdicts(compare(task, factories), ours, baselines, plant.displacement)
    choice = recommend(task, made.tuned, plant.displacement)
    kept = promise(plant, made.polished, task)
    fewer, alone = regrets_on_ladder(made, [n for n in made.tuned if n in baselines or n.endswith(SUFFIX)])
    return Judged(ours, comparison, choice, kept, fewer, alone)
