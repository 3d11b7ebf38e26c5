"""A path that is read must be a file."""

from pathlib import Path

from workbench.errors import WorkbenchError


def regular(path: Path) -> Path:
    """Return `path`; WorkbenchError where it is there and no file: a device may never end."""
    if path.exists() and not path.is_file():
        raise WorkbenchError(f"{path} is a folder or a device; name a file.")
    return path
