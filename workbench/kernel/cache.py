"""Generated kernel source on disk, named by the hash of its text, so that numba compiles each once per machine."""

import hashlib
import importlib.util
import os
import sys
import tempfile
from functools import lru_cache
from pathlib import Path
from types import ModuleType


def folder() -> Path:
    """Where kernels are kept: $WORKBENCH_CACHE, else servo-workbench in the user's cache folder."""
    if given := os.environ.get("WORKBENCH_CACHE"):
        return Path(given)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "servo-workbench"


def write_whole(path: Path, text: str) -> None:
    """Write a file so that it is there whole or not at all, also beside another process that writes the same."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, beside = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=path.suffix)
    with os.fdopen(handle, "w") as f:
        f.write(text)
    os.replace(beside, path)


@lru_cache(maxsize=512)
def load(text: str, name: str) -> ModuleType:
    """Return a module with this source. A folder that cannot be written falls back to a temporary one."""
    digest = hashlib.sha256(text.encode()).hexdigest()[:20]
    module_name = f"{name}_{digest}"
    path = folder() / "kernels" / f"{module_name}.py"
    if not path.exists():
        try:
            write_whole(path, text)
        except OSError:
            path = Path(tempfile.mkdtemp(prefix="workbench-kernels-")) / path.name
            write_whole(path, text)
    spec = importlib.util.spec_from_file_location(module_name, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[module_name] = module  # numba finds a cached function's globals by this name
    spec.loader.exec_module(module)
    return module
