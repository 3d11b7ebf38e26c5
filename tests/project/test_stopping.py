"""A command that is stopped ends within a second, wherever it is, and leaves nothing behind."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BUSY = """
import argparse, signal, sys, time
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
sys.exit(cli.main([]))
"""
IN_PYTHON = "while True: time.sleep(0.01)"
# A kernel lets other threads run and does not look up.
DEAF = """import numba
            @numba.njit(nogil=True)
            def spin(n):
                x = 0.0
                for k in range(n):
                    x += (x * x + k) % 3.0
                return x
            spin(10); print("set", flush=True); spin(10**11)"""


def stopped(tmp_path, work: str, number: int, words: int = 1):
    """Return (exit code, s from the signal to the end, what was said) of a command that is stopped within `work`."""
    code = BUSY.format(out=str(tmp_path / "out"), work=work)
    started = subprocess.Popen(
        [sys.executable, "-c", code], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        for _ in range(words):
            started.stdout.readline()
        time.sleep(0.1)
        began = time.monotonic()
        os.kill(started.pid, number)
        _, said = started.communicate(timeout=20)
        return started.returncode, time.monotonic() - began, said
    finally:
        started.kill()


@pytest.mark.parametrize(
    ("work", "words"), [(IN_PYTHON, 1), (DEAF, 2)], ids=["in Python", "in a compiled call that does not look up"]
)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_stop_ends_within_a_second_and_leaves_nothing(tmp_path, work, words, number):
    code, seconds, said = stopped(tmp_path, work, number, words)
    assert code == 128 + number and seconds < 1.0
    assert said == "workbench: stopped; outputs that were there are as they were.\n"
    assert list(tmp_path.iterdir()) == []
