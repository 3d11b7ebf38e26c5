"""From a plant to controllers: gains per amplitude, a schedule, and every family tuned on the simulated loop."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from workbench.control import fixed_pd
from workbench.describe import Equivalent
from workbench.finding import Finding
from workbench.frequency import Response
from workbench.plant import Plant
from workbench.schedule import BetweenKnots, Schedule, between_knots, fit_schedule, passivity
from workbench.simulate import Loop, Metrics, ScenarioArrays, simulate
from workbench.tune import Gains, TuningGoal, tune, tune_within
from workbench.verify.equivalent import equivalent_of, friction_of
from workbench.verify.families import blended, cascade_family, pd_family, scheduled_family
from workbench.verify.linear import Linear
from workbench.verify.optimise import Tuned, optimise
from workbench.verify.task import Task

RULES = ("following", "frozen")
ROUNDS = 2  # of describing and tuning: friction that depends on speed is described at the loop's own frequency
FASTEST = 0.2  # natural frequency times sample time that the first round assumes at most
LOWEST_KNOT = 1.0  # of the lowest tuned amplitude


@dataclass(frozen=True, eq=False)
class Designed:
    """equivalent, gains: over the tuned amplitudes. schedule: of the tuned gains. tuned: family name -> its best point.

    simulated: the nonlinear loop's steps of each amplitude under the gains tuned for it. between: the schedule's
    sensitivity and stability between its knots.

    final: the schedule of two modes that the simulated loop ended with, rule -> Schedule; what is exported.
    """

    plant: Plant
    equivalent: Equivalent
    gains: Gains
    schedule: Schedule
    simulated: Metrics
    between: BetweenKnots
    tuned: dict[str, Tuned]
    final: dict[str, Schedule]
    findings: tuple[Finding, ...] = ()


def gains_of(
    plant: Plant,
    amplitudes: np.ndarray,
    goal: TuningGoal,
    loop: Loop,
    margins: bool = True,
    response: Response | None = None,
) -> tuple[Equivalent, Gains]:
    """Return the equivalent friction of a plant and the gains tuned to it, at amplitudes (n,), rad or m.

    response: a measured frequency response whose modes limit the gains too.
    """
    friction, inertia, viscous = friction_of(plant)
    omega = np.minimum(np.sqrt(goal.drive / (amplitudes * inertia)), FASTEST / loop.sample_time)
    for _ in range(ROUNDS):
        equivalent = equivalent_of(friction, amplitudes, omega, loop.resolution)
        if response is None:
            gains = tune(equivalent, inertia, viscous, goal, loop)
        else:
            gains = tune_within(response, equivalent, inertia, viscous, goal, loop)
        omega = np.sqrt((gains.kp + equivalent.stiffness) / inertia)
    return equivalent, gains


def described_at(plant: Plant, equivalent: Equivalent, gains: Gains, loop: Loop) -> Callable[[np.ndarray], Equivalent]:
    """Return amplitudes (n,) -> Equivalent of the plant's friction, each at the natural frequency that the gains give it."""
    friction, inertia, _ = friction_of(plant)
    omega = np.log(np.sqrt((gains.kp + equivalent.stiffness) / inertia))

    def at(amplitudes: np.ndarray) -> Equivalent:
        known = np.exp(np.interp(np.log(amplitudes), np.log(gains.amplitude), omega))
        return equivalent_of(friction, amplitudes, known, loop.resolution)

    return at


def linear_of(plant: Plant, equivalent: Equivalent, loop: Loop) -> Linear:
    """Return the linearisations that every law must be robust on: gross sliding, and the stiffest presliding spring."""
    _, inertia, viscous = friction_of(plant)
    return Linear(loop, inertia, viscous, np.array([0.0, float(equivalent.stiffness.max())]), equivalent)


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
    per_octave: int = 2,
    tolerance: float = 0.02,
    seed: int = 1,
    say: Callable[[str], None] = lambda _: None,
    baselines: bool = True,
    response: Response | None = None,
) -> Designed:
    """Tune gains and schedule on the equivalents, then every family on the simulated loop of `task`, on this plant.

    response: a measured one, with modes that the plant does not have; it limits the gains at each amplitude, and the finding
    says by how much. The families' own search knows the plant alone.
    """
    loop = task.loop
    say("tuning gains at each amplitude")
    equivalent, gains = gains_of(plant, amplitudes, goal, loop, response=response)
    say("fitting the schedule")
    schedule = fit_schedule(
        gains,
        per_octave=per_octave,
        lowest=float(amplitudes[0]),
        highest=float(amplitudes[-1]),
        tolerance=tolerance,
        plant_digest=plant.digest,
        plant_lines=plant.digest_lines(),
        loop=loop,
    )
    say("checking the gains on the simulated loop, and between the knots")
    simulated = steps_of(plant, gains, task)
    _, inertia, viscous = friction_of(plant)
    equivalent_at = described_at(plant, equivalent, gains, loop)
    between = between_knots(
        schedule, equivalent_at, inertia, loop, viscous=viscous, sensitivity=goal.sensitivity, points=3
    )
    linear = linear_of(plant, equivalent, loop)
    gross = (float(gains.kp[-1]), float(gains.kd[-1]))
    families = [scheduled_family(linear, schedule, rule, gross) for rule in RULES]
    if baselines:
        middle = int(np.argmin(np.abs(np.log(amplitudes / (1e-2 * task.step)))))
        start = (float(gains.kp[middle]), float(gains.kd[middle]))
        families.append(pd_family(linear, start))
        kv = start[0] / start[1]
        families.append(cascade_family(linear, (kv, start[1], 0.1 * kv * start[1]), plant.limits.speed))
    tuned = {}
    own = task.on(plant)
    for family in families:
        say(f"tuning {family.name} on the simulated loop")
        tuned[family.name] = optimise(own, family, seed)
    final = {rule: two_modes(schedule, tuned[f"scheduled PD ({rule})"], rule) for rule in RULES}
    pumping = passivity(final["following"], equivalent_at, inertia, viscous=viscous)
    findings = (*(f for f in gains.findings if f.kind == "response limits"), *between.findings, *pumping.findings)
    return Designed(plant, equivalent, gains, schedule, simulated, between, tuned, final, findings)


def steps_of(plant: Plant, gains: Gains, task: Task) -> Metrics:
    """Return steps of each tuned amplitude from rest under its own gains, on the nonlinear loop without noise, one a lane.

    time_own and overshoot are about the response's own final value, as they were tuned.
    """
    scenarios = ScenarioArrays(gains.amplitude.size, target=gains.amplitude, phase=0.5)
    exact = replace(
        task.loop, resolution=0.0
    )  # small amplitudes are a few counts: what is checked here is the friction
    duration = max(4.0 * float(gains.time.max()), task.duration)
    return simulate(plant, exact, fixed_pd(gains.kp, gains.kd), scenarios, duration, own=True)
