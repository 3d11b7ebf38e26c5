"""Blocks on an existing Dask cluster: the same function as on this machine, on workers that give the same bits.

A worker first answers with a probe, the digest over the bits of a few cases; one whose digest is another is refused by
name. Each block is given to one worker; what a lost worker had in hand goes back to the queue, and workers that come later
are probed as the first ones were. What travels is the document of the work (names and numbers) and drawn values.
"""

import json
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from workbench.errors import WorkbenchError
from workbench.robustness.document import of_work, work_of
from workbench.robustness.workload import Block, Columns, Work, probe

CONNECT = 10.0  # s, to reach the scheduler
PATIENCE = 30.0  # s without any worker, after which it is given up
LOOK = 0.5  # s between two looks at who is there, at most
POLL = 0.01  # s between two looks at what is done
GATHER = 5.0  # s for the columns of a block that is done; longer, and its worker is gone with them
AHEAD = 1  # blocks that wait at a worker beside those that run, so that none is idle
TRIES = 4  # of a block, when each time its worker is lost


@lru_cache(maxsize=2)
def _work(document: str) -> Work:
    return work_of(json.loads(document))


def _run_block(document: str, first: int, values: np.ndarray) -> Columns:
    """On a worker: the columns of a block. One thread: the worker's own threads share its cores."""
    return _work(document).columns(Block(first, values), threads=1)


def _run_probe(document: str, first: int, values: np.ndarray) -> str:
    """On a worker: the digest of the probe."""
    return probe(_work(document), Block(first, values))


@contextmanager
def connected(address: str):
    """Yield a client of the scheduler at an address; WorkbenchError where there is none."""
    try:
        from distributed import Client
    except ImportError as error:
        raise WorkbenchError(
            "--scheduler needs the package 'distributed': install the workbench with its extra [distributed]."
        ) from error
    try:
        client = Client(address, timeout=CONNECT, set_as_default=False, name="workbench")
    except (OSError, ValueError, TimeoutError) as error:
        raise WorkbenchError(
            f"there is no Dask scheduler at '{address}' ({error}); start one with `dask scheduler`, or leave --scheduler out."
        ) from error
    with client:
        yield client


@dataclass(eq=False)
class Crew:
    """Workers whose probes gave the expected digest. refused: address -> sentence."""

    client: object
    document: str
    sample: Block
    expected: str
    there: dict[str, int] = field(default_factory=dict)  # address -> threads
    refused: dict[str, str] = field(default_factory=dict)

    def look(self) -> None:
        """Take in who is there now: those that are gone leave, those that are new are probed."""
        workers = self.client.scheduler_info(n_workers=-1)["workers"]
        self.there = {a: n for a, n in self.there.items() if a in workers}
        new = [a for a in workers if a not in self.there and a not in self.refused]
        if not new:
            return
        answers = self.client.run(
            _run_probe, self.document, self.sample.first, self.sample.values, workers=new, on_error="return"
        )
        for address, answer in answers.items():
            if answer == self.expected:
                self.there[address] = workers[address]["nthreads"]
            elif not isinstance(answer, OSError):  # lost while it was asked: not to blame, and gone at the next look
                self.refuse(address, workers[address]["name"], answer)

    def refuse(self, address: str, name: str, answer: object) -> None:
        """Refuse a worker by name, and say why."""
        fault = (
            f"its probe's digest is {answer[:12]}, not {self.expected[:12]}: it would give other numbers. Let it have the same "
            "workbench and libraries"
            if isinstance(answer, str)
            else f"its probe failed ({type(answer).__name__}: {answer}). Install the same workbench there"
        )
        self.refused[address] = f"worker '{name}' at {address} is refused: {fault}."
        print(f"workbench: {self.refused[address]}", file=sys.stderr, flush=True)


def on_cluster(
    address: str, given: Work, parts: list[Block], say: Callable[[str], None] = lambda _: None
) -> Iterator[Columns]:
    """Yield the columns of each block in order, run by the cluster whose scheduler is at `address`.

    Raises WorkbenchError where there is no scheduler, no worker left for half a minute, or none that gives the same bits;
    and what a block itself raised.
    """
    document = json.dumps(of_work(given), allow_nan=False)
    with connected(address) as client:
        crew = Crew(client, document, parts[0], probe(given, parts[0]))
        finished: dict[int, Columns] = {}
        following = 0
        for number, columns in _finished(crew, parts):
            finished[number] = columns
            say(f"{len(finished) + following} of {len(parts)} blocks, {len(crew.there)} workers")
            while following in finished:
                yield finished.pop(following)
                following += 1


def _finished(crew: Crew, parts: list[Block]) -> Iterator[tuple[int, Columns]]:
    """Yield (number, columns) of each block, as they become ready."""
    queue = deque((number, TRIES) for number in range(len(parts)))
    running: dict = {}  # future -> (number, tries left, worker)
    while queue or running:
        _attend(crew)
        for future in [f for f, (_, _, worker) in running.items() if worker not in crew.there]:
            number, left, _ = running.pop(future)
            future.cancel()
            queue.appendleft(_again(number, left))
        _hand_out(crew, parts, queue, running)
        ready = _ready(running)
        for future in ready:
            number, left, _ = running.pop(future)
            columns = _result(future)
            if columns is None:
                queue.appendleft(_again(number, left))
            else:
                yield number, columns


def _attend(crew: Crew) -> None:
    """Look who is there; wait for a worker where there is none, and raise WorkbenchError where none comes."""
    end = time.monotonic() + PATIENCE
    crew.look()
    while not crew.there:
        if crew.refused:
            raise WorkbenchError(" ".join(("no worker of the cluster can be used:", *crew.refused.values())))
        if time.monotonic() > end:
            raise WorkbenchError(f"the cluster has had no worker for {PATIENCE:g} s; start one with `dask worker`.")
        time.sleep(LOOK)
        crew.look()


def _ready(running: dict) -> list:
    """Return the futures that are done, at the latest after LOOK seconds: it is time to look who is there."""
    end = time.monotonic() + LOOK
    while not (done := [f for f in running if f.done()]) and time.monotonic() < end:
        time.sleep(POLL)
    return done


def _hand_out(crew: Crew, parts: list[Block], queue: deque, running: dict) -> None:
    """Give blocks of the queue to workers that have less in hand than they run and one ahead."""
    for address, threads in crew.there.items():
        in_hand = sum(worker == address for _, _, worker in running.values())
        for _ in range(min(threads + AHEAD - in_hand, len(queue))):
            number, left = queue.popleft()
            block = parts[number]
            future = crew.client.submit(
                _run_block,
                crew.document,
                block.first,
                block.values,
                workers=[address],
                allow_other_workers=False,
                pure=False,
            )
            running[future] = number, left, address


def _result(future) -> Columns | None:
    """Return what a future holds, or None where its worker was lost; what the block itself raised is raised."""
    from concurrent.futures import CancelledError

    from distributed import KilledWorker

    try:
        return future.result(timeout=GATHER)
    except (CancelledError, KilledWorker, OSError, TimeoutError):
        return None


def _again(number: int, left: int) -> tuple[int, int]:
    """Return a block as the queue takes it back; WorkbenchError where it has been lost too often."""
    if left <= 1:
        raise WorkbenchError(
            f"block {number} was lost with its worker {TRIES} times; look into the workers' logs (is their memory enough?)."
        )
    return number, left - 1
