"""What a description is worth on the ladder: its schedule beside a two-level switch and beside fixed gains, by the same search."""

from dataclasses import dataclass, replace

from workbench.design.climb import Climb, Climbed, Climbing, evolved
from workbench.design.families.family import Family, OfFamily
from workbench.design.ladder import Ladder, all_rungs, climbed
from workbench.design.regret import OVERSHOOT, References, Regret, regret
from workbench.processes import shared
from workbench.simulation import followed
from workbench.task.task import Task

EQUAL = 0.05  # of a regret: what two searches of one family part by; nearer than that, neither is better


@dataclass(frozen=True, eq=False)
class Rivals:
    """found: each with fewer numbers than the table, tuned by the same search over the same ladder."""

    found: tuple[OfFamily, ...]


def rivals(climbed_by: Climbed, families: tuple[Family, ...], budget: Climbing) -> Rivals:
    """Tune families over the ladder of a table, from its best run's seed, against its references."""
    seed = climbed_by.best.seed

    def found(family: Family) -> Climb:
        one = evolved(climbed_by.on, family, climbed_by.references, seed, budget)
        return replace(one, family=None)  # a family is functions: every process has it

    made = zip(shared(found, families), families, strict=True)
    return Rivals(tuple(replace(one, family=family) for one, family in made))


def regret_of(on: Ladder, one: OfFamily, known: References, task: Task | None = None, follow=followed) -> Regret:
    """Return the regret of any tuned controller on a ladder, climbed by the plant of `task` where it is another. follow: as of `climbed`."""
    on = on if task is None else replace(on, task=task)
    point = one.point[None, :]
    return regret(on, climbed(on, one.family, point, all_rungs(on, point), follow=follow)[0], known)


def behind(one: Regret, ours: Regret) -> bool:
    """Whether a rival's worst move is worse than that of the schedule: it comes to no rest, takes longer, leaves more or overshoots."""
    return (
        one.restless > ours.restless
        or max(one.worst[:2]) > max(ours.worst[:2]) * (1.0 + EQUAL)
        or one.worst[2] > max(OVERSHOOT, ours.worst[2])
    )
