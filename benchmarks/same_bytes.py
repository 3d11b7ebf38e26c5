"""Determinism: one study with a warm and a cold cache, on one core and two, and on a second Python; its outputs byte by byte.

`python -m benchmarks.same_bytes STUDY`; the tutorial's study where none is named. A second Python is one that PATH has
(python3.12, ...) and for which the locked packages can be had; it takes a set-up of its own, and is said to be untested else.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LOGS = ROOT / "docs" / "tutorial"
OTHERS = ("3.14", "3.13", "3.12", "3.11")
STAMP = "stamp.json"  # it names the versions that are installed


def tutorial(place: Path) -> None:
    """Write the tutorial's study as its page leaves it."""
    from workbench.intake.new import new

    new(place, [LOGS / "excitation.csv", LOGS / "moves.csv"])
    file = place / "campaign" / "campaign.toml"
    scales = iter(('scale = { value = 2.79, unit = "N*m/A" }', 'scale = { value = 1.2e6, unit = "count/rev" }'))
    rows = [x for x in file.read_text(encoding="utf-8").splitlines() if not x.startswith(("assumed", "actuator_limit"))]
    rows = [next(scales) if x.startswith("scale =") else x for x in rows]
    first = next(k for k, x in enumerate(rows) if x.startswith("["))
    rows.insert(first, 'actuator_limit = { value = 2.8, unit = "N*m" }\n')
    file.write_text("\n".join(rows) + "\n", encoding="utf-8")


def differing(one: Path, other: Path) -> list[str]:
    """Return the files that are not the same bytes in two folders of outputs."""
    names = {p.relative_to(f).as_posix() for f in (one, other) for p in f.rglob("*") if p.is_file()} - {STAMP}
    return sorted(
        n
        for n in names
        if not all((f / n).is_file() for f in (one, other)) or (one / n).read_bytes() != (other / n).read_bytes()
    )


def ran(study: Path, out: Path, python: str = sys.executable, cores: int = 2, **variables: str) -> Path:
    """Run a study in a process of its own, on so many cores."""
    code = f"import os, sys; os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:{cores}]); from workbench.cli import main; sys.exit(main(sys.argv[1:]))"
    settings = {**os.environ, **variables}
    done = subprocess.run(
        [python, "-c", code, "run", str(study), "--out", str(out)],
        env=settings,
        capture_output=True,
        text=True,
        cwd=study.parent,
    )
    if done.returncode not in (0, 1):
        raise SystemExit(f"The run into {out.name} ended with {done.returncode}: {done.stderr[-1000:]}")
    return out


def second() -> str | None:
    """Return a Python of another version that this machine has, or None."""
    own = f"{sys.version_info[0]}.{sys.version_info[1]}"
    kept = sorted(Path.home().glob(".pyenv/versions/3.*/bin/python3"), reverse=True)
    for found in (*(shutil.which(f"python{v}") for v in OTHERS), *map(str, kept)):
        if found:
            done = subprocess.run(
                [found, "-c", "import sys; print('%d.%d' % sys.version_info[:2])"], capture_output=True, text=True
            )
            if done.returncode == 0 and done.stdout.strip() in OTHERS and done.stdout.strip() != own:
                return found
    return None


def set_up(python: str, place: Path) -> str | None:
    """Return the interpreter of an environment with the locked packages for another Python, or None where it cannot be had."""
    shutil.copytree(ROOT, place, ignore=shutil.ignore_patterns(".venv", ".git", "reports", "__pycache__"))
    done = subprocess.run(["make", "setup", f"PYTHON={python}"], cwd=place, capture_output=True, text=True)
    return str(place / ".venv" / "bin" / "python") if done.returncode == 0 else None


def main(arguments: list[str] = ()) -> None:
    with tempfile.TemporaryDirectory() as name:
        top = Path(name)
        study = top / "studies" / "same"
        if arguments:
            shutil.copytree(arguments[0], study)
        else:
            tutorial(study)
        first = ran(study, top / "warm")
        cases = {
            "cold kernel cache": lambda out: ran(study, out, WORKBENCH_CACHE=str(top / "cache")),
            "one core, one process": lambda out: ran(study, out, cores=1, WORKBENCH_PROCESSES="1"),
        }
        other = second()
        interpreter = other and set_up(other, top / "checkout")
        if interpreter:
            cases[f"another Python ({other})"] = lambda out: ran(study, out, python=interpreter)
        for what, run in cases.items():
            found = differing(first, run(top / what.split()[0]))
            print(f"{what}: {'the same bytes' if not found else f'DIFFERENT: {found}'}", flush=True)
        if not interpreter:
            print(
                "another Python: untested, for "
                + ("its packages could not be had." if other else "none is installed here.")
            )


if __name__ == "__main__":
    main(sys.argv[1:])
