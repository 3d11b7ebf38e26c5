"""From a plant to controllers: gains per amplitude, a table tuned over the ladder, and baselines on the simulated loop."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from workbench.description import Equivalent
from workbench.description.friction import RigidAxis
from workbench.design.climb import Climb, Climbed
from workbench.design.families.family import Family, blended, cascade_family, pd_family, profile_family
from workbench.design.families.gain_table import BEGUN
from workbench.design.families.linear import Linear
from workbench.design.families.shaped import shaped
from workbench.design.optimise import Tuned, optimise_all
from workbench.design.polish import Polished, polish
from workbench.design.regret import Regret
from workbench.design.tabled import RUNS, Tabled, tabled
from workbench.design.worth import Rivals, regret_of
from workbench.finding import RESPONSE_LIMITS, Finding
from workbench.frequency import Response
from workbench.plant import Limits, Plant
from workbench.schedule import BetweenKnots, Schedule, between_knots, passivity
from workbench.simulation import Loop, loop_under
from workbench.task.task import Task
from workbench.tuning import Gains, TunedAxis, TuningGoal, tuned_axis

BRAKING = 0.65  # of the torque that the drive has: where a search for the deceleration of a profile begins
REACHED = 0.98  # of the speed limit: what laws ask for, so that the drive keeps some torque there
# Of the sampling rate, and at its centre: the notch at which a search on one mass begins, near the stiffest PD at every Kp/Kd. On the main
# study it takes the fixed PD's worst error from 1.22 to 0.78 mrad, the cost of cascade and profile by 0.2 %, and twice the CPU time.
LEADS, DEEP = 0.065, 0.6


@dataclass(frozen=True, eq=False)
class Designed:
    """equivalent, gains: over the tuned amplitudes, in closed form. polished: the same on simulated steps. schedule: through
    the robust ones of these. tuned: family name -> its best point.

    final: the schedule that the search over the ladder ended with, rule -> Schedule; what is exported. between: its
    sensitivity and stability between its knots. climbed: that search. rivals: what has fewer levels. unnotched: those of `tuned`
    that have a notch among their numbers, by the same search from the same seed without one.
    """

    plant: Plant
    equivalent: Equivalent
    gains: Gains
    schedule: Schedule
    polished: Polished
    between: BetweenKnots
    tuned: dict[str, Tuned | Climb]
    final: dict[str, Schedule]
    climbed: Climbed
    rivals: Rivals
    findings: tuple[Finding, ...] = ()
    unnotched: Mapping[str, Tuned] = field(default_factory=dict)


def linear_of(rigid: RigidAxis, equivalent: Equivalent, loop: Loop) -> Linear:
    """Return the linearisations that every law must be robust on: gross sliding, and the stiffest presliding spring."""
    springs = np.array([0.0, float(equivalent.stiffness.max())])
    return Linear(loop, rigid.inertia, rigid.viscous, springs, equivalent)


def two_modes(schedule: Schedule, tuned: Tuned, rule: str) -> Schedule:
    """Return the schedule with the gains of gross sliding beyond the switch, as the search found them."""
    blend = blended(schedule, tuned.point, rule)
    return replace(schedule, kp=blend.kp, kd=blend.kd, rule=rule)


def design(
    plant: Plant,
    amplitudes: np.ndarray,
    goal: TuningGoal,
    task: Task,
    *,
    rule: str = "error",
    load: float | None = None,
    per_octave: int = 2,
    tolerance: float = 0.02,
    seeds: Sequence[int] = RUNS,
    say: Callable[[str], None] = lambda _: None,
    baselines: bool = True,
    response: Response | None = None,
    notch: bool = True,
) -> Designed:
    """Tune gains on the equivalents and on simulated steps, the table of a rule over the ladder, and the baselines, on this plant.

    load: torque or force of the ladder. notch: whether the table has one among its numbers. seeds: of the table's search; its first half tunes the baselines. response: a measured
    one, with modes that the plant does not have; it limits the gains at each amplitude, and the finding says by how much. The
    searches on the simulated loop know the plant alone.
    """
    loop, own = task.loop, replace(task, plant=plant)
    say("tuning gains at each amplitude")
    axis = tuned_axis(plant, amplitudes, goal, loop, response=response)
    polished = polish(axis, goal, own, say)
    linear = linear_of(axis.rigid, axis.equivalent, loop)
    made = tabled(
        polished, linear, goal, own, rule, per_octave=per_octave, tolerance=tolerance, load=load, seeds=seeds, say=say,
        against=baselines, notch=notch,
    )  # fmt: skip
    tuned: dict[str, Tuned | Climb] = {f"scheduled PD ({rule})": made.climbed.best}
    unnotched: dict[str, Tuned] = {}
    if baselines:
        tuned |= best_of(own, baseline_families(plant.limits, linear, axis.gains, task), seeds, say)
        say("tuning the baselines without a notch")
        bare = baseline_families(plant.limits, linear, axis.gains, task, notch=False)
        found = optimise_all([(own, f, tuned[f.name].seed) for f in bare])
        unnotched = {one.family.name: one for one in found}
    say("checking the gains between the knots")
    between, findings = _checked(made, axis, goal, loop)
    return Designed(
        plant, axis.equivalent, axis.gains, made.interpolated, polished, between, tuned, {rule: made.schedule}, made.climbed,
        made.rivals, findings, unnotched,
    )  # fmt: skip


def _checked(made: Tabled, axis: TunedAxis, goal: TuningGoal, loop: Loop) -> tuple[BetweenKnots, tuple[Finding, ...]]:
    """Return how robust the table is between its knots, and what is to be said of it and of the gains that it began with."""
    at, inertia, viscous = axis.described(loop.resolution), axis.rigid.inertia, axis.rigid.viscous
    own_loop = loop_under(made.climbed.best.controller(), loop)
    between = between_knots(
        made.schedule, at, inertia, own_loop, viscous=viscous, sensitivity=goal.sensitivity, points=3
    )
    pumping = passivity(replace(made.schedule, rule="following"), at, inertia, viscous=viscous)
    limits = (f for f in axis.gains.findings if f.kind == RESPONSE_LIMITS)
    return between, (*limits, *between.findings, *pumping.findings)


def baseline_families(
    limits: Limits, linear: Linear, gains: Gains, task: Task, *, notch: bool = True
) -> tuple[Family, ...]:
    """Return the families that a scheduled PD is held against, each with its velocity filter and, where asked, a notch.

    A rigid axis has no resonance, but beyond its centre a wide notch leads in phase: a PD may be 1.6 times as stiff at the same |S|.
    """
    middle = int(np.argmin(np.abs(np.log(gains.amplitude / (1e-2 * task.step)))))
    kp, kd = float(gains.kp[middle]), float(gains.kd[middle])
    kv, speed = kp / kd, REACHED * limits.speed
    start = (kv, kd, 0.1 * kv * kd)
    braking = BRAKING * limits.drive / linear.inertia
    makers = (
        lambda judge: pd_family(judge, (kp, kd)),
        lambda judge: cascade_family(judge, start, speed),
        lambda judge: profile_family(judge, (*start, braking), speed, task.step),
    )
    dt = task.loop.sample_time
    return tuple(shaped(make, linear, BEGUN * dt, (LEADS / dt, DEEP) if notch else None) for make in makers)


def best_of(
    task: Task, families: Sequence[Family], seeds: Sequence[int], say: Callable[[str], None]
) -> dict[str, Tuned]:
    """Return the best of each family from several seeds, by name."""
    say(f"tuning {', '.join(f.name for f in families)} on the simulated loop")
    used = tuple(seeds)[: max(len(seeds) // 2, 1)]
    # one family after the other, so that kernels of different ones are compiled side by side
    runs = optimise_all([(task, f, seed) for seed in used for f in families])
    return {f.name: min((r for r in runs if r.family is f), key=lambda r: r.value) for f in families}


def regrets_on_ladder(made: Designed, names: Sequence[str]) -> tuple[dict[str, Regret], dict[str, Regret]]:
    """Return the regrets of what has fewer levels than the table, and of tuned controllers by name, on the table's ladder."""
    on, known = made.climbed.on, made.climbed.references
    fewer = {r.family.name: regret_of(on, r, known) for r in made.rivals.found}
    return fewer, {n: regret_of(on, made.tuned[n], known) for n in names}
