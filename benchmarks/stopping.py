"""Stopping: a run is stopped at random moments until it comes to its end. How long each stop takes, and that nothing is done twice.

`python -m benchmarks.stopping STUDY COUNT SEED`; the tutorial's study, 30 times, where nothing is named. Its outputs are then
compared with those of a run that nobody stopped, byte by byte.
"""

import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.same_bytes import differing, tutorial

ROOT = Path(__file__).resolve().parent.parent
AGAIN = "going on from"


def started(study: Path, out: Path) -> subprocess.Popen:
    command = [sys.executable, "-m", "benchmarks.stopping", "--run", str(study), str(out)]
    return subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    )


def said_run(study: str, out: str) -> int:
    """Run a study as the command does, and say every step as it is taken."""
    from workbench import cli, keeping
    from workbench.verbs import progress

    step = keeping.Keeper.step

    def loudly(self, name, make):
        def told():
            made = make()
            print(f"taken {self.path} {name}", flush=True)
            return made

        return step(self, name, told)

    keeping.Keeper.step = loudly
    progress.QUIET = 1e9
    return cli.main(["run", study, "--out", out])


def stopped(study: Path, out: Path, after: float) -> tuple[int, float, list[str]]:
    """Return (exit code, s from the stop to the end, steps taken) of a run that is stopped after so many seconds, if it still runs."""
    run = started(study, out)
    try:
        said, _ = run.communicate(timeout=after)
        return run.returncode, 0.0, [x for x in said.splitlines() if x.startswith("taken")]
    except subprocess.TimeoutExpired:
        began = time.monotonic()
        os.killpg(run.pid, random.choice((signal.SIGINT, signal.SIGTERM)))
        said, _ = run.communicate()
        return run.returncode, time.monotonic() - began, [x for x in said.splitlines() if x.startswith("taken")]


def main(arguments: list[str] = ()) -> None:
    count, seed = (int(a) for a in (*arguments[1:3], *("30", "1")[len(arguments[1:3]) :]))
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as top:
        study = Path(top) / "studies" / "stopped"
        if arguments:
            shutil.copytree(arguments[0], study)
        else:
            tutorial(study)
        began = time.monotonic()
        code, _, steps = stopped(study, Path(top) / "whole", 1e5)
        whole = time.monotonic() - began
        print(f"A run that nobody stops: exit code {code}, {whole:.0f} s, {len(steps)} steps.", flush=True)
        taken, ends, codes = [], [], []
        for k in range(count):
            # ever later: what is finished is not done again, so that the moments lie all over the run
            code, seconds, again = stopped(study, Path(top) / "stopped", rng.uniform(0.5, 0.3 * whole))
            taken += again
            codes.append(code)
            if code in (0, 1):
                print(f"It came to its end at the start number {k + 1}.", flush=True)
                shutil.rmtree(Path(top) / "stopped")
                taken, steps = [], steps
                continue
            ends.append(seconds)
        code, _, again = stopped(study, Path(top) / "stopped", 1e5)
        left = [p.name for p in Path(top).iterdir() if p.name.startswith(".")]
        print(f"Stopped {len(ends)} times: exit codes {sorted(set(codes))}; from stop to end {max(ends):.2f} s at most, median "
              f"{sorted(ends)[len(ends) // 2]:.2f} s; left behind: {left or 'nothing'}.")  # fmt: skip
        print(
            f"Files that differ from those of the whole run: {differing(Path(top) / 'whole', Path(top) / 'stopped') or 'none'}."
        )


if __name__ == "__main__":
    if sys.argv[1:2] == ["--run"]:
        sys.exit(said_run(*sys.argv[2:]))
    main(sys.argv[1:])
