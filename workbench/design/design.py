"""From a plant to controllers: gains per amplitude, a table tuned over the ladder, and baselines on the simulated loop."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from workbench.description import Equivalent
from workbench.description.friction import RigidAxis
from workbench.design.baselines import tuned_baselines
from workbench.design.climb import Climb, Climbed
from workbench.design.families.family import blended
from workbench.design.families.linear import Linear
from workbench.design.optimise import Tuned
from workbench.design.polish import Polished, polish
from workbench.design.regret import Regret
from workbench.design.tabled import RUNS, Tabled, tabled
from workbench.design.worth import Rivals, regret_of
from workbench.finding import RESPONSE_LIMITS, Finding
from workbench.frequency import Response
from workbench.plant import Plant
from workbench.processes import shared
from workbench.schedule import BetweenKnots, Schedule, between_knots, passivity
from workbench.simulation import Loop, loop_under
from workbench.task.task import Task
from workbench.tuning import Gains, TunedAxis, TuningGoal, tuned_axis


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
    say("checking the gains between the knots")
    between, findings = _checked(made, axis, goal, loop)
    others, unnotched = tuned_baselines(own, linear, axis.gains, seeds, say) if baselines else ({}, {})
    return Designed(
        plant, axis.equivalent, axis.gains, made.interpolated, polished, between, tuned | others, {rule: made.schedule}, made.climbed,
        made.rivals, findings, unnotched,
    )  # fmt: skip


def _checked(made: Tabled, axis: TunedAxis, goal: TuningGoal, loop: Loop) -> tuple[BetweenKnots, tuple[Finding, ...]]:
    """Return how robust the table is between its knots, and what is to be said of it and of the gains that it began with."""
    law = made.climbed.best.controller()
    at, inertia, viscous = axis.described(loop.resolution), axis.rigid.inertia, axis.rigid.viscous
    own = loop_under(law, loop)
    between = between_knots(made.schedule, at, inertia, own, viscous=viscous, sensitivity=goal.sensitivity, points=3)
    pumping = passivity(replace(made.schedule, rule="following"), at, inertia, viscous=viscous)
    limits = (f for f in axis.gains.findings if f.kind == RESPONSE_LIMITS)
    return between, (*limits, *between.findings, *pumping.findings)


def regrets_on_ladder(made: Designed, names: Sequence[str]) -> tuple[dict[str, Regret], dict[str, Regret]]:
    """Return the regrets of what has fewer levels than the table, and of tuned controllers by name, on the table's ladder."""
    on, known = made.climbed.on, made.climbed.references
    fewer = {r.family.name: regret_of(on, r, known) for r in made.rivals.found}
    alone = shared(
        lambda name: regret_of(on, made.tuned[name], known), names
    )  # each law has a loop of its own to compile
    return fewer, dict(zip(names, alone, strict=True))
