"""The controllers of two masses, tuned alike: schedules over the output and over the joint, and cascades on either encoder."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from workbench.cancellation.contestant import SUFFIX
from workbench.cancellation.contestant import entered as compensating
from workbench.cancellation.worth import check_controller
from workbench.description import Equivalent
from workbench.design.baselines import BRAKING, REACHED
from workbench.design.families.family import (
    Family,
    cascade_family,
    pd_family,
    profile_family,
    scheduled_family,
    soft_gains,
)
from workbench.design.families.linear import TwoMasses
from workbench.design.families.shaped import shaped, stiffest
from workbench.design.joint import (
    JointGains,
    joint_equivalent,
    joint_gains,
    joint_passivity,
    joint_schedule,
)
from workbench.plant import Plant
from workbench.schedule import Passivity, Schedule
from workbench.simulation import Loop
from workbench.study.compensation import asked
from workbench.study.configuration import Study
from workbench.study.control import Control
from workbench.verification.contest import Contest, contest, entered
from workbench.verification.controllers import controllers_of

from .plant import Assumed

OUTPUT, JOINT = "scheduled PD (following)", "scheduled PD (relative displacement)"
WIDE = "scheduled PD (relative displacement), worst case"
FIXED, BEST = "fixed PD", "profile with PI"
BOTH, ON_MOTOR, ON_LOAD = "PI cascade, both encoders", "PI cascade, motor encoder", "PI cascade, output encoder"
PER_OCTAVE, AMPLITUDES = (
    2,
    20,
)  # of the schedule over the joint: knots an octave, and amplitudes that gains are tuned at
KV = 50.0  # 1/s: Kp/Kd where the searches begin, near 2 drive/(mass speed), the slope at which full speed is braked
STIFFER = (3.0, 8.0)  # most of the tuned gains, Kp and Kd: with a notch |S| allows twice what they were tuned to
KEYS = ("seeds", "tuning_time", "amplitudes", "reversal")  # of [contest]


@dataclass(frozen=True, eq=False)
class Over:
    """The schedule over the relative displacement. plant: the paper's, of one hysteretic spring. spring: its equivalent. gains: at
    its amplitudes. schedule: through them. motor, loads: kg*m^2. damping: of the joint."""

    plant: Plant
    spring: Equivalent
    gains: JointGains
    schedule: Schedule
    motor: float
    loads: tuple[float, float]
    damping: float

    def passivity(self, schedule: Schedule) -> tuple[Passivity, ...]:
        """Return what moving gains of a schedule feed in, with each load."""
        return tuple(joint_passivity(schedule, self.plant, self.motor, m) for m in self.loads)


def goal_of(control: Control, model: Assumed):
    return replace(control.goal, drive=model.rigid.limits.drive, speed=model.rigid.limits.speed)


def loads_of(control: Control, model: Assumed) -> tuple[float, float]:
    """Return the load without and with what is put on, kg*m^2."""
    return tuple(model.load + m for m in (control.task.load_inertias[0], control.task.load_inertias[-1]))


def over_joint(study: Study, control: Control, spring: Plant, model: Assumed, loop: Loop) -> Over:
    """Return gains over the relative displacement from the describing functions of the one spring that the paper identifies.

    model: the identified plant that controllers are tuned on; the schedule bears its digest.
    """
    contested = study.table.table("contest", KEYS)
    low, high = contested.numbers("amplitudes", (), "rad")
    equivalent = joint_equivalent(spring, np.geomspace(low, high, AMPLITUDES))
    motor = spring["inertia@motor"].parameters["inertia"].value
    loads = loads_of(control, model)
    gains = joint_gains(equivalent, motor, loads, model.damping, goal_of(control, model), loop)
    back = contested.number("reversal", above=0.0) * loop.resolution
    schedule = joint_schedule(gains, loop, back, model.plant, PER_OCTAVE, control.tolerance)
    return Over(spring, equivalent, gains, schedule, motor, loads, model.damping)


def families(study: Study, control: Control, model: Assumed, loop: Loop, over: Over) -> tuple[Family, ...]:
    """Every controller: speeds are the motor's, positions the output's, except in the two cascades of one encoder."""
    rigid = model.rigid
    one = replace(loop, resolution=loop.load_resolution, load_resolution=0.0, feedback="position")
    first = controllers_of(
        rigid, control.amplitudes, goal_of(control, model), replace(control.task.on(rigid), loop=one),
        per_octave=control.per_octave, tolerance=control.tolerance,
    )  # fmt: skip
    loads = np.repeat(loads_of(control, model), 2)
    stiff = np.tile(model.stiffnesses, 2)
    motor = model.plant["inertia@motor"].parameters["inertia"].value

    def linear(motor_position: bool, motor_speed: bool) -> TwoMasses:
        return TwoMasses(loop, motor, loads, stiff, model.damping, motor_position, motor_speed)

    speed, braking = REACHED * rigid.limits.speed, BRAKING * rigid.limits.drive / (motor + model.load)
    soft = soft_gains(motor + model.load, rigid.limits.drive, rigid.limits.speed)

    def pd(begin):
        return begin["kp"], begin["kp"] / KV

    def cascade(begin):
        return KV, begin["kp"] / KV, 0.1 * begin["kp"]

    own, moves = {"motor_speed": True}, control.task.step
    both, on_motor, on_load = linear(False, True), linear(True, True), linear(False, False)
    makers = (
        (both, lambda j, b: scheduled_family(j, first.schedule, "following", pd(b), soft=soft, most=STIFFER, **own)),
        (both, lambda j, b: scheduled_family(j, over.schedule, "following", pd(b), follows="joint", soft=soft, most=STIFFER, **own)),
        (both, lambda j, b: pd_family(j, pd(b), **own)),
        (both, lambda j, b: cascade_family(j, cascade(b), speed, name=BOTH, **own)),
        (on_motor, lambda j, b: cascade_family(j, cascade(b), speed, motor_position=True, name=ON_MOTOR)),
        (on_load, lambda j, b: cascade_family(j, cascade(b), speed, name=ON_LOAD)),
        (both, lambda j, b: profile_family(j, (*cascade(b), braking), speed, moves, **own)),
    )  # fmt: skip
    begins = {j: stiffest(j, KV, control.goal.sensitivity) for j in (both, on_motor, on_load)}
    return tuple(
        shaped(partial(make, b=begins[j]), j, begins[j]["velocity_filter"], (begins[j]["notch"], begins[j]["notch depth"]))
        for j, make in makers
    )  # fmt: skip


def held(study: Study, control: Control, known: Assumed, model: Assumed, loop: Loop, over: Over, say) -> Contest:
    """Tune every controller on the identified plant, with and without the load, and judge it on the assumed one.

    The paper's two schedules are tuned to be quick and accurate at nominal inertia and friction, and not to overshoot beyond
    them; WIDE is the one over the joint, tuned for its worst case as all others are.
    """
    contested = study.table.table("contest", KEYS)
    task = replace(control.task.on(known.plant), loop=loop)
    every = {f.name: f for f in families(study, control, model, loop, over)}
    time = contested.quantity("tuning_time", "s", above=0.0)
    seeds = [int(s) for s in contested.numbers("seeds", (1.0,))]
    rest = [f for n, f in every.items() if n not in (OUTPUT, JOINT)] + [cancelling(study, model, every)]
    found = contest(task, rest, tuning_time=time, seeds=seeds, loaded=True, known=model.plant, say=say)
    wide = replace(task, duration=time).on(model.plant)
    narrow = replace(wide, nominal=True, frictions=between(task.frictions), inertias=between(task.inertias))
    ours = {}
    for name, training in ((OUTPUT, narrow), (JOINT, narrow), (WIDE, wide)):
        say(f"tuning {name} from {len(seeds)} seeds")
        ours[name] = entered(task, training, every[OUTPUT if name == OUTPUT else JOINT], seeds, name)
    return replace(found, standings={**ours, **found.standings})


def between(factors: tuple[float, ...]) -> tuple[float, ...]:
    """Return the factors with 1 among them."""
    return tuple(sorted({*factors, 1.0}))


def cancelling(study: Study, model: Assumed, every: Mapping[str, Family]) -> Family:
    """Return the controller of [compensation] with its compensation, of what was identified; it is tuned and judged as any other."""
    given = asked(study, model.plant)
    check_controller(given, every)
    base = every[given.controller]
    return compensating(base, given.on(model.plant), base.start)


def figures_of(found: Contest) -> tuple[dict[str, float], dict[str, str]]:
    """Return (figures, units) by which the study is judged; medians over the seeds."""

    def of(name, figure):
        return found[name].median(figure)

    errors = {
        "joint_error": of(JOINT, "error"),
        "joint_error_loaded": of(JOINT, "error_loaded"),
        "output_error": of(OUTPUT, "error"),
        "both_encoders_error_grid": of(BOTH, "error_grid"),
        "motor_encoder_error_grid": of(ON_MOTOR, "error_grid"),
        "output_cascade_error_grid": of(ON_LOAD, "error_grid"),
        "joint_error_grid": of(JOINT, "error_grid"),
        "joint_error_worst_case": of(WIDE, "error"),
        "joint_error_grid_worst_case": of(WIDE, "error_grid"),
        "profile_pi_error_grid": of(BEST, "error_grid"),
    }
    ratios = {
        "joint_time_over_output": of(JOINT, "time") / of(OUTPUT, "time"),
        "joint_time_over_output_loaded": of(JOINT, "time_loaded") / of(OUTPUT, "time_loaded"),
        "joint_time_over_bound": found.over_bound(JOINT),
        "output_cascade_time_over_bound": found.over_bound(ON_LOAD),
        "profile_pi_time_over_bound": found.over_bound(BEST),
        "both_encoders_time_over_bound": found.over_bound(BOTH),
        "sensitivity": max(of(n, "sensitivity") for n in found.standings),
        "overshoot": max(of(n, "overshoot_grid") for n in found.standings if not n.endswith(SUFFIX)),
        **{f"compensated_{n}": of(f"{FIXED}{SUFFIX}", n) for n in ("overshoot_grid", "error_grid")},
    }
    return {**errors, **ratios}, dict.fromkeys((*errors, "compensated_error_grid"), "rad")
