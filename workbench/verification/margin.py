"""Error against margin: the same controllers tuned for several limits on the sensitivity."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.design.families.family import Family
from workbench.design.optimise import BUDGET, Budget, optimise_all
from workbench.task.task import Task
from workbench.verification.contest import Contest, judged


@dataclass(frozen=True, eq=False)
class AgainstMargin:
    """limits (n,): on Ms. values: name of a controller -> figure (as verification.contest.Result) -> (n,)."""

    limits: np.ndarray
    values: dict[str, dict[str, np.ndarray]]


@dataclass(frozen=True, eq=False)
class Asked:
    """A figure that was asked for and is not had within the study's own limit on Ms. name: as results.json has it. what: as the
    report says it. asked, obtained: SI. values (n,): what it comes to at each limit of an AgainstMargin. why: a clause."""

    name: str
    what: str
    asked: float
    obtained: float
    values: np.ndarray
    unit: str
    why: str

    def had_at(self, limits: np.ndarray) -> float | None:
        """Return the lowest of the limits (n,) on Ms at which it is had, or None."""
        had = np.asarray(limits)[self.values <= self.asked]
        return float(had.min()) if had.size else None


def against_margin(
    task: Task,
    limits: Sequence[float],
    families: Callable[[float], Mapping[str, Family]],
    *,
    tuning_time: float,
    loaded: bool = False,
    seed: int = 1,
    budget: Budget = BUDGET,
    found: Contest | None = None,
    say: Callable[[str], None] = lambda _: None,
) -> AgainstMargin:
    """Tune families(limit) -> {name: Family} anew for each limit on Ms, and judge them as a contest does.

    tuning_time, loaded: as for a contest. found: a contest of the same task and families, whose run from this seed stands for
    the task's own limit.
    """
    rows: dict[str, list] = {}
    loads = task.load_inertias if loaded else task.load_inertias[:1]
    for limit in limits:
        known = found.standings if found is not None and limit == task.weights.sensitivity else {}
        say(f"tuning for a sensitivity of at most {limit:g}")
        bounded = replace(task, weights=replace(task.weights, sensitivity=limit))
        training = replace(bounded, load_inertias=loads, duration=tuning_time)
        every = families(limit)
        of = {n: known[n].of_seed(seed) if n in known else None for n in every}
        tuned = iter(optimise_all([(training, every[n], seed) for n in every if of[n] is None], budget))
        for name in every:
            rows.setdefault(name, []).append(of[name] or judged(task, (next(tuned).controller,)))
    values = {n: {k: np.array([row[k][0] for row in each]) for k in each[0]} for n, each in rows.items()}
    return AgainstMargin(np.array(limits), values)
