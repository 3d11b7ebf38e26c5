"""The baselines that a gain table is held against: where their searches begin, and those searches, with a notch and without."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.design.families.family import Family, cascade_family, pd_family, profile_family
from workbench.design.families.gain_table import BEGUN
from workbench.design.families.linear import Judge, Linear
from workbench.design.families.shaped import shaped
from workbench.design.optimise import Tuned, optimise_all
from workbench.plant import Limits
from workbench.task.task import Task
from workbench.tuning import Gains

BRAKING = 0.65  # of the torque that the drive has: where a search for the deceleration of a profile begins
REACHED = 0.98  # of the speed limit: what laws ask for, so that the drive keeps some torque there
# Of the sampling rate, and at its centre: the notch at which a search on one mass begins, near the stiffest PD at every Kp/Kd. On the main
# study it takes the fixed PD's worst error from 1.22 to 0.78 mrad, the cost of cascade and profile by 0.2 %, and twice the CPU time.
LEADS, DEEP = 0.065, 0.6


@dataclass(frozen=True)
class Starts:
    """Where searches of laws on a rigid axis begin. pd: (Kp, Kd) at the amplitude nearest a hundredth of the step. cascade: (Kv,
    Kd, Ki), the same PD with an integrator of Kv/10. profile: that, and a deceleration. speed: what laws ask for."""

    pd: tuple[float, float]
    cascade: tuple[float, float, float]
    profile: tuple[float, float, float, float]
    speed: float


def starts_of(gains: Gains, inertia: float, limits: Limits, step: float) -> Starts:
    """Return where searches begin on an axis of this inertia (or mass) with gains over amplitude, for moves of `step`."""
    middle = int(np.argmin(np.abs(np.log(gains.amplitude / (1e-2 * step)))))
    kp, kd = float(gains.kp[middle]), float(gains.kd[middle])
    kv = kp / kd
    cascade = (kv, kd, 0.1 * kv * kd)
    return Starts((kp, kd), cascade, (*cascade, BRAKING * limits.drive / inertia), REACHED * limits.speed)


def shaped_alike(
    makers: Iterable[Callable[[Judge], Family]], judge: Judge, sample_time: float, *, notch: bool
) -> tuple[Family, ...]:
    """Return families, each with its velocity filter and, where asked, a notch, all begun alike.

    A rigid axis has no resonance, but beyond its centre a wide notch leads in phase: a PD may be 1.6 times as stiff at the same |S|.
    """
    begun = (LEADS / sample_time, DEEP) if notch else None
    return tuple(shaped(make, judge, BEGUN * sample_time, begun) for make in makers)


def baseline_families(task: Task, linear: Linear, gains: Gains, *, notch: bool = True) -> tuple[Family, ...]:
    """Return the families that a gain table is held against on the task's plant: fixed PD, cascade, and profile."""
    begin = starts_of(gains, linear.inertia, task.plant.limits, task.step)
    makers = (
        lambda judge: pd_family(judge, begin.pd),
        lambda judge: cascade_family(judge, begin.cascade, begin.speed),
        lambda judge: profile_family(judge, begin.profile, begin.speed, task.step),
    )
    return shaped_alike(makers, linear, task.loop.sample_time, notch=notch)


def seeds_of(seeds: Sequence[int]) -> Sequence[int]:
    """Return the seeds that tune baselines: the first half of those of the table's search."""
    return tuple(seeds)[: max(len(seeds) // 2, 1)]


def best_of(task: Task, searches: Sequence[tuple[Family, Sequence[int]]]) -> list[Tuned]:
    """Return the best of each family from its seeds (as many for each), in order."""
    # one family after the other, so that kernels of different ones are compiled side by side
    rounds = zip(*(seeds for _, seeds in searches), strict=True)
    runs = optimise_all([(task, f, seed) for each in rounds for (f, _), seed in zip(searches, each, strict=True)])
    return [min((r for r in runs if r.family is f), key=lambda r: r.value) for f, _ in searches]


def tuned_baselines(
    task: Task, linear: Linear, gains: Gains, seeds: Sequence[int], say: Callable[[str], None]
) -> tuple[dict[str, Tuned], dict[str, Tuned]]:
    """Return the best of each baseline by name, and the same without a notch, by the same search from the best one's seed."""
    notched, bare = (baseline_families(task, linear, gains, notch=notch) for notch in (True, False))
    names, own = [f.name for f in notched], seeds_of(seeds)
    say(f"tuning {', '.join(names)} on the simulated loop, with a notch and without")
    if len(own) == 1:  # the best one's seed is known before: all side by side
        found = best_of(task, [(f, own) for f in (*notched, *bare)])
    else:
        found = best_of(task, [(f, own) for f in notched])
        found += best_of(task, [(f, (one.seed,)) for f, one in zip(bare, found, strict=True)])
    return tuple(dict(zip(names, part, strict=True)) for part in (found[: len(names)], found[len(names) :]))
