"""Error against margin: the same controllers tuned for several limits on the sensitivity."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.plant import Plant
from workbench.tune import TuningGoal
from workbench.verify.contest import judged
from workbench.verify.line_up import line_up
from workbench.verify.optimise import optimise
from workbench.verify.task import Task


@dataclass(frozen=True, eq=False)
class AgainstMargin:
    """limits (n,): on Ms. values: name of a controller -> figure (as verify.contest.Standing) -> (n,)."""

    limits: np.ndarray
    values: dict[str, dict[str, np.ndarray]]


def against_margin(
    plant: Plant,
    amplitudes: np.ndarray,
    goal: TuningGoal,
    task: Task,
    names: Sequence[str],
    limits: Sequence[float],
    *,
    tuning_time: float,
    seed: int = 1,
    say: Callable[[str], None] = lambda _: None,
) -> AgainstMargin:
    """Tune the named families anew for each limit, gains per amplitude included, and judge them as a contest does."""
    rows: dict[str, list] = {n: [] for n in names}
    for limit in limits:
        say(f"tuning for a sensitivity of at most {limit:g}")
        bounded = replace(task, weights=replace(task.weights, sensitivity=limit))
        made = line_up(plant, amplitudes, replace(goal, sensitivity=limit), bounded)
        training = replace(bounded, load_inertias=task.load_inertias[:1], duration=tuning_time)
        for name in names:
            tuned = optimise(training, made.family(name), seed)
            rows[name].append(judged(task, (tuned.controller,)))
    values = {n: {k: np.array([row[k][0] for row in found]) for k in found[0]} for n, found in rows.items()}
    return AgainstMargin(np.array(limits), values)
