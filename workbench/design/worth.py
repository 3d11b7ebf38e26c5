"""What a description is worth on the ladder: its schedule beside a two-level switch and beside fixed gains, by the same search."""

from collections.abc import Mapping
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


def worth_sentence(ours: Regret, others: Mapping[str, Regret]) -> str:
    """Say what the schedule of the description is worth: its worst regret in time and error beside those of the rivals."""

    def worst(r: Regret) -> str:
        time, error, over = r.worst
        if r.restless:
            return f"no rest on {r.restless} of {r.time.size} moves"
        return f"{time:.2f} in time, {error:.2f} in error, an overshoot of {100.0 * over:.1f} %"

    text = "; ".join(f"{n} {worst(r)}" for n, r in others.items())
    mine = max(ours.worst[:2])
    behind = [
        n
        for n, r in others.items()
        if r.restless > ours.restless
        or max(r.worst[:2]) > mine * (1.0 + EQUAL)
        or r.worst[2] > max(OVERSHOOT, ours.worst[2])
    ]
    rest = [n for n in others if n not in behind]
    said = f"The schedule of the description comes to {worst(ours)}; by the same search, {text}."
    if not rest:
        return (
            said
            + " So the description is worth its schedule: fewer levels take longer, leave more or overshoot on some move."
        )
    held = " and ".join(rest)
    return said + f" So against {held} the description's curve buys nothing here that shows in the worst move."
