"""How long the project's own commands take, in wall and CPU time, beside what is asked: the main study with kernels compiled anew
and again, each study of a paper, both of harmonic drives together, and all tests. What else the machine does counts in the wall time.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from time import monotonic

from benchmarks._timing import cpu

ROOT = Path(__file__).resolve().parent.parent
MAIN, PAPERS, PIVOT = "harmonic_drive_axis", ("harmonic_drive_single_mass", "harmonic_drive_two_mass"), "vcm_pivot"


def main() -> None:
    print(f"{'on ' + str(os.cpu_count()) + ' cores':54s} wall, s   asked   CPU, s")
    with tempfile.TemporaryDirectory() as folder:
        cache = {"WORKBENCH_CACHE": str(Path(folder, "cache"))}

        def study(name: str) -> list[str]:
            place = tempfile.mkdtemp(dir=folder)
            return [sys.executable, "-m", "workbench", "run", str(ROOT / "studies" / name), "--out", place + "/out"]

        _told(f"{MAIN}, kernels compiled anew", 90.0, [study(MAIN)], cache)
        _told(f"{MAIN}, kernels compiled before", 90.0, [study(MAIN)], cache)
        for name in (*PAPERS, PIVOT):
            _told(name, 150.0, [study(name)], cache)
        _told("both of harmonic drives, side by side", 300.0, [study(name) for name in PAPERS], cache)
    _told("all tests", 480.0, [[sys.executable, "-m", "pytest", "-q", "-n", "2", "--dist", "worksteal"]], {})


def _told(what: str, asked: float, commands: list[list[str]], more: dict[str, str]) -> None:
    """Run commands side by side to their end, and print what they took."""
    begin, spent = monotonic(), cpu()
    runs = [subprocess.Popen(c, cwd=ROOT, env=os.environ | more, stdout=subprocess.DEVNULL) for c in commands]
    codes = [run.wait() for run in runs]
    failed = "" if not any(codes) else f"   ended with {', '.join(map(str, codes))}"
    print(f"{what:54s} {monotonic() - begin:7.0f} {asked:7.0f} {cpu() - spent:8.0f}{failed}", flush=True)


if __name__ == "__main__":
    main()
