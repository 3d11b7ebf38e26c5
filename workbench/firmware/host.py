"""The generated C on this machine: compiled, and called with arrays."""

import ctypes
import shutil
import subprocess
from collections.abc import Mapping, Sequence

from workbench import outputs
from workbench.errors import WorkbenchError

STRICT = ("-std=c99", "-ffp-contract=off")
WARNINGS = ("-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-pedantic", "-Werror")


def compiler() -> str:
    """Return the C compiler of this machine; WorkbenchError where there is none."""
    for name in ("gcc", "clang", "cc"):
        if found := shutil.which(name):
            return found
    raise WorkbenchError("there is no C compiler here: install gcc or clang to run the firmware on this machine.")


def compiled(files: Mapping[str, str], options: Sequence[str] = ("-O2",)) -> ctypes.CDLL:
    """Return the .c files of `files` (name -> text) as a library that is loaded; nothing of it stays on disk.

    WorkbenchError, with what the compiler said, where it does not compile without a warning.
    """
    # A loaded library outlives its file, but for systems that do not let go of one: there it stays behind.
    with outputs.passing("firmware") as folder:
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")
        out = folder / "firmware.so"
        sources = [n for n in files if n.endswith(".c")]
        command = [compiler(), *STRICT, *WARNINGS, *options, "-fPIC", "-shared", *sources, "-o", str(out), "-lm"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        if done.returncode:
            raise WorkbenchError(f"the firmware's C does not compile: {done.stderr.strip()}")
        return ctypes.CDLL(str(out))
