"""A command that is stopped ends within a second, wherever it is, and leaves nothing behind."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BUSY = """
import argparse, atexit, signal, sys, time
from pathlib import Path
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell lets what it starts in the background ignore it
from workbench import cli, outputs
class Busy:
    def do(given):
        with outputs.whole(Path({out!r}), "done") as beside:
            (beside / "half").write_text("1")
            print("ready", flush=True)
            {work}
class Parser:
    def parse_args(self, _): return argparse.Namespace(verb="busy")
cli.VERBS["busy"], cli._parser = Busy, Parser
cli.command()
"""
IN_PYTHON = "while True: time.sleep(0.01)"
# What takes long to free, as thousands of compiled kernels do.
MUCH_TO_FREE = """class Slow:
                def __del__(self): time.sleep(5)
            cli.much = Slow()
            atexit.register(lambda: Path({kept!r}).write_text("1"))
            print("never flushed by itself")
            while True: time.sleep(0.01)"""
PASSING = """made = outputs.passing("test").__enter__(), outputs.passing_with_this_process("test")
            print(*made, flush=True)
            """
# A kernel lets other threads run and does not look up.
DEAF = """import numba
            @numba.njit(nogil=True)
            def spin(n):
                x = 0.0
                for k in range(n):
                    x += (x * x + k) % 3.0
                return x
            spin(10); print("set", flush=True); spin(10**11)"""


@dataclass
class Ended:
    """How a command ended. seconds: from the signal to its end; said: on stderr; lines: on stdout."""

    code: int
    seconds: float
    said: str
    lines: list[str]


def stopped(tmp_path, work: str, number: int, words: int = 1) -> Ended:
    """Return how a command ended that was stopped within `work`, once it had said so many lines."""
    command = BUSY.format(out=str(tmp_path / "out"), work=work)
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, "-c", command], cwd=ROOT, **pipes) as started:
        try:
            heard = [started.stdout.readline().rstrip() for _ in range(words)]
            time.sleep(0.1)
            began = time.monotonic()
            os.kill(started.pid, number)
            code, seconds = started.wait(timeout=20), time.monotonic() - began
            return Ended(code, seconds, started.stderr.read(), heard + started.stdout.read().splitlines())
        finally:
            started.kill()


@pytest.mark.parametrize(
    ("work", "words"), [(IN_PYTHON, 1), (DEAF, 2)], ids=["in Python", "in a compiled call that does not look up"]
)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_stop_ends_within_a_second_and_leaves_nothing(tmp_path, work, words, number):
    end = stopped(tmp_path, PASSING + work, number, words + 1)
    assert end.code == 128 + number and end.seconds < 1.0
    assert end.said == "workbench: stopped; outputs that were there are as they were.\n"
    assert list(tmp_path.iterdir()) == []
    temporary = end.lines[1].split()
    assert len(temporary) == 2 and not any(Path(folder).exists() for folder in temporary)


def test_a_stop_does_not_wait_for_memory_to_be_freed_but_for_what_is_registered_and_said(tmp_path):
    kept = tmp_path / "kept"
    end = stopped(tmp_path, MUCH_TO_FREE.format(kept=str(kept)), signal.SIGTERM)
    assert end.code == 143 and end.seconds < 1.0
    assert end.lines == ["ready", "never flushed by itself"] and kept.read_text() == "1"
