"""The generated C on this machine: compiled, and called with arrays."""

import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from workbench.errors import WorkbenchError

STRICT = ("-std=c99", "-ffp-contract=off")
WARNINGS = ("-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-pedantic", "-Werror")


def compiler() -> str:
    """Return the C compiler of this machine; WorkbenchError where there is none."""
    for name in ("gcc", "clang", "cc"):
        if found := shutil.which(name):
            return found
    raise WorkbenchError("there is no C compiler here: install gcc or clang to run the firmware on this machine.")


def build(files: Mapping[str, str], options: Sequence[str] = ("-O2",), folder: Path | None = None) -> Path:
    """Compile the .c files of `files` (name -> text) to a shared library, and return its path.

    WorkbenchError, with what the compiler said, where it does not compile without a warning.
    """
    folder = Path(tempfile.mkdtemp(prefix="workbench-firmware-")) if folder is None else folder
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    out = folder / "firmware.so"
    sources = [n for n in files if n.endswith(".c")]
    command = [compiler(), *STRICT, *WARNINGS, *options, "-fPIC", "-shared", *sources, "-o", str(out), "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise WorkbenchError(f"the firmware's C does not compile: {done.stderr.strip()}")
    return out


def load(path: Path) -> ctypes.CDLL:
    """Return a compiled library."""
    return ctypes.CDLL(str(path))
