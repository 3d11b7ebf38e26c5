"""The command line: `workbench VERB`. A verb imports what it needs when it runs, so that `--help` is instant.

Exit codes: 0 done; 1 done, but a requirement of the study is not met; 2 something that the user can mend, said in one
sentence; 3 measured data is not on this machine; 70 an internal error, which is a failure of the workbench.
"""

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from workbench import __version__
from workbench.errors import INTERNAL_ERROR, USER_ERROR, WorkbenchError

NOT_MET = 1
NO_DATA = 3
QUIET = 2.0  # s, before progress is shown


class Progress:
    """Says on stderr what is being done, once it has taken longer than QUIET seconds, a line a second at most."""

    def __init__(self):
        self.start = time.monotonic()
        self.said = QUIET - 1.0

    def __call__(self, what: str) -> None:
        passed = time.monotonic() - self.start
        if passed > self.said + 1.0:
            self.said = passed
            print(f"{passed:5.1f} s  {what}", file=sys.stderr, flush=True)


def parser() -> argparse.ArgumentParser:
    top = argparse.ArgumentParser(
        prog="workbench",
        description="From measured records of a servo axis to what its model lacks, and to the gains its firmware runs.",
    )
    top.add_argument("--version", action="version", version=f"workbench {__version__}")
    verbs = top.add_subparsers(dest="verb", metavar="VERB")
    run = verbs.add_parser(
        "run", help="run a study and write its report", description="Run a study and write its report."
    )
    run.add_argument("study", help="a study's folder, or its name under studies/")
    run.add_argument("--out", type=Path, help="folder of the outputs (reports/<study> where absent)")
    run.add_argument(
        "--if-data", action="store_true", help="where measured data is not on this machine, say so and exit with 0"
    )
    run.set_defaults(do=do_run)
    trace = verbs.add_parser(
        "trace",
        help="find what a campaign's declared model lacks",
        description="Find what the declared model of a campaign lacks, and write trace.json and predictions.",
    )
    trace.add_argument("folder", type=Path, help="the campaign: a folder with campaign.toml and its records")
    trace.add_argument("--out", type=Path, required=True, help="folder to write into")
    trace.add_argument("--resample", action="store_true", help="interpolate records whose time steps are uneven")
    trace.set_defaults(do=do_trace)
    effects = verbs.add_parser(
        "effects",
        help="list the known effects",
        description="List the known effects: names, formulas, units, causes.",
    )
    effects.add_argument("name", nargs="?", help="one effect only")
    effects.add_argument("--markdown", action="store_true", help="the whole catalogue as a page (docs/catalogue.md)")
    effects.set_defaults(do=do_effects)
    return top


def do_run(given: argparse.Namespace) -> int:
    from workbench.study.configuration import MissingData
    from workbench.study.running import run

    try:
        ran = run(given.study, given.out, Progress())
    except MissingData as missing:
        print(f"workbench: {missing}", file=sys.stderr)
        return 0 if given.if_data else NO_DATA
    if not ran.fresh:
        print("Nothing has changed since these outputs were written.\n")
    print("\n".join(ran.lines))
    return 0 if ran.passed else NOT_MET


def do_trace(given: argparse.Namespace) -> int:
    from workbench.campaign import load
    from workbench.outputs import whole
    from workbench.study.standard import trace_campaign
    from workbench.trace.output import write

    campaign = load(given.folder, resample=given.resample)
    found = trace_campaign(campaign, Progress())
    with whole(given.out, "trace.json") as beside:
        write(found, beside)
    print(found.sentence)
    for finding in (*campaign.findings, *found.findings):
        print(f"- {finding.sentence}")
    print(f"\n{given.out / 'trace.json'}")
    return 0


def do_effects(given: argparse.Namespace) -> int:
    from workbench.effect import catalogue, find

    if given.markdown:
        from workbench.catalogue_page import page

        print(page(), end="")
        return 0
    chosen = [find(given.name)] if given.name else list(catalogue().values())
    for e in chosen:
        print(f"{e.name}\n    {e.formula}\n    cause: {e.cause}")
        for name, p in e.outside.items():
            unit = p.unit.replace("F", "[N*m or N]").replace("x", "[rad or m]")
            print(f"    {name}: {p.meaning}, {'no unit' if p.unit == '1' else unit}")
        print(f"    acts at: {', '.join(e.places)}   source: {e.source}\n")
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code."""
    top = parser()
    given = top.parse_args(arguments)
    if given.verb is None:
        top.print_help()
        return USER_ERROR
    try:
        return given.do(given)
    except WorkbenchError as error:
        print(f"workbench: {error}", file=sys.stderr)
        return USER_ERROR
    except BrokenPipeError:
        return 0
    except KeyboardInterrupt:
        print("workbench: stopped; outputs that were there are as they were.", file=sys.stderr)
        return 130
    except Exception:
        import traceback

        traceback.print_exc()
        print("workbench: this is an internal error, a failure of the workbench; please report it.", file=sys.stderr)
        return INTERNAL_ERROR
