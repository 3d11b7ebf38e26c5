"""Generated kernel source on disk, so that numba compiles each once per machine.

A file is named by the hash of its text and of the modules that make instructions of it: numba keeps its code until the file changes, and
would run what an older project wrote of the same text.
"""

import contextlib
import hashlib
import importlib.util
import os
import sys
import tempfile
from functools import lru_cache
from pathlib import Path
from types import ModuleType

from workbench import outputs

# How a generated kernel is compiled. Of every function numba also makes one that C code may call, and looks for expressions of whole
# arrays to rewrite: kernels need neither, and are compiled in a seventh less time without.
JIT = '@numba.njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True, no_rewrites=True)'

WRITERS = "instructions.py", "loops.py", "straight.py"  # beside this file


def folder() -> Path:
    """Where kernels are kept: $WORKBENCH_CACHE, else servo-workbench in the user's cache folder."""
    if given := os.environ.get("WORKBENCH_CACHE"):
        return Path(given)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "servo-workbench"


def write_whole(path: Path, text: str) -> None:
    """Write a file so that it is there whole or not at all, also beside another process that writes the same."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, beside = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=path.suffix)
    with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as f:
        f.write(text)
    os.replace(beside, path)


def _is_text(path: Path, text: str) -> bool:
    """Whether a file is there and holds exactly this; a machine that went down may have left half of it."""
    try:
        return path.read_bytes() == text.encode()
    except OSError:
        return False


def _drop_broken(path: Path) -> None:
    """Take away what numba kept of a kernel and cannot read back: it would raise, where it should compile again.

    Its files are pickles, which begin with 0x80 and end with a full stop.
    """
    for kept in (path.parent / "__pycache__").glob(f"{path.stem}.*.nb[ci]"):
        with contextlib.suppress(OSError):
            content = kept.read_bytes()
            if content[:1] != b"\x80" or content[-1:] != b".":
                kept.unlink()


@lru_cache(maxsize=1)
def _passing() -> Path:
    """A folder for the kernels of this process alone, which goes with it."""
    return outputs.passing_with_this_process("kernels")


@lru_cache(maxsize=1)
def _writers() -> bytes:
    return b"".join(Path(__file__).with_name(name).read_bytes() for name in WRITERS)


@lru_cache(maxsize=512)
def load(text: str, name: str) -> ModuleType:
    """Return a module with this source. A folder that cannot be written falls back to a temporary one.

    What is broken there is made again.
    """
    digest = hashlib.sha256(_writers() + text.encode()).hexdigest()[:20]
    module_name = f"{name}_{digest}"
    path = folder() / "kernels" / f"{module_name}.py"
    if not _is_text(path, text):
        try:
            write_whole(path, text)
        except OSError:
            path = _passing() / path.name
            write_whole(path, text)
    _drop_broken(path)
    spec = importlib.util.spec_from_file_location(module_name, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[module_name] = module  # numba finds a cached function's globals by this name
    spec.loader.exec_module(module)
    return module
