"""Work that is shared among forks of this process: each holds what this one holds at that moment, and copies nothing.

Only what a call returns goes through a pipe, so it must pickle; what it is called with need not. Forks are safe on Linux;
elsewhere, and in a fork, all is done by this process. No result depends on which process made it.
"""

import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from multiprocessing import current_process, get_context
from traceback import format_exc
from typing import TypeVar

from workbench.errors import WorkbenchError

Item, Made = TypeVar("Item"), TypeVar("Made")

VARIABLE = "WORKBENCH_PROCESSES"
MOST = 4  # each holds a few hundred megabytes of its own


def count() -> int:
    """Return how many processes work at a time: $WORKBENCH_PROCESSES, else one a core, MOST at most.

    Raises WorkbenchError where the variable holds no such number.
    """
    if sys.platform != "linux" or current_process().daemon:
        return 1
    given = os.environ.get(VARIABLE)
    if given is None:
        return min(MOST, len(os.sched_getaffinity(0)))
    if not given.isdecimal() or int(given) < 1:
        raise WorkbenchError(
            f"The variable {VARIABLE} holds '{given}'; how many processes may work at a time, 1 or more, is needed."
        )
    return int(given)


def shared(function: Callable[[Item], Made], items: Sequence[Item]) -> Iterator[Made]:
    """Yield function(item) of each item, in order. What a call raises is raised here, in its turn.

    A process that ends before its time (killed, out of memory) leaves its part to this one.
    """
    workers = min(count(), len(items))
    if workers < 2:
        yield from map(function, items)
        return
    context = get_context("fork")
    forks, pipes = [], []
    try:
        with _undisturbed():
            for k in range(workers):
                pipe, end = context.Pipe(duplex=False)
                fork = context.Process(target=_work, args=(function, items[k::workers], end), daemon=True)
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore", DeprecationWarning)  # of threads: BLAS and our pool know of forks
                    fork.start()
                end.close()
                forks.append(fork)
                pipes.append(pipe)
        for i, item in enumerate(items):
            yield _received(pipes[i % workers], function, item)
    finally:
        for fork, pipe in zip(forks, pipes, strict=True):
            pipe.close()
            fork.terminate()
            fork.join()


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Let an interrupt wait until all forks are known: one that nobody knows of would not be ended."""
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or before is None:
        yield
        return
    came: list[int] = []
    signal.signal(signal.SIGINT, lambda number, _: came.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if came:
        signal.raise_signal(signal.SIGINT)


def _work(function: Callable, items: Sequence, end) -> None:
    """What a fork does: send (True, result) of each item, or (False, what was raised) and no more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever interrupts means the process that waits, which ends this one
    try:
        for item in items:
            end.send((True, function(item)))
    except BrokenPipeError:
        pass
    except Exception as raised:
        raised.add_note(format_exc())
        end.send((False, raised))


def _received(pipe, function: Callable, item):
    try:
        sound, made = pipe.recv()
    except EOFError:
        return function(item)
    if sound:
        return made
    raise made
