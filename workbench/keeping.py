"""Finished steps of a run, kept so that one that was stopped goes on from them.

A run is a fixed sequence of calls: with the same inputs, code and versions its n-th step is the same every time. So a step
is known by its number (of a step within another one, by both), and all steps by one digest of inputs and code; a folder
holds the steps of one digest. Only what this process asks for itself is counted: forks and threads compute.
"""

import functools
import os
import pickle
import shutil
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TypeVar

from workbench.processes import shared

Item, Made = TypeVar("Item"), TypeVar("Made")

FOLDER = ".steps"
LEAST_FREE = 1 << 30  # bytes: on a disk that has less nothing is kept, for the outputs need it more


class Keeper:
    """Steps of one digest in one folder. known: how many were there when the run began; told: called when one is taken."""

    def __init__(self, folder: Path, digest: str):
        self.folder, self.digest = folder, digest
        self.path, self.count = (), 0
        self.process = os.getpid(), threading.get_ident()
        with suppress(OSError):
            for other in folder.iterdir():
                if other.name != digest:
                    shutil.rmtree(other, ignore_errors=True)
        self.known = sum(1 for _ in (folder / digest).glob("*.step"))

    @property
    def mine(self) -> bool:
        return self.process == (os.getpid(), threading.get_ident())

    def step(self, name: str, make: Callable[[], Made]) -> Made:
        """Return what a step came to, from the folder where it is there."""
        number, above = self.count, self.path
        file = self._file(number, name)
        found, made = read(file)
        if not found:
            self.path, self.count = (*above, number), 0
            try:
                made = make()
            finally:
                self.path, self.count = above, number
            write(file, made)
        self.count = number + 1
        return made

    def steps(self, name: str, function: Callable[[Item], Made], items: Sequence[Item]) -> list[Made]:
        """Return what as many steps came to, function(item) each; those that are not there are shared among processes."""
        files = [self._file(self.count + k, name) for k in range(len(items))]
        known = [read(file) for file in files]
        missing = [k for k, (found, _) in enumerate(known) if not found]
        self.count += len(items)
        for k, made in zip(missing, shared(function, [items[k] for k in missing]), strict=True):
            write(files[k], made)
            known[k] = True, made
        return [made for _, made in known]

    def _file(self, number: int, name: str) -> Path:
        return self.folder / self.digest / f"{'.'.join(map(str, (*self.path, number)))}-{name}.step"

    def forget(self) -> None:
        """Remove the steps: the outputs are there."""
        shutil.rmtree(self.folder, ignore_errors=True)


_keeper: Keeper | None = None


@contextmanager
def keeping(folder: Path, digest: str) -> Iterator[Keeper]:
    """Keep the steps of what runs in the block in `folder`; they go when it ends well."""
    global _keeper
    before, _keeper = _keeper, Keeper(folder, digest)
    try:
        yield _keeper
        _keeper.forget()
    finally:
        _keeper = before


def kept(function: Callable[..., Made]) -> Callable[..., Made]:
    """Decorator: what a call comes to is a step of the run that goes on, if one keeps its steps."""

    @functools.wraps(function)
    def call(*given, **named):
        return step(function.__name__, lambda: function(*given, **named))

    return call


def step(name: str, make: Callable[[], Made]) -> Made:
    """Return make(), a step of the run that goes on, if one keeps its steps."""
    return _keeper.step(name, make) if _keeper is not None and _keeper.mine else make()


def steps(name: str, function: Callable[[Item], Made], items: Sequence[Item]) -> list[Made]:
    """Return function(item) of each item, made side by side; each is a step of the run that goes on, if one keeps its steps.

    What a call returns has to pickle, and it takes no steps of its own.
    """
    if _keeper is not None and _keeper.mine:
        return _keeper.steps(name, function, items)
    return list(shared(function, items))


def read(file: Path) -> tuple[bool, object]:
    """Return (True, what a step came to), or (False, None) where it is not there or not whole."""
    try:
        with file.open("rb") as f:
            return True, pickle.load(f)
    except Exception:  # whatever it is that a broken pickle raises: the step is taken again
        return False, None


def write(file: Path, made: object) -> None:
    """Write a step, whole or not at all; one that cannot be written is taken again in another run, and that is all."""
    import cloudpickle  # of closures too: an effect's step is one

    beside = ""
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        if shutil.disk_usage(file.parent).free < LEAST_FREE:
            return
        handle, beside = tempfile.mkstemp(dir=file.parent, prefix=".")
        with os.fdopen(handle, "wb") as f:
            cloudpickle.dump(made, f)
        os.replace(beside, file)
    except (OSError, pickle.PicklingError, TypeError, AttributeError, RecursionError):
        pass
    finally:
        with suppress(OSError):
            os.unlink(beside)
