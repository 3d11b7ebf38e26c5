"""Error against margin: the same controllers tuned for several limits on the sensitivity."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.verify.contest import judged
from workbench.verify.families import Family
from workbench.verify.optimise import optimise
from workbench.verify.task import Task


@dataclass(frozen=True, eq=False)
class AgainstMargin:
    """limits (n,): on Ms. values: name of a controller -> figure (as verify.contest.Standing) -> (n,)."""

    limits: np.ndarray
    values: dict[str, dict[str, np.ndarray]]


def against_margin(
    task: Task,
    limits: Sequence[float],
    families: Callable[[float], Mapping[str, Family]],
    *,
    tuning_time: float,
    loaded: bool = False,
    seed: int = 1,
    say: Callable[[str], None] = lambda _: None,
) -> AgainstMargin:
    """Tune families(limit) -> {name: Family} anew for each limit on Ms, and judge them as a contest does.

    tuning_time, loaded: as for a contest.
    """
    rows: dict[str, list] = {}
    loads = task.load_inertias if loaded else task.load_inertias[:1]
    for limit in limits:
        say(f"tuning for a sensitivity of at most {limit:g}")
        bounded = replace(task, weights=replace(task.weights, sensitivity=limit))
        training = replace(bounded, load_inertias=loads, duration=tuning_time)
        for name, family in families(limit).items():
            tuned = optimise(training, family, seed)
            rows.setdefault(name, []).append(judged(task, (tuned.controller,)))
    values = {n: {k: np.array([row[k][0] for row in found]) for k in found[0]} for n, found in rows.items()}
    return AgainstMargin(np.array(limits), values)
