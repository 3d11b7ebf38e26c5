"""Stopping: a run is stopped at random moments until it comes to its end. How long each stop takes, and that nothing is done twice.

`python -m benchmarks.stopping STUDY COUNT SEED`; the tutorial's study, 30 times, where nothing is named. Its outputs are then
compared with those of a run that nobody stopped, byte by byte. It ends with 1 where a stop took longer than LATEST, a
finished step was taken again, outputs differ, or something was left behind.
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
LATEST = 1.0  # s from the stop to the end of the process
EARLY = {-signal.SIGINT, -signal.SIGTERM}  # exit codes of a stop before the command itself has begun
SHARE = 0.15  # of a whole run: no later than that after its start is a run stopped; so 30 stops lie all over it


def started(study: Path, out: Path) -> subprocess.Popen:
    command = [sys.executable, "-m", "benchmarks.stopping", "--run", str(study), str(out)]
    return subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    )


def said_run(study: str, out: str) -> int:
    """Run a study as the command does, and say every step once it is kept."""
    from workbench import cli, keeping
    from workbench.verbs import progress

    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell lets what it starts in the background ignore it
    write = keeping.write

    def loudly(file, made):
        write(file, made)
        if file.exists():
            print(f"taken {file.name}", flush=True)

    keeping.write = loudly
    progress.QUIET = 1e9
    return cli.main(["run", study, "--out", out])


def stopped(study: Path, out: Path, after: float, number: int = signal.SIGINT) -> tuple[int, float, list[str]]:
    """Return (exit code, s from the stop to the end, steps kept) of a run that is stopped after so many seconds, if it still runs."""
    run, seconds = started(study, out), 0.0
    try:
        said, _ = run.communicate(timeout=after)
    except subprocess.TimeoutExpired:
        began = time.monotonic()
        os.killpg(run.pid, number)
        said, _ = run.communicate()
        seconds = time.monotonic() - began
    return run.returncode, seconds, [x for x in said.splitlines() if x.startswith("taken")]


def often(
    study: Path, out: Path, whole: float, count: int, rng: random.Random
) -> tuple[list[float], list[int], list[str]]:
    """Return (s from each stop to its end, exit codes, steps that were taken again) of a run that is stopped so many times.

    One that comes to its end in between begins anew.
    """
    ends, codes, taken, again = [], set(), [], []
    while len(ends) < count:
        # what is finished is not done again, so that a stop soon after a start lies anywhere in the run
        code, seconds, steps = stopped(
            study, out, rng.uniform(0.5, SHARE * whole), rng.choice((signal.SIGINT, signal.SIGTERM))
        )
        again += [s for s in steps if s in taken]
        taken += steps
        if code in (0, 1):
            shutil.rmtree(out)
            taken = []
        else:
            codes.add(code)
            ends.append(seconds)
            print(f"stop {len(ends)}: {seconds:.2f} s, {len(taken)} steps are finished", flush=True)
    code, _, steps = stopped(study, out, 1e5)
    return ends, sorted(codes), again + [s for s in steps if s in taken]


def main(arguments: list[str] = ()) -> int:
    count, seed = (int(a) for a in (*arguments[1:3], *("30", "1")[len(arguments[1:3]) :]))
    with tempfile.TemporaryDirectory() as name:
        top = Path(name)
        study = top / "studies" / "stopped"
        if arguments:
            shutil.copytree(arguments[0], study)
        else:
            tutorial(study)
        began = time.monotonic()
        code, _, steps = stopped(study, top / "whole", 1e5)
        whole = time.monotonic() - began
        print(f"A run that nobody stops: exit code {code}, {whole:.0f} s, {len(steps)} steps.", flush=True)
        ends, codes, again = often(study, top / "stopped", whole, count, random.Random(seed))
        left = [str(p.relative_to(top)) for folder in (top, study) for p in folder.iterdir() if p.name.startswith(".")]
        other = differing(top / "whole", top / "stopped")
        print(f"Stopped {len(ends)} times: exit codes {codes}; from stop to end {max(ends):.2f} s at most, median "
              f"{sorted(ends)[len(ends) // 2]:.2f} s.\nFinished steps that were taken again: {again or 'none'}. Left behind: "
              f"{left or 'nothing'}. Files that differ from those of the whole run: {other or 'none'}.")  # fmt: skip
        return 1 if max(ends) > LATEST or again or left or other or set(codes) - EARLY - {130, 143} else 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["--run"]:
        sys.exit(said_run(*sys.argv[2:]))
    sys.exit(main(sys.argv[1:]))
