"""The command line: `workbench VERB`. Each verb is a module of `verbs/`.

Exit codes: 0 done; 1 done, but a requirement of the study is not met, or `check` found something; 2 something that the user
can mend, said in one sentence; 3 measured data is not on this machine; 70 an internal error, which is a failure of the
workbench; 130, 143 stopped by Ctrl-C or by SIGTERM.
"""

import argparse
import gc
import sys
from collections.abc import Sequence
from typing import NoReturn

from workbench import __version__
from workbench.errors import INTERNAL_ERROR, USER_ERROR, WorkbenchError, mishap
from workbench.interruption import STOPPED, Stopped, is_stop, leave, stoppable
from workbench.verbs import check, completion, diff, effects, new, plan, replay, response, run, trace, verify

COLLECTED = 50_000  # objects made before Python looks for rings of them: at its 700 that takes 1.0 s of a trace, here 0.3, with half of it 0.4, with twice 0.3
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


def _parser() -> argparse.ArgumentParser:
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
    top = _parser()
    given = top.parse_args(arguments)
    if given.verb is None:
        top.print_help()
        return USER_ERROR
    try:
        with stoppable():
            return VERBS[given.verb].do(given)
    except WorkbenchError as error:
        return _reported(str(error), USER_ERROR)
    except BrokenPipeError:
        return 0
    except Stopped as stopped:
        print(STOPPED, file=sys.stderr)
        return stopped.code
    except KeyboardInterrupt:
        print(STOPPED, file=sys.stderr)
        return 130
    except OSError as error:  # a disk that is full, a folder that may not be written, a file that has gone
        return _reported(
            f"{mishap(error)}; mend that and run it again. Outputs that were there are as they were.", USER_ERROR
        )
    except MemoryError:
        return _reported(
            "the memory of this machine does not suffice; give shorter records or fewer cases.", USER_ERROR
        )
    except Exception:
        import traceback

        traceback.print_exc()
        return _reported("this is an internal error, a failure of the workbench; please report it.", INTERNAL_ERROR)


def command() -> NoReturn:
    """Run the command that this process was started for, and end with its exit code, without taking Python down."""
    gc.set_threshold(COLLECTED)
    code = main()
    try:
        sys.stdout.flush()
    except OSError:  # nobody reads on, or its disk is full: Python's own end says so
        if not is_stop(code):
            sys.exit(code)
    leave(code)


def _reported(sentence: str, code: int) -> int:
    """Print why a command ends, and return its exit code."""
    print(f"workbench: {sentence}", file=sys.stderr)
    return code
