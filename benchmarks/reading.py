"""How long a user waits before anything is computed: a record of a minute is read, a campaign is checked.

A record is read beside numpy.loadtxt of the same file, in each dialect; a check beside the start of the libraries that it
stands on, each in a process of its own with kernels and bytecode in their caches.
"""

import gzip
import os
import resource
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

from workbench.readers import read

CAMPAIGN = Path(__file__).resolve().parent.parent / "studies" / "harmonic_drive_models" / "campaign"
CHECK = f"import sys; from workbench.cli import main; sys.exit(main(['check', {str(CAMPAIGN)!r}]))"
STAND = "import casadi, numba, numpy, pint, scipy.linalg"
NAMES = ("t", "F", "x", "r")
ROWS = 25_000
DELIMITERS = {"commas": ",", "semicolons": ";", "tabs": "\t", "blanks": "  "}
OFTEN = 5


def least(work) -> float:
    """Seconds of the quickest of a few calls."""
    taken = []
    for _ in range(OFTEN):
        begin = perf_counter()
        work()
        taken.append(perf_counter() - begin)
    return min(taken)


def processor(code: str) -> float:
    """Seconds of processor time of the quickest of a few processes that run this code."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    taken = []
    for _ in range(OFTEN):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-c", code], env=environment, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        taken.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(taken)


def reading(folder: Path) -> None:
    values = [(k / 1000, k % 7 / 9, k * 1e-6, k * 1e-6) for k in range(ROWS)]
    columns = {"time": "t", "force": "F", "position": "x", "reference": "r"}
    print(f"A record of {ROWS} rows and {len(NAMES)} columns; numpy.loadtxt reads one dialect, told which:")
    for name, delimiter in DELIMITERS.items():
        lines = [delimiter.join(NAMES), *(delimiter.join(f"{v:.7f}" for v in row) for row in values)]
        content = "\n".join(lines).encode()
        for kind, written in (("", content), (", compressed", gzip.compress(content))):
            path = folder / f"run.csv{'.gz' if kind else ''}"
            path.write_bytes(written)
            blanks = None if delimiter.isspace() and delimiter != "\t" else delimiter
            peer = np.loadtxt(path, delimiter=blanks, skiprows=1)
            channels, _ = read(path, columns)
            assert np.array_equal(channels["position"], peer[:, 2])
            ours = least(lambda p=path: read(p, columns))
            theirs = least(lambda p=path, d=blanks: np.loadtxt(p, delimiter=d, skiprows=1))
            print(f"  {name + kind:24s} {1e3 * ours:6.0f} ms, {ours / theirs:.2f} of loadtxt's time")


def main() -> None:
    with TemporaryDirectory() as folder:
        reading(Path(folder))
    whole, stand = processor(CHECK), processor(STAND)
    print(f"`workbench check` of a campaign: {whole:.2f} s of processor time, {whole / stand:.2f} times the start of")
    print(f"the libraries that it stands on ({STAND.removeprefix('import ')}).")


if __name__ == "__main__":
    main()
