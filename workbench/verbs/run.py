"""`workbench run`: run a study and write its report."""

import argparse
import sys
from pathlib import Path

from workbench.verbs import NO_DATA, NOT_MET
from workbench.verbs.progress import Progress


def declare(verbs) -> None:
    run = verbs.add_parser(
        "run", help="run a study and write its report", description="Run a study and write its report."
    )
    run.add_argument("study", help="a study's folder, or its name under studies/")
    run.add_argument("--out", type=Path, help="folder of the outputs (reports/<study> where absent)")
    run.add_argument(
        "--scheduler", default="", metavar="ADDRESS", help="address of a Dask scheduler whose workers run the draws"
    )
    run.add_argument(
        "--if-data", action="store_true", help="where measured data is not on this machine, say so and exit with 0"
    )


def do(given: argparse.Namespace) -> int:
    from workbench.study.configuration import MissingData
    from workbench.study.running import run

    try:
        with Progress("run", given.study) as say:
            ran = run(given.study, given.out, say, given.scheduler)
    except MissingData as missing:
        print(f"workbench: {missing}", file=sys.stderr)
        return 0 if given.if_data else NO_DATA
    if not ran.fresh:
        print("Nothing has changed since these outputs were written.\n")
    print("\n".join(ran.lines))
    return 0 if ran.passed else NOT_MET
