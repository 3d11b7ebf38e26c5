"""Work that is shared among forks of this process: each holds what this one holds at that moment, and copies nothing.

Only what a call returns goes through a pipe, so it must pickle; what it is called with need not. Forks are safe on Linux;
elsewhere, and in a fork, all is done by this process. No result depends on which process made it.
"""

import gc
import os
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from multiprocessing import current_process, get_context, parent_process
from multiprocessing.connection import wait
from traceback import format_exc
from typing import TypeVar

from workbench.errors import WorkbenchError
from workbench.interruption import SIGNALS

Item, Made = TypeVar("Item"), TypeVar("Made")

VARIABLE = "WORKBENCH_PROCESSES"
MOST = 4  # each holds a few hundred megabytes of its own
WATCHED = 0.5  # s: how often a fork looks whether its parent is there; twice as often is as cheap
BYTES, QUEUED = 4, 1024  # of an item's number; and numbers that any pipe holds at once


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


def shared(
    function: Callable[[Item], Made], items: Sequence[Item], meanwhile: Callable[[], None] = lambda: None
) -> Iterator[Made]:
    """Yield function(item) of each item, in order. What a call raises is raised here, in its turn.

    Whoever is free takes the next item. What a process that ends before its time (killed, out of memory) had taken is done
    by this one. meanwhile: what this one gets ready for later, where it would only wait for others.
    """
    workers = min(count(), len(items))
    if workers < 2:
        yield from map(function, items)
        return
    with _forks(function, items, workers) as pipes:
        meanwhile()
        made, heard = {}, list(pipes)
        for i, item in enumerate(items):
            yield _made(i, made) if _came(i, made, heard) else function(item)


@contextmanager
def begun(function: Callable[[], Made]) -> Iterator[Callable[[], Made]]:
    """Begin function() in a fork while this process does something else, and give what waits for its result; what it raises is raised there.

    Where one process works, or the fork ends before its time, it is called when the result is asked for. A result that
    nobody asked for when the block ends is not waited for.
    """
    if count() < 2:
        yield function
        return
    with _forks(lambda f: f(), [function], 1) as pipes:
        made, heard = {}, list(pipes)
        yield lambda: _made(0, made) if _came(0, made, heard) else function()


@contextmanager
def _forks(function: Callable, items: Sequence, workers: int) -> Iterator[list]:
    """Give the pipes from which answers come of `workers` forks that share the items, and end these with the block."""
    context = get_context("fork")
    forks, pipes = [], []
    queue = _queue(len(items))
    try:
        with _undisturbed(), _unheard():
            for _ in range(workers):
                pipe, end = context.Pipe(duplex=False)
                fork = context.Process(target=_work, args=(function, items, queue, end), daemon=True)
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore", DeprecationWarning)  # of threads: BLAS and our pool know of forks
                    fork.start()
                end.close()
                forks.append(fork)
                pipes.append(pipe)
        yield pipes
    finally:
        os.close(queue)
        for fork in forks:
            fork.terminate()
        for fork, pipe in zip(
            forks, pipes, strict=True
        ):  # when all of them are ending: each gives back memory of its own
            pipe.close()
            fork.join()


def _came(i: int, made: dict[int, list], heard: list) -> bool:
    """Wait for the answer of an item; return whether there is one: a fork that is killed gives none."""
    while i not in made and heard:
        for pipe in wait(heard):
            _receive(pipe, made, heard)
    return i in made


def _made(i: int, made: dict[int, list]) -> Made:
    """Return the result of an item whose answer came, or raise what its call raised."""
    sound, result = made.pop(i)
    if not sound:
        raise result
    return result


def _queue(items: int) -> int:
    """Return what the numbers of items are read from, one after another, by whoever reads: the end of a pipe.

    A process that is killed takes nothing with it but the number that it has read. Of more items than a pipe holds numbers
    for, a number stands for every QUEUED-th item from it on.
    """
    read, write = os.pipe()
    os.write(write, b"".join(k.to_bytes(BYTES, "big") for k in range(min(items, QUEUED))))
    os.close(write)
    return read


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Let an interrupt wait until all forks are known: one that nobody knows of would not be ended."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    numbers = (signal.SIGINT, signal.SIGTERM)
    before = {n: h for n in numbers if callable(h := signal.getsignal(n))}  # else it ends this process and its forks
    came: list[int] = []
    for number in before:
        signal.signal(number, lambda number, _: came.append(number))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    if came:
        signal.raise_signal(came[0])


@contextmanager
def _unheard() -> Iterator[None]:
    """Let signals to end wait, here and in a fork until it has its own ways with them (`_work`).

    A fork that is ended before that would still write what it hears where this process is told to stop.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _work(function: Callable, items: Sequence, queue: int, end) -> None:
    """What a fork does: send (k, True, result) of each item that it takes, or (k, False, what was raised) and no more."""
    gc.freeze()  # what the parent made stays: to look through it would copy its pages
    threading.Thread(target=_end_with, args=(parent_process().pid,), daemon=True).start()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)  # at once, whatever it is in
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever interrupts means the process that waits, which ends this one
    signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
    k = -1
    try:
        while number := os.read(queue, BYTES):
            for k in range(int.from_bytes(number, "big"), len(items), QUEUED):
                end.send((k, True, function(items[k])))
    except BrokenPipeError:
        pass
    except Exception as raised:
        raised.add_note(format_exc())
        end.send((k, False, raised))


def _end_with(parent: int) -> None:
    """End this fork once the process that made it is gone: killed, it could not end its forks, which may be in a long search."""
    while os.getppid() == parent:
        time.sleep(WATCHED)
    os._exit(1)


def _receive(pipe, made: dict[int, list], heard: list) -> None:
    """Put what a fork has sent into `made`; one that says no more is heard no more."""
    try:
        k, *answer = pipe.recv()
    except (EOFError, OSError):  # it has ended, perhaps within a word
        heard.remove(pipe)
    else:
        made[k] = answer
