"""Compensation of the named causes, beside gains that were tuned anew: the same step and the same reference, in one kernel.

The gains stay those of the declared model, and the causes are cancelled from the measured position, exactly and off by
MISMATCH either way. Which of the two an engineer should take: what brings the larger share of the difference, and keeps it
with the mismatch.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite

import numpy as np

from workbench.cancellation.following import with_gains
from workbench.compensation import READ, Compensator
from workbench.compensation.compensator import refused
from workbench.control import Controller
from workbench.plant import Plant
from workbench.simulation import Metrics, simulate
from workbench.task.task import Task

MISMATCH = 0.3
GAINS = (1.0, 1.0 - MISMATCH, 1.0 + MISMATCH)
FIGURES = ("rise", "time_1pct", "overshoot", "final_error", "following")
COUNTED = 1.05  # a time or an error that is larger by as much is worse
FLAT = 2e-3  # overshoot that is allowed in tuning: less is equal


@dataclass(frozen=True)
class Cancelled:
    """effects: keys of what is cancelled; left: of causes that no drive cancels. figures: gain of the compensation -> rise
    (s), time_1pct (s), overshoot (share), final_error and following (rad or m; NaN without a reference), worst of phases."""

    effects: tuple[str, ...]
    left: tuple[str, ...]
    figures: Mapping[float, Mapping[str, float]]

    @property
    def exact(self) -> Mapping[str, float]:
        return self.figures[1.0]

    @property
    def worst(self) -> dict[str, float]:
        """The worst of the mismatch either way."""
        return {n: max(self.figures[g][n] for g in GAINS) for n in FIGURES}


def causes(declared: Plant, extended: Plant) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return (keys of added effects that are cancelled from what is measured, keys of those that are not)."""
    known = {e.key for e in declared.effects}
    added = [e for e in extended.effects if e.key not in known]
    can = tuple(e.key for e in added if not refused(e, READ))
    return can, tuple(e.key for e in added if e.key not in can)


def cancelled(
    task: Task, factory: Callable[[int], Controller], effects: Sequence[str], left: Sequence[str], rise, phases: int,
    reference: np.ndarray | None = None,
) -> Cancelled:  # fmt: skip
    """Return what cancelling the effects of the task's plant comes to. rise(time, q, start, target): (lanes,) s.

    factory: lanes -> controller. reference (n,): of a record, to be followed besides.
    """
    compensator = Compensator.of(task.plant, tuple(effects))
    output = "q" if task.plant.kind == "one mass" else "load.q"
    one = task.scenarios(phases=phases)
    lanes = one.lanes * len(GAINS)
    spread = np.tile(np.arange(one.lanes), len(GAINS))
    fields = {
        n: (v[spread] if np.ndim(v) and np.size(v) == one.lanes else v) for n, v in vars(one).items() if n != "lanes"
    }
    scenarios = replace(one, lanes=lanes, **fields)
    made = with_gains(factory(lanes), compensator, np.repeat(GAINS, one.lanes))

    def run(r: np.ndarray, start: float) -> Metrics:
        return simulate(
            task.plant, task.loop, made, replace(scenarios, start=start), len(r) * task.loop.sample_time, (output,),
            reference=r, criteria=task.criteria, lanes=phases,
        )  # fmt: skip

    samples = int(round(task.duration / task.loop.sample_time))
    target = np.broadcast_to(scenarios.target, (lanes,))
    m = run(np.broadcast_to(target, (samples, lanes)).copy(), task.start)
    rises = rise(m.trajectories.time, m.trajectories[output], task.start, target)
    following = np.full(lanes, np.nan)
    if reference is not None:
        following = run(np.repeat(reference[:, None], lanes, axis=1), float(reference[0])).following_error
    columns = dict(zip(FIGURES, (rises, m.time_1pct, m.overshoot, m.final_error, following), strict=True))
    figures = {
        g: {n: float(np.max(v[k * one.lanes : (k + 1) * one.lanes])) for n, v in columns.items()}
        for k, g in enumerate(GAINS)
    }
    return Cancelled(tuple(effects), tuple(left), figures)


def take(blind: Mapping[str, float], knowing: Mapping[str, float], found: Cancelled) -> str:
    """Return what an engineer should take: "compensation", "gains", "both alike" or "neither".

    One is better than the gains that know nothing where its 1 % time or its final error is smaller and neither the other of
    them nor the overshoot is larger; compensation must be so with the mismatch too.
    """

    def better(now: Mapping[str, float]) -> float:
        ratios = [_ratio(now[n], blind[n]) for n in ("time_1pct", "final_error")]
        worse = max(ratios) > COUNTED or now["overshoot"] > max(blind["overshoot"], FLAT) * COUNTED
        return 0.0 if worse else -sum(np.log(max(r, 1e-6)) for r in ratios)

    gain, cancel = better(knowing), min(better(found.exact), better(found.worst))
    least = np.log(COUNTED)
    if max(gain, cancel) < least:
        return "neither"
    if abs(gain - cancel) < least:
        return "both alike"
    return "compensation" if cancel > gain else "gains"


def _ratio(now: float, was: float) -> float:
    """Return now/was, where never is larger than everything."""
    if not isfinite(now):
        return 1.0 if not isfinite(was) else inf
    return 0.0 if not isfinite(was) else now / max(was, 1e-300)
