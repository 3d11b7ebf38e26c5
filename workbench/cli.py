"""The command line: `workbench VERB`. Each verb is a module of `verbs/`.

Exit codes: 0 done; 1 done, but a requirement of the study is not met; 2 something that the user can mend, said in one
sentence; 3 measured data is not on this machine; 70 an internal error, which is a failure of the workbench.
"""

import argparse
import sys
from collections.abc import Sequence

from workbench import __version__
from workbench.errors import INTERNAL_ERROR, USER_ERROR, WorkbenchError
from workbench.verbs import check, completion, diff, effects, new, plan, replay, response, run, trace, verify

VERBS = {
    "new": new,
    "check": check,
    "run": run,
    "trace": trace,
    "plan": plan,
    "response": response,
    "diff": diff,
    "replay": replay,
    "verify": verify,
    "effects": effects,
    "completion": completion,
}


def parser() -> argparse.ArgumentParser:
    top = argparse.ArgumentParser(
        prog="workbench",
        description="From measured records of a servo axis to what its model lacks, and to the gains its firmware runs.",
    )
    top.add_argument("--version", action="version", version=f"workbench {__version__}")
    verbs = top.add_subparsers(dest="verb", metavar="VERB")
    for module in VERBS.values():
        module.declare(verbs)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code."""
    top = parser()
    given = top.parse_args(arguments)
    if given.verb is None:
        top.print_help()
        return USER_ERROR
    try:
        return VERBS[given.verb].do(given)
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
