"""`workbench plan`: which motion to record next."""

import argparse
from pathlib import Path

from workbench.verbs.progress import Progress

LACKS = 2.0  # what the records leave over what noise would, from which on promises come with a word


def declare(verbs) -> None:
    plan = verbs.add_parser(
        "plan",
        help="find the motion to record next",
        description="Find reference trajectories within the axis' limits that determine every declared parameter, or, "
        "with --separate, tell two effects apart; write trajectory.csv, trajectory.svg and plan.json.",
    )
    plan.add_argument("study", help="a study's folder, or its name under studies/")
    plan.add_argument("--out", type=Path, required=True, help="folder to write into")
    plan.add_argument("--accuracy", type=float, metavar="PER_CENT", help="of every parameter's value, 2 where absent")
    plan.add_argument(
        "--separate", nargs=2, metavar=("A", "B"), help="two effects to tell apart, by name or as name@place"
    )


def do(given: argparse.Namespace) -> int:
    from workbench.errors import WorkbenchError
    from workbench.outputs import replaceable
    from workbench.planning.output import JSON
    from workbench.study.planning import basis_of

    if given.accuracy is not None and not 0.0 < given.accuracy <= 100.0:
        raise WorkbenchError(f"--accuracy is {given.accuracy:g} %; give more than 0 and at most 100.")
    if given.separate and given.accuracy is not None:
        raise WorkbenchError(
            "--accuracy is of a plan that determines parameters; with --separate leave it out: the motion is then the one along "
            "which the two effects lie furthest apart."
        )
    replaceable(given.out, JSON)
    with Progress("plan", given.study) as say:
        basis = basis_of(given.study, say)
        return _separate(given, basis, say) if given.separate else _determine(given, basis, say)


def _determine(given: argparse.Namespace, basis, say) -> int:
    from workbench.outputs import whole
    from workbench.planning import design, prospects
    from workbench.planning.output import FIGURE, JSON, TRAJECTORY, write_plan
    from workbench.report.trajectory import figure

    accuracy = given.accuracy / 100.0 if given.accuracy else basis.accuracy
    plan = design(basis.fit.plant, basis.envelope, basis.sensing, accuracy, progress=say)
    found = prospects(plan, basis.fit.estimates, accuracy)
    reached = sum(p.reached for p in found)
    heading = f"{plan.trajectory.time[-1]:.0f} s of motion tell {reached} of {len(found)} parameters to {100 * accuracy:.3g} % or better"
    with whole(given.out, JSON) as beside:
        write_plan(beside, plan, found, accuracy, basis.sample_time)
        drawn = figure(heading, plan.trajectory.time, plan.position, plan.drive, basis.envelope, plan.plant.rotary)
        (beside / FIGURE).write_bytes(drawn)
    say.clear()
    start = plan.trajectory.position[0]
    print(
        f"Record {plan.trajectory.phrase}: {plan.trajectory.time[-1]:.0f} s, from rest at {start:.4g} {plan.plant.displacement}."
    )
    for p in found:
        print(f"- {p.sentence}")
    print(
        f"What the records leave of the drive, {basis.fit.rms['identification']:.2g} {plan.plant.effort} rms, is counted as "
        "noise. All promises hold at once in 95 of 100 such records."
    )
    if basis.excess > LACKS:
        print(
            f"The records leave {basis.excess:.1f} times what noise and encoder counts alone would: the model lacks something "
            "(workbench trace), and until that is declared a value may be further off than is promised."
        )
    print(f"\n{given.out / TRAJECTORY}")
    return 0


def _separate(given: argparse.Namespace, basis, say) -> int:
    from workbench.outputs import whole
    from workbench.planning.following import followed, with_effect
    from workbench.planning.output import FIGURE, JSON, TRAJECTORY, write_separation
    from workbench.report.trajectory import figure
    from workbench.tracing.separation import separation_of

    found, plant, a, sensing = separation_of(basis, *given.separate)
    inverse = followed(found.reference, with_effect(plant, a), sensing) if found.apart else None
    with whole(given.out, JSON) as beside:
        write_separation(beside, found, inverse, plant.rotary, basis.sample_time)
        if found.apart:
            m = inverse.motion
            drawn = figure(found.sentence, m.t, m.record.channels["position"], m.u, basis.envelope, plant.rotary)
            (beside / FIGURE).write_bytes(drawn)
    say.clear()
    print(found.sentence)
    print(f"\n{given.out / (TRAJECTORY if found.apart else JSON)}")
    return 0
