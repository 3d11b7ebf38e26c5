"""Stopping: a run is stopped at random moments until it comes to its end. How long each stop takes, and that nothing is done twice.

`python -m benchmarks.stopping STUDY COUNT SEED`; the tutorial's study, 30 times, where nothing is named. Its outputs are then
compared with those of a run that nobody stopped, byte by byte. It ends with 1 where a stop would take longer than LATEST on a
machine that does nothing else, a finished step was taken again, outputs differ, or something was left behind.
"""

import contextlib
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from benchmarks.same_bytes import differing, tutorial
from workbench.interruption import PATIENCE

ROOT = Path(__file__).resolve().parent.parent
LATEST = 1.0  # s from the stop to the end of the process
EARLY = {-signal.SIGINT, -signal.SIGTERM}  # exit codes of a stop before the command itself has begun
# s of a processor after a start: up to more than the longest step takes, or no run would come to its end
MOMENTS = (0.5, 25.0)
POLL = 0.2  # s between two looks at how much was used


def started(study: Path, out: Path) -> subprocess.Popen:
    command = [sys.executable, "-m", "benchmarks.stopping", "--run", str(study), str(out)]
    return subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    )


def said_run(study: str, out: str) -> None:
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
    sys.argv = ["workbench", "run", study, "--out", out]
    cli.command()


def used(group: int) -> float:
    """Return the seconds of a processor that the processes of a group have used, those that they waited for included."""
    ticks = 0
    for file in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):  # it has just ended
            words = file.read_text().rpartition(")")[2].split()
            ticks += sum(map(int, words[11:15])) if int(words[2]) == group else 0
    return ticks / os.sysconf("SC_CLK_TCK")


def ended() -> float:
    """Return the seconds of a processor of all processes that this one has waited for."""
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


@dataclass(frozen=True)
class Stop:
    """How a run ended. seconds, work: from the stop to the end, on the clock and of a processor; steps: kept on the way."""

    code: int
    seconds: float
    work: float
    steps: list[str]

    @property
    def quiet(self) -> float:
        """The most that it takes where nothing else runs: what it took here, or its work, or where it waits the patience with it."""
        return min(self.seconds, max(PATIENCE, self.work))


def stopped(study: Path, out: Path, after: float = float("inf"), number: int = signal.SIGINT) -> Stop:
    """Run a study, and stop it once it has used so many seconds of a processor, if it still runs."""
    before, run = ended(), started(study, out)
    began = spent = None
    while True:
        try:
            said, _ = run.communicate(timeout=POLL)
            break
        except subprocess.TimeoutExpired:
            if began is None and (so_far := used(run.pid)) > after:
                began, spent = time.monotonic(), so_far
                os.killpg(run.pid, number)
    steps = [x for x in said.splitlines() if x.startswith("taken")]
    if began is None:
        return Stop(run.returncode, 0.0, 0.0, steps)
    return Stop(run.returncode, time.monotonic() - began, max(ended() - before - spent, 0.0), steps)


def often(study: Path, out: Path, count: int, rng: random.Random) -> tuple[list[Stop], list[str]]:
    """Return (stops, steps that were taken again) of a run that is stopped so many times, and then comes to its end.

    One that comes to its end in between begins anew.
    """
    stops, taken, again = [], [], []
    while True:
        # what is finished is not done again, so that a stop soon after a start lies anywhere in the run
        after = rng.uniform(*MOMENTS) if len(stops) < count else float("inf")
        one = stopped(study, out, after, rng.choice((signal.SIGINT, signal.SIGTERM)))
        again += [s for s in one.steps if s in taken]
        taken += one.steps
        if one.code in (0, 1):
            if len(stops) >= count:
                return stops, again
            shutil.rmtree(out)
            taken = []
            continue
        stops.append(one)
        print(
            f"stop {len(stops)}: exit code {one.code}, {one.seconds:.2f} s on the clock, {one.work:.2f} s of a processor; "
            f"{len(taken)} steps are finished, {len(again)} were taken again",
            flush=True,
        )


def main(arguments: list[str] = ()) -> int:
    count, seed = (int(a) for a in (*arguments[1:3], *("30", "1")[len(arguments[1:3]) :]))
    with tempfile.TemporaryDirectory() as name:
        top = Path(name)
        study = top / "studies" / "stopped"
        if arguments and Path(arguments[0]).is_dir():
            shutil.copytree(arguments[0], study)
        else:
            tutorial(study)
        stops, again = often(study, top / "stopped", count, random.Random(seed))
        left = [str(p.relative_to(top)) for folder in (top, study) for p in folder.iterdir() if p.name.startswith(".")]
        stopped(study, top / "whole")
        other = differing(top / "whole", top / "stopped")
        longest, quiet = max(s.seconds for s in stops), sorted(s.quiet for s in stops)
        codes = {s.code for s in stops}
        print(f"Stopped {count} times: exit codes {sorted(codes)}; from stop to end {longest:.2f} s at most, where nothing else runs "
              f"{quiet[-1]:.2f} s, median {quiet[count // 2]:.2f} s.\nFinished steps that were taken again: {again or 'none'}. Left "
              f"behind: {left or 'nothing'}. Files that differ from those of a whole run: {other or 'none'}.")  # fmt: skip
        return 1 if quiet[-1] > LATEST or again or left or other or codes - EARLY - {130, 143} else 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["--run"]:
        said_run(*sys.argv[2:])
    sys.exit(main(sys.argv[1:]))
