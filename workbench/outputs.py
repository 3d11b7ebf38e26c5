"""Outputs appear whole or not at all: a folder is written beside its place and renamed into it."""

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from workbench.errors import WorkbenchError

MARK = ".partial-"


def is_running(pid: str) -> bool:
    """Whether a process of this number runs on this machine; where that cannot be asked, it counts as running."""
    if os.name == "nt":  # there is no signal 0: to send it would end the process
        return True
    try:
        os.kill(int(pid), 0)
    except (ProcessLookupError, ValueError):
        return False
    except PermissionError:
        return True
    return True


def sweep(place: Path) -> None:
    """Remove what killed runs left beside `place`; what a run that still goes on has written is left alone."""
    for left in place.parent.glob(f".{place.name}{MARK}*"):
        if not is_running(left.name.rsplit(MARK, 1)[1].split("-")[0]):
            shutil.rmtree(left, ignore_errors=True)


def replaceable(place: Path, ours: str) -> Path:
    """Return `place` as an absolute path; WorkbenchError where it holds what `whole` would not replace.

    Whatever takes long asks this first, so that a mistyped folder is said before and not after.
    """
    place = Path(os.path.abspath(place))
    if place.exists() and not place.is_dir():
        raise WorkbenchError(f"{place} is a file; name a folder to write into.")
    if place.is_dir() and any(place.iterdir()) and not (place / ours).is_file():
        raise WorkbenchError(
            f"{place} holds files that this command did not write (there is no {ours}); name an empty or a new folder."
        )
    return place


@contextmanager
def whole(place: Path, ours: str) -> Iterator[Path]:
    """Yield an empty folder; when the block ends well it becomes `place`, replacing an earlier output.

    ours: the file by which an earlier output is known. A folder that holds files but not this one is not ours to
    replace: WorkbenchError. When the block raises, `place` stays as it was.
    """
    place = replaceable(place, ours)
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        sweep(place)
        beside = Path(tempfile.mkdtemp(prefix=f".{place.name}{MARK}{os.getpid()}-", dir=place.parent))
    except OSError as error:
        raise WorkbenchError(f"{place.parent} cannot be written: {error.strerror}; name another folder.") from error
    try:
        yield beside
        beside.chmod(0o755)
        if place.exists():
            old = Path(f"{beside}-old")
            os.rename(place, old)
            os.rename(beside, place)
            shutil.rmtree(old, ignore_errors=True)
        else:
            os.rename(beside, place)
    finally:
        shutil.rmtree(beside, ignore_errors=True)
