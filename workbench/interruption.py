"""Stopping: Ctrl-C, SIGTERM and a closed terminal end a command within a second, wherever it is."""

import atexit
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import NoReturn

from workbench import outputs

STOPPED = "workbench: stopped; outputs that were there are as they were."
SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
PATIENCE = 0.6  # s that Python has to end by itself: a compiled call does not look up before it returns


class Stopped(KeyboardInterrupt):
    """Somebody wants this to end. number: of the signal."""

    def __init__(self, number: int):
        super().__init__()
        self.number = number

    @property
    def code(self) -> int:
        """The exit code, as a shell has it for a command that a signal ended."""
        return 128 + self.number


def _stop(number: int, _) -> None:
    raise Stopped(number)


def is_stop(code: int) -> bool:
    """Whether an exit code is that of a command that a signal ended."""
    return code - 128 in SIGNALS


def leave(code: int) -> NoReturn:
    """End this process, what is registered for its end done and what was said written, without taking Python down.

    Python would free every compiled kernel and model one by one, for up to a second, and then give back the memory of all.
    """
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)  # it is ending
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(Exception):  # nobody listens any more
            stream.flush()
    os._exit(code)


@contextmanager
def stoppable() -> Iterator[None]:
    """Raise Stopped at a signal to end; where this process does not come to it in PATIENCE seconds, end it all the same.

    Outside of the main thread, which alone hears signals, nothing is changed.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    heard, told = os.pipe()
    os.set_blocking(told, False)
    before = {number: signal.getsignal(number) for number in SIGNALS}
    for number in SIGNALS:
        if before[number] is not signal.SIG_IGN:  # as nohup asks
            signal.signal(number, _stop)
    earlier = signal.set_wakeup_fd(told, warn_on_full_buffer=False)
    guard = threading.Thread(target=_guard, args=(heard,), daemon=True)
    guard.start()
    try:
        yield
    finally:
        signal.set_wakeup_fd(earlier)
        for number, handler in before.items():
            signal.signal(number, handler)
        os.close(told)  # the guard reads the end, and goes
        guard.join(0.1)


def _guard(heard: int) -> None:
    """Wait for a signal, and then for this process to end; else end it."""
    number = next((n for n in iter(lambda: os.read(heard, 1), b"") if n[0] in SIGNALS), b"")
    if number:
        time.sleep(PATIENCE)
        with suppress(OSError):
            os.set_blocking(heard, False)
        if not _ended(heard):
            outputs.abandon()
            with suppress(Exception):
                print(STOPPED, file=sys.stderr, flush=True)
            os._exit(128 + number[0])
    os.close(heard)


def _ended(heard: int) -> bool:
    """Whether the other end of the pipe is closed."""
    try:
        while os.read(heard, 64):
            pass
    except BlockingIOError:
        return False
    return True


def _forget_in_forks() -> None:
    """A fork's signals are its own: they wake nobody here."""
    signal.set_wakeup_fd(-1)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_in_forks)
