"""The gain table of a plant: gains per amplitude on simulated steps, ratios between them tuned over the ladder, one schedule."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from workbench.control.laws import CLOSING
from workbench.design.climb import CLIMBING, Climbed, Climbing, climb
from workbench.design.families.family import Family, pd_family
from workbench.design.families.gain_table import (
    GainTable,
    fixed_family,
    gain_table,
    switched_family,
    table_family,
    without_notch,
)
from workbench.design.families.linear import Linear
from workbench.design.families.shaped import shaped
from workbench.design.ladder import LANDING, PHASES, SIZES, ladder
from workbench.design.polish import Polished
from workbench.design.regret import Regret, first_grid, from_references
from workbench.design.wording import stiffer
from workbench.design.worth import Rivals, regret_of, rivals
from workbench.finding import Finding
from workbench.keeping import kept
from workbench.schedule import Schedule, fit_schedule
from workbench.schedule.fit import REVERSAL
from workbench.task.task import Task
from workbench.tuning import Gains, TuningGoal

# soft and stiff arrivals of each rule
AHEAD = {"error": (4.0, 2.0), "following": (2.0, 1.0), "frozen": (1.0, 0.5), "closing": (2.0, 1.0)}
SEEN = {
    "error": 0.5,
    "following": 1.0,
    "frozen": 0.5,
    "closing": 1.0,
}  # of a step from rest: the largest amplitude that its gains are looked up at
# An arrival is soft where gains are those tuned for a longer step than the one that is left. Under "error" a step that ends a
# motion is seen by its last part; after a reversal the amplitude is half the stroke.
RUNS = (1, 2, 3)  # seeds, where a study states none: both arrivals in turn


@dataclass(frozen=True, eq=False)
class Tabled:
    """schedule: what is exported. interpolated: through the gains per amplitude alone. climbed: the search over the ladder. rivals:
    fixed gains and a two-level switch by the same search; none where they were not asked for."""

    schedule: Schedule
    interpolated: Schedule
    climbed: Climbed
    rivals: Rivals

    def regret_on(self, task: Task) -> Regret:
        """Return the regret of the best table where another plant, that of `task`, climbs the ladder."""
        return regret_of(self.climbed.on, self.climbed.best, self.climbed.references, task)


@kept
def tabled(
    polished: Polished,
    linear: Linear,
    goal: TuningGoal,
    task: Task,
    rule: str,
    *,
    per_octave: int = 2,
    tolerance: float = 0.1,
    load: float | None = None,
    seeds: Sequence[int] = RUNS,
    budget: Climbing = CLIMBING,
    sizes: int | None = None,
    against: bool = True,
    notch: bool = True,
    say: Callable[[str], None] = lambda _: None,
) -> Tabled:
    """Return the table of one rule for the plant of a task, tuned for every move of its ladder.

    load: N*m or N, of the ladder. seeds, budget: of the search. sizes: of the ladder's steps. against: whether rivals are tuned. notch: whether the
    table, its rivals and its references have one among their numbers.
    """
    robust = polished.gains(polished.robust, goal)
    amplitude, plant = robust.amplitude, task.plant
    interpolated = fit_schedule(
        robust,
        per_octave=per_octave,
        tolerance=tolerance,
        rule=rule,
        plant_digest=plant.digest,
        plant_lines=plant.digest_lines(),
        loop=task.loop,
    )
    on = ladder(task, load, sizes=sizes or SIZES, phases=LANDING if rule == CLOSING else PHASES)
    # a ratio for each size of step: under "closing" it then serves that size and the last part of longer ones
    table = gain_table(linear, amplitude, REVERSAL * task.loop.count, goal.sensitivity, per_octave, on.sizes)
    free = (lambda family: family) if notch else partial(without_notch, table)
    starts = [free(table_family(table, robust, linear, rule, ahead)) for ahead in AHEAD[rule]]
    fixed = _fixed(table, robust, linear, task, notch)
    informed = partial(from_references, starts[0], table, on, SEEN[rule])
    found = climb(on, starts, (fixed, first_grid(table, notch)), informed, seeds=seeds, budget=budget, say=say)
    schedule = _at_best(interpolated, rule, table, found, notch)
    fewer = (fixed_family(table, robust, linear, rule, 1e-2 * task.step), switched_family(table, robust, linear, rule))
    if against:
        say("tuning fixed gains and a two-level switch over all moves")
    return Tabled(schedule, interpolated, found, rivals(found, tuple(map(free, fewer)) if against else (), budget))


def _at_best(interpolated: Schedule, rule: str, table: GainTable, found: Climbed, notch: bool) -> Schedule:
    """Return the schedule at the point that a search ended in."""
    point = found.best.point if notch else np.append(found.best.point, table.bare)
    said = (_stiffer(table, point),) if notch else ()
    return replace(interpolated, rule=rule, findings=said, **table.held(point))


def _fixed(table: GainTable, robust: Gains, linear: Linear, task: Task, notch: bool) -> Family:
    """Return fixed gains as the first of the references, from those tuned for a hundredth of the step."""
    middle = int(np.argmin(np.abs(np.log(robust.amplitude / (1e-2 * task.step)))))
    pair = float(robust.kp[middle]), float(robust.kd[middle])
    first, *behind = table.begun
    return shaped(lambda judge: pd_family(judge, pair), linear, first, tuple(behind) if notch else None)


def _stiffer(table: GainTable, point: np.ndarray) -> Finding:
    """Return how much stiffer a table is, at its ratios, than it might be without its notch."""
    centre, depth = point[-table.bare.size :]
    kp, bare = (table.gains(one[None])[0][0] for one in (point, np.append(point[: -table.bare.size], table.bare)))
    return stiffer(centre, depth, float((kp / bare).min()), float((kp / bare).max()))
