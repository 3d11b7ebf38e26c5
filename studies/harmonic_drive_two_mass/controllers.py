"""The controllers of two masses, tuned alike: schedules over the output and over the joint, and cascades on either encoder."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.control import grid
from workbench.simulation import Loop
from workbench.study.compensating import asked, chosen
from workbench.study.configuration import Study
from workbench.study.controlling import Control
from workbench.study.controlling import numbers as numbers_of
from workbench.verification.compensated import SUFFIX, entered
from workbench.verification.contest import Contest, contest
from workbench.verification.families import (
    Family,
    cascade_family,
    joint_family,
    pd_family,
    profile_family,
    scheduled_family,
)
from workbench.verification.line_up import BRAKING, REACHED, line_up
from workbench.verification.linear import TwoMasses
from workbench.verification.margin import AgainstMargin, Asked, against_margin

from .plant import Assumed

OUTPUT, JOINT = "scheduled PD (following)", "scheduled PD (relative displacement)"
FIXED, BEST = "fixed PD", "profile with PI"
BOTH, ON_MOTOR, ON_LOAD = "PI cascade, both encoders", "PI cascade, motor encoder", "PI cascade, output encoder"
PER_OCTAVE = 2
KEYS = ("seeds", "tuning_time", "amplitudes", "reversal", "margins")  # of [contest]


def families(study: Study, control: Control, known: Assumed, loop: Loop) -> tuple[Family, ...]:
    """Every controller: speeds are the motor's, positions the output's, except in the two cascades of one encoder."""
    rigid = known.rigid
    goal = replace(control.goal, drive=rigid.limits.drive, speed=rigid.limits.speed)
    one = replace(loop, resolution=loop.load_resolution, load_resolution=0.0, feedback="position")
    first = line_up(
        rigid, control.amplitudes, goal, replace(control.task.on(rigid), loop=one), per_octave=control.per_octave,
        tolerance=control.tolerance,
    )  # fmt: skip
    loads = np.repeat([known.load + m for m in (control.task.load_inertias[0], control.task.load_inertias[-1])], 2)
    stiff = np.tile(known.stiffnesses, 2)
    motor = known.plant["inertia@motor"].parameters["inertia"].value

    def linear(motor_position: bool, motor_speed: bool) -> TwoMasses:
        return TwoMasses(loop, motor, loads, stiff, known.damping, motor_position, motor_speed)

    contested = study.table.table("contest", KEYS)
    at = np.array(numbers_of(contested, "amplitudes", (), "rad"))
    back = contested.number("reversal", above=0.0) * loop.resolution
    knots = grid(0.5 * at[0], 2.0 * at[-1], PER_OCTAVE)
    pd, kv = (250.0, 5.0), 50.0
    cascade, speed = (kv, pd[1], 0.1 * kv * pd[1]), REACHED * rigid.limits.speed
    braking = BRAKING * rigid.limits.drive / (motor + known.load)
    both = linear(False, True)
    return (
        scheduled_family(both, first.schedule, "following", pd, motor_speed=True),
        joint_family(both, knots, at, pd, back),
        pd_family(both, pd, motor_speed=True),
        cascade_family(both, cascade, speed, motor_speed=True, name=BOTH),
        cascade_family(linear(True, True), cascade, speed, motor_position=True, name=ON_MOTOR),
        cascade_family(linear(False, False), cascade, speed, filtered=True, name=ON_LOAD),
        profile_family(both, (*cascade, braking), speed, control.task.step, motor_speed=True),
    )


def held(study: Study, control: Control, known: Assumed, loop: Loop, say) -> tuple[Contest, AgainstMargin]:
    """Tune every controller with and without the load, and judge it; then the schedule over the joint for other margins."""
    contested = study.table.table("contest", KEYS)
    task = replace(control.task.on(known.plant), loop=loop)
    every = families(study, control, known, loop)
    time, seeds = (
        contested.quantity("tuning_time", "s", above=0.0),
        [int(s) for s in numbers_of(contested, "seeds", (1.0,))],
    )
    found = contest(
        task, (*every, cancelling(study, known, every)), tuning_time=time, seeds=seeds, loaded=True, say=say
    )
    scheduled = {f.name: f for f in every if f.name == JOINT}
    limits = numbers_of(contested, "margins", (2.0,))
    margins = against_margin(
        task, limits, lambda _: scheduled, tuning_time=time, loaded=True, seed=seeds[0], found=found, say=say
    )
    return found, margins


def cancelling(study: Study, known: Assumed, every: Sequence[Family]) -> Family:
    """Return the controller of [compensation] with its compensation, which is tuned and judged as any other."""
    given = asked(study, known.plant)
    chosen(given, {f.name: f for f in every})
    base = next(f for f in every if f.name == given.controller)
    return entered(base, given.on(known.plant), base.start)


def asked_for(found: Contest, margins: AgainstMargin) -> tuple[Asked, ...]:
    """Return what was hoped of the schedule over the relative displacement and is not had within the limit on Ms."""
    why = "at rest friction holds the load at h0/Kp, and Ms bounds Kp by the resonance of the joint: a fixed PD is bounded alike"
    ours = margins.values[JOINT]
    return tuple(
        Asked(f"joint_{n}", f"relative displacement: {said}", 3e-4, found[JOINT].median(n), ours[n], "rad", why)
        for n, said in (("error", "error"), ("error_loaded", "error, loaded"))
    )


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
