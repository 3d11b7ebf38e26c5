"""`workbench replay`: run a study's worst cases again, and draw the motion of one."""

import argparse
from pathlib import Path

from workbench.verbs import NOT_MET
from workbench.verbs.progress import Progress


def declare(verbs) -> None:
    replay = verbs.add_parser(
        "replay",
        help="run a study's worst cases again",
        description="Run the worst cases of a study again, and say whether every bit is the same; draw one with --case.",
    )
    replay.add_argument("file", type=Path, help="robustness/worst.json of a study's outputs")
    replay.add_argument("--case", type=int, help="number of one case, from 1; all where absent")
    replay.add_argument("--out", type=Path, help="folder for the motion of the case: motion.csv and motion.svg")


def do(given: argparse.Namespace) -> int:
    from workbench.errors import WorkbenchError
    from workbench.outputs import replaceable
    from workbench.robustness import worst

    work, cases = worst.read(given.file)
    if given.out is not None and given.case is not None:
        replaceable(given.out, "motion.csv")
    if given.out is not None and given.case is None:
        raise WorkbenchError("--out needs --case N: the motion of one case is written.")
    if given.case is not None and not 1 <= given.case <= len(cases):
        raise WorkbenchError(f"{given.file} holds the cases 1 to {len(cases)}; there is no {given.case}.")
    same = True
    with Progress() as say:
        for number, case in enumerate(cases, 1):
            if given.case not in (None, number):
                continue
            say(f"case {number} of {len(cases)}")
            again = worst.replay(work, case)
            say.clear()
            same &= again.same
            words = "to the same bits" if again.same else f"DIFFERENT: it was {case.metrics['final_error']:.6g}"
            print(
                f"{number}  {case.controller}, draw {case.number}: final error {again.metrics['final_error']:.6g}, {words}"
            )
            if given.out is not None:
                _write(work, again, given.out)
                print(f"\n{given.out / 'motion.csv'}\n{given.out / 'motion.svg'}")
    return 0 if same else NOT_MET


def _write(work, again, out: Path) -> None:
    """Write the motion of a case as a table and a drawing."""
    import numpy as np

    from workbench.outputs import whole
    from workbench.report.robustness_figures import motion

    t = again.trajectories
    names = list(t.signals)
    data = np.column_stack([t.time, *(t[n][:, 0] for n in names)])
    lines = [",".join(("time", *names)), *(",".join(map(repr, row)) for row in data.tolist())]
    with whole(out, "motion.csv") as beside:
        (beside / "motion.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        heading = f"{again.case.controller} on draw {again.case.number}"
        (beside / "motion.svg").write_bytes(motion(work, {again.case.controller: again}, heading))
