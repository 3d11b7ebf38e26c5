"""Files that belong together: all of them are there, or the folder is as it was."""

import os
import secrets
from collections.abc import Mapping
from pathlib import Path

from workbench.errors import WorkbenchError


def write_together(folder: Path, files: Mapping[str, bytes]) -> tuple[Path, ...]:
    """Write files into `folder`, made where it is not there, and return their paths.

    Each is written beside its place and renamed into it. Where anything fails, what was there before is put back and
    nothing else is left; a failure of the file system is raised as a WorkbenchError.
    """
    made = [p for p in (folder, *folder.parents) if not p.exists()]  # innermost first
    token = secrets.token_hex(6)
    targets = {folder / name: content for name, content in files.items()}
    parts = {path: path.with_name(f".{path.name}.{token}.part") for path in targets}
    before: dict[Path, bytes | None] = {}
    done: list[Path] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path, content in targets.items():
            before[path] = path.read_bytes() if path.exists() else None
            parts[path].write_bytes(content)
        for path in targets:
            os.replace(parts[path], path)
            done.append(path)
    except BaseException as error:
        _undo(done, before, parts, made)
        if isinstance(error, OSError):
            raise WorkbenchError(
                f"{folder}: the gain table could not be written ({error.strerror or error}: {error.filename});"
                " nothing was changed there. Name a folder that can be written."
            ) from error
        raise
    return tuple(targets)


def _undo(done: list[Path], before: Mapping[Path, bytes | None], parts: Mapping[Path, Path], made: list[Path]) -> None:
    """Put back what was there: the files replaced, then the folders made. Goes on where a step fails."""
    for path in done:
        old = before[path]
        try:
            if old is None:
                path.unlink(missing_ok=True)
            else:
                parts[path].write_bytes(old)
                os.replace(parts[path], path)
        except OSError:
            pass
    for part in parts.values():
        try:
            part.unlink(missing_ok=True)
        except OSError:
            pass
    for folder in made:
        try:
            folder.rmdir()
        except OSError:
            pass
