"""Whether a study's outputs are already there: a digest of all that they depend on, and of what was written.

Only the standard library is imported, so that a run with nothing changed answers at once.
"""

import hashlib
import json
import os
from collections.abc import Iterable
from importlib.metadata import distributions
from pathlib import Path

FILE = "stamp.json"


def _digest_of(paths: Iterable[Path], root: Path) -> "hashlib._Hash":
    """Return a sha256 over names (relative to root) and contents of files, in the order of their names."""
    total = hashlib.sha256()
    for path in sorted(paths):
        total.update(os.path.relpath(path, root).encode() + b"\0")
        total.update(hashlib.sha256(path.read_bytes()).digest())
    return total


def files(folder: Path) -> list[Path]:
    """Every file below a folder that is no cache or hidden file."""
    return [
        p
        for p in folder.rglob("*")
        if p.is_file()
        and "__pycache__" not in p.parts
        and not any(part.startswith(".") for part in p.relative_to(folder).parts)
    ]


def sources(study: Path, extra: Iterable[Path] = ()) -> "hashlib._Hash":
    """Return the sha256 of a study on any machine: its folder, further input files, and this package's code."""
    package = Path(__file__).resolve().parent.parent
    total = _digest_of(files(package), package)
    total.update(_digest_of(files(study), study).digest())
    for path in sorted(extra):
        total.update(str(path.name).encode() + hashlib.sha256(path.read_bytes()).digest())
    return total


def inputs(study: Path, extra: Iterable[Path] = ()) -> str:
    """Return the digest of a study: its sources, and the versions installed."""
    total = sources(study, extra)
    versions = sorted(f"{d.metadata['Name']}=={d.version}" for d in distributions() if d.metadata["Name"])
    total.update("\n".join(versions).encode())
    return total.hexdigest()


def write(folder: Path, digest: str) -> None:
    """Leave the stamp in a folder of outputs."""
    written = {str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest() for p in files(folder)}
    (folder / FILE).write_text(json.dumps({"inputs": digest, "outputs": written}, indent=1, sort_keys=True) + "\n")


def unchanged(folder: Path, digest: str) -> bool:
    """Whether the outputs in `folder` belong to this digest and are all as they were written."""
    try:
        stamp = json.loads((folder / FILE).read_text(encoding="utf-8"))
        return stamp["inputs"] == digest and all(
            hashlib.sha256((folder / name).read_bytes()).hexdigest() == was for name, was in stamp["outputs"].items()
        )
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return False
