"""Outputs appear whole or not at all: a folder is written beside its place and changes places with it.

A link is followed. Where the place cannot be renamed (a mount point, a folder in one that may not be written), the folder
is written inside it and entries are moved one by one; a run killed meanwhile is put right by the next one (`_sweep`).
"""

import atexit
import ctypes
import os
import shutil
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from workbench.errors import WorkbenchError, mishap

MARK = ".partial-"
LEAVING, OLD = "-leaving", "-old"  # an earlier output: while its entries are moved away, and when all of them are
HERE, EXCHANGE = -100, 2  # AT_FDCWD and RENAME_EXCHANGE of Linux
_writing: set[Path] = set()
LONGEST = 100  # characters of a name that are kept beside MARK, a process and what mkdtemp adds, of 255 bytes


def is_running(pid: str) -> bool:
    """Whether a process of this number runs on this machine; where that cannot be asked, it counts as running."""
    if os.name == "nt":  # there is no signal 0: to send it would end the process
        return True
    try:
        os.kill(int(pid), 0)
    except (ProcessLookupError, ValueError, OverflowError):
        return False
    except PermissionError:
        return True
    return True


def _prefix(place: Path) -> str:
    """Return what names of folders beside `place` begin with."""
    name = place.name if len(os.fsencode(place.name)) <= LONGEST else f"{zlib.crc32(os.fsencode(place.name)):08x}"
    return f".{name}{MARK}"


def _left_by_the_dead(place: Path) -> list[Path]:
    """Return what killed runs left beside and inside `place`, earlier outputs first."""
    found = []
    for folder, prefix in ((place.parent, _prefix(place)), (place, MARK)):
        with suppress(OSError):
            found += [p for p in folder.iterdir() if p.name.startswith(prefix)]
    dead = [p for p in found if not is_running(p.name.rsplit(MARK, 1)[1].split("-")[0])]
    return sorted(dead, key=lambda p: not p.name.endswith((LEAVING, OLD)))


def _sweep(place: Path, ours: str) -> None:
    """Remove what killed runs left of `place`, and put back an earlier output that one was killed while replacing."""
    for left in _left_by_the_dead(place):
        with suppress(OSError):
            if (left / ours).is_file() and left.name.endswith((LEAVING, OLD)) and not (place / ours).is_file():
                _restored(left, place, ours)
        shutil.rmtree(left, ignore_errors=True)


def replaceable(place: Path, ours: str) -> Path:
    """Return `place` as an absolute path, links followed; WorkbenchError where `whole` could not write or replace it.

    Whatever takes long asks this first, so that a mistyped folder is said before and not after.
    """
    given = place
    try:
        place = Path(os.path.realpath(place))
        with suppress(FileNotFoundError):
            os.lstat(place)  # a name too long
        if place.exists() and not place.is_dir():
            raise WorkbenchError(f"{given} is a file; name a folder to write into.")
        _sweep(place, ours)
        if place.is_dir() and _entries(place) and not (place / ours).is_file():
            raise WorkbenchError(
                f"{given} holds files that this command did not write (there is no {ours}); name an empty or a new folder."
            )
        os.rmdir(_beside(place, next(p for p in place.parents if p.exists())))
    except (OSError, ValueError) as error:
        raise WorkbenchError(f"{given} cannot be written: {mishap(error)}; name another folder.") from error
    return place


def _entries(place: Path) -> list[Path]:
    """What a folder holds, without folders that runs are writing into, and what a file system itself keeps there."""
    return [p for p in place.iterdir() if not p.name.startswith(MARK) and p.name != "lost+found"]


def _beside(place: Path, parent: Path) -> Path:
    """Return a new empty folder on the file system of `place`: in `parent`, or inside it where it cannot be renamed."""
    if not os.path.ismount(place):
        try:
            return Path(tempfile.mkdtemp(prefix=f"{_prefix(place)}{os.getpid()}-", dir=parent))
        except OSError:
            if not place.is_dir():
                raise
    return Path(tempfile.mkdtemp(prefix=f"{MARK}{os.getpid()}-", dir=place))


