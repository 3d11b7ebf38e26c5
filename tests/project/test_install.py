"""How the workbench is installed: what a lean set-up takes of the lock, and a wheel that works away from the repository."""

import contextlib
import importlib.util
import io
import os
import subprocess
import sys
import sysconfig
import tomllib
import venv
from importlib import metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from workbench.cli import main

ROOT = Path(__file__).resolve().parents[2]
SPEC = importlib.util.spec_from_file_location("pins", ROOT / "tools" / "pins.py")
pins = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(pins)

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
OPTIONAL = PROJECT["project"]["optional-dependencies"]


def chosen(*extras: str) -> set[str]:
    return set(pins.entries(pins.select(list(extras))))


def test_a_lean_set_up_has_no_benchmark_peer_no_format_and_no_test_tool():
    extras = {canonicalize_name(Requirement(r).name) for e in set(OPTIONAL) - {"setup"} for r in OPTIONAL[e]}
    assert extras & chosen() == {"packaging"}  # which matplotlib asks for, too
    assert {canonicalize_name(Requirement(r).name) for r in PROJECT["project"]["dependencies"]} <= chosen()


@pytest.mark.parametrize("extras", [(), *((e,) for e in sorted(OPTIONAL)), tuple(sorted(OPTIONAL))], ids=str)
def test_a_choice_of_extras_holds_whatever_its_packages_ask_for(extras):
    names = chosen(*extras)
    for extra in extras:
        assert {canonicalize_name(Requirement(r).name) for r in OPTIONAL[extra]} <= names
    for name in names:
        try:
            asked = metadata.requires(name) or ()
        except metadata.PackageNotFoundError:  # for another system or Python
            continue
        for requirement in map(Requirement, asked):
            if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
                assert canonicalize_name(requirement.name) in names, f"{name} asks for {requirement}"


def test_all_extras_are_the_whole_lock_and_an_unknown_one_is_refused():
    lock = (ROOT / "requirements.lock").read_text(encoding="utf-8")
    assert pins.select(["all"]) == lock
    assert chosen(*OPTIONAL) == set(pins.entries(lock)), "the lock holds what no extra asks for: run make lock"
    with pytest.raises(SystemExit, match="no extra 'hdf'"):
        pins.select(["hdf"])


def test_the_page_of_licences_is_that_of_the_lock():
    page = (ROOT / "docs" / "third-party.md").read_text(encoding="utf-8")
    for name, entry in pins.entries((ROOT / "requirements.lock").read_text(encoding="utf-8")).items():
        assert f"| {name} | {entry.split()[0].partition('==')[2]} |" in page, "run make third-party"
    core = [line for line in page.splitlines() if line.endswith("| the package |")]
    assert len(core) == len(chosen()) and not [
        line for line in core if "GPL" in line.upper() and "LGPL" not in line.upper()
    ]


@pytest.fixture(scope="module")
def installed(tmp_path_factory) -> Path:
    """An environment with the wheel alone, beside the dependencies that are here; the folder with its workbench."""
    place = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", str(place)]
    subprocess.run(command, cwd=ROOT, capture_output=True, check=True)
    (wheel,) = place.glob("*.whl")
    venv.create(place / "env", with_pip=False, symlinks=os.name != "nt")
    python = next(p for p in ((place / "env" / b / "python") for b in ("bin", "Scripts")) if p.exists())
    site = subprocess.run(
        [python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()
    install = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-deps",
        "--no-index",
        "--target",
        site,
        str(wheel),
    ]
    subprocess.run(install, check=True, capture_output=True)
    # behind the environment's own folder, so that the wheel is found first; .pth files in it are not read
    Path(site, "beside.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    return python


def call(python: Path, place: Path, *words: str) -> subprocess.CompletedProcess:
    env = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    code = "import sys; from workbench.cli import main; sys.exit(main())"
    return subprocess.run([python, "-I", "-c", code, *words], cwd=place, capture_output=True, text=True, env=env)


def test_a_wheel_makes_checks_and_traces_a_study_away_from_the_repository(installed, tmp_path):
    where = subprocess.run(
        [installed, "-I", "-c", "import workbench; print(workbench.__file__)"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
    )
    assert Path(where.stdout.strip()).is_relative_to(installed.parent.parent)
    logs = [str(ROOT / "docs" / "tutorial" / f"{name}.csv") for name in ("excitation", "moves")]
    made = call(installed, tmp_path, "new", "my_axis", "--records", *logs)
    assert made.returncode == 0, made.stderr
    checked = call(installed, tmp_path, "check", "my_axis")
    assert checked.returncode == 1 and "assumed scale" in checked.stdout, checked.stderr
    traced = call(installed, tmp_path, "trace", "my_axis", "--out", "found", "--no-close")
    assert traced.returncode == 0, traced.stderr
    assert "missing" in traced.stdout
    for name in ("trace.json", "trace.html", "trace.pdf"):
        assert (tmp_path / "found" / name).stat().st_size > 0


def script(shell: str) -> str:
    """Return what the command line prints for a shell."""
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        assert main(["completion", shell]) == 0
    return printed.getvalue()


def completed(shell: str, *words: str) -> list[str]:
    """Return what bash offers after these words; the last one is being typed."""
    typed = " ".join(f'"{w}"' for w in words)
    asked = f"{script(shell).replace('autoload -Uz bashcompinit && bashcompinit', '')}\n"
    asked += f'COMP_WORDS=(workbench {typed}); COMP_CWORD={len(words)}; _workbench; echo "${{COMPREPLY[@]}}"'
    done = subprocess.run(["bash", "-c", asked], capture_output=True, text=True, cwd=ROOT, check=True)
    return done.stdout.split()


@pytest.mark.parametrize("shell", ["bash", "zsh"])
def test_a_shell_completes_verbs_options_and_studies(shell):
    from workbench.cli import VERBS

    assert completed(shell, "") == list(VERBS)
    assert completed(shell, "di") == ["diff"]
    assert completed(shell, "trace", "--no") == ["--no-close"]
    assert "harmonic_drive_axis" in completed(shell, "run", "harmonic_drive_a")
    assert completed(shell, "run", "READ") == ["README.md"]


def test_on_windows_one_process_works_and_none_is_ended_by_being_asked_for(monkeypatch):
    from workbench import outputs, processes

    monkeypatch.setattr(outputs.os, "name", "nt")
    monkeypatch.setattr(outputs.os, "kill", lambda *_: pytest.fail("a signal was sent"))
    assert outputs.is_running("1")
    monkeypatch.setattr(processes.sys, "platform", "win32")
    assert processes.count() == 1 and list(processes.shared(abs, [-1, -2])) == [1, 2]