@contextmanager
def whole(place: Path, ours: str) -> Iterator[Path]:
    """Yield an empty folder; when the block ends well it becomes `place`, replacing an earlier output.

    ours: the file by which an earlier output is known. A folder that holds files but not this one is not ours to
    replace: WorkbenchError. When the block raises, or the disk is full, `place` stays as it was.
    """
    place, given, beside = replaceable(place, ours), place, None
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        beside = _beside(place, place.parent)
        _writing.add(beside)
        yield beside
        beside.chmod(0o755)
        (_moved_in if beside.parent == place else _renamed)(beside, place, ours)
    except OSError as error:
        raise WorkbenchError(
            f"{given} cannot be written: {mishap(error)}; mend that or name another folder. What was there is as it was."
        ) from error
    finally:
        if beside is not None:
            _remove(beside)


@contextmanager
def passing(purpose: str) -> Iterator[Path]:
    """Yield an empty folder for temporary files, which goes with the block. purpose: a word of its name."""
    folder = Path(tempfile.mkdtemp(prefix=f"workbench-{purpose}-"))
    _writing.add(folder)
    try:
        yield folder
    finally:
        _remove(folder)


def passing_with_this_process(purpose: str) -> Path:
    """Return an empty folder for temporary files, which goes with this process."""
    folder = Path(tempfile.mkdtemp(prefix=f"workbench-{purpose}-"))
    _writing.add(folder)
    atexit.register(_remove, folder)
    return folder


def _remove(folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    _writing.discard(folder)


def abandon() -> None:
    """Remove what is being written; for a process that ends here and now."""
    for beside in tuple(_writing):
        shutil.rmtree(beside, ignore_errors=True)


def _renamed(beside: Path, place: Path, ours: str) -> None:
    """Put a folder in the place of another one, or of none."""
    with suppress(OSError):  # there is none, or it is empty
        os.rename(beside, place)
        return
    if not _swapped(beside, place):
        old = Path(f"{beside}{OLD}")
        os.rename(place, old)
        os.rename(beside, place)
        shutil.rmtree(old, ignore_errors=True)


def _swapped(one: Path, other: Path) -> bool:
    """Let two folders change places at one instant, so that no moment is without an output; False where that cannot be had."""
    try:
        swap = ctypes.CDLL(None).renameat2
    except (OSError, AttributeError, TypeError):  # not on this system
        return False
    return swap(HERE, os.fsencode(one), HERE, os.fsencode(other), EXCHANGE) == 0


def _moved_in(beside: Path, place: Path, ours: str) -> None:
    """Put what a folder inside `place` holds in the place of what lies beside it."""
    leaving, old = Path(f"{beside}{LEAVING}"), Path(f"{beside}{OLD}")
    leaving.mkdir()
    try:
        _move(leaving, sorted(_entries(place), key=lambda p: p.name != ours))  # what says that it is whole goes first
        os.rename(leaving, old)
        _move(place, sorted(_entries(beside), key=lambda p: p.name == ours))  # and comes last
    except BaseException:
        for kept in (leaving, old):
            if kept.is_dir():
                _restored(kept, place, ours)
        raise
    shutil.rmtree(old, ignore_errors=True)


def _restored(old: Path, place: Path, ours: str) -> None:
    """Put back an earlier output that was being replaced."""
    if not place.exists():
        os.rename(old, place)
        return
    if old.name.endswith(OLD):  # all of it had left: what is there is of the new one
        for p in _entries(place):
            shutil.rmtree(p, ignore_errors=True) if p.is_dir() and not p.is_symlink() else p.unlink()
    _move(place, sorted(_entries(old), key=lambda p: p.name == ours))
    old.rmdir()


def _move(into: Path, entries: list[Path]) -> None:
    for p in entries:
        os.rename(p, into / p.name)
