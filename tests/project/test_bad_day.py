"""What laptops, containers and servers do to a command: one sentence, exit code 2, and what was there stands."""

import json
import os
import shutil
from pathlib import Path

import fuzz
import pytest

from workbench import cli
from workbench.cli import main
from workbench.errors import WorkbenchError
from workbench.study import gains, stamp, standard


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    return fuzz.made(tmp_path_factory.mktemp("sound") / "bench")


@pytest.fixture
def at(sound, tmp_path, monkeypatch):
    """A copy of sound inputs, as the folder that commands run in."""
    monkeypatch.chdir(sound.fresh(tmp_path / "at"))
    return tmp_path / "at"


def refused(capsys, *arguments: str) -> str:
    """Run a command that is refused, and return its sentence."""
    assert main([*arguments]) == 2
    said = capsys.readouterr()
    assert said.err.startswith("workbench: ") and said.err.count("\n") == 1 and said.err.rstrip().endswith((".", "?"))
    assert "Traceback" not in said.err and said.out == ""
    return said.err


def test_a_name_of_three_hundred_characters(at, capsys):
    for verb in ("run", "check"):
        assert "there is no study" in refused(capsys, verb, "x" * 300)


@pytest.mark.parametrize(
    ("code", "words"),
    [("def run(study, say:\n    pass\n", ("line 1", "no valid Python")), ("FURTHER = (a,)\n", ("line 1", "FURTHER must be a tuple")),
     ("FURTHER = 3\n", ("FURTHER must be",)), ("x = 1 / 0\n", ("line 1", "ZeroDivisionError")), ("import not_there\n", ("line 1", "not_there")),
     ("x = 1\n", ("no function run",)), ("def run(study, say):\n    return study.nothing\n", ("line 2", "AttributeError")),
     ("raise SystemExit('no')\n", ("line 1", "SystemExit"))],
)  # fmt: skip
def test_a_fault_in_a_studys_own_steps_is_said_with_its_line(at, capsys, code, words):
    (at / "study" / "study.py").write_text(code)
    (at / "study" / "study.toml").write_text('title = "t"\ncampaign = "campaign"\n')
    said = refused(capsys, "run", "study", "--out", "out")
    assert "study.py" in said and all(w in said for w in words) and not (at / "out").exists()


@pytest.mark.parametrize("value", [None, "x", [1], True, 1e300, {}])
@pytest.mark.parametrize("key", ["duration", "step", "noise"])
def test_worst_cases_with_a_number_that_is_none(at, capsys, key, value):
    content = json.loads((at / "worst.json").read_text()) | {key: value}
    (at / "worst.json").write_text(json.dumps(content))
    assert f"{key} is" in refused(capsys, "replay", "worst.json", "--case", "1")


def test_worst_cases_that_would_take_for_ever(at, capsys):
    content = json.loads((at / "worst.json").read_text()) | {"duration": 1e9}
    (at / "worst.json").write_text(json.dumps(content))
    assert "integration steps" in refused(capsys, "replay", "worst.json")


def test_a_record_that_may_not_be_read_and_one_that_vanishes(at, capsys, monkeypatch):
    """Root may read everything, so the system's answer is put in its place."""
    read, answer = Path.read_bytes, {"error": PermissionError(13, "Permission denied", "study/campaign/b.csv")}

    def bytes_of(path):
        if path.name == "b.csv":
            raise answer["error"]
        return read(path)

    monkeypatch.setattr(Path, "read_bytes", bytes_of)
    assert "Permission denied" in refused(capsys, "run", "study", "--out", "out")
    answer["error"] = FileNotFoundError(2, "No such file or directory", "study/campaign/b.csv")
    assert "b.csv" in refused(capsys, "run", "study", "--out", "out")
    monkeypatch.setattr(stamp, "inputs", lambda *_: "digest")  # it vanishes once the inputs are known
    assert "no such file" in refused(capsys, "run", "study", "--out", "out")
    assert not (at / "out").exists()


@pytest.mark.parametrize(
    "error", [OSError(28, "No space left on device"), OSError(30, "Read-only file system", "out/a"), MemoryError(), OSError(24, "Too many open files")]
)  # fmt: skip
def test_what_the_system_refuses_is_a_sentence(at, capsys, monkeypatch, error):
    def fails(_):
        raise error

    monkeypatch.setattr(cli.VERBS["check"], "do", fails)
    said = refused(capsys, "check", "campaign")
    assert (error.strerror if isinstance(error, OSError) else "memory") in said


@pytest.mark.parametrize(
    "command",
    [
        "run study",
        "trace campaign",
        "plan study",
        "response campaign",
        "diff campaign campaign",
        "replay worst.json --case 1",
    ],
)
def test_a_place_with_somebodys_files_is_refused_before_anything_is_computed(at, capsys, command, monkeypatch):
    (at / "mine").mkdir()
    (at / "mine" / "thesis.txt").write_text("years of work")
    monkeypatch.setattr(standard, "trace", lambda *_: pytest.fail("it computed"))
    assert "did not write" in refused(capsys, *command.split(), "--out", "mine")
    assert os.listdir(at / "mine") == ["thesis.txt"]


def test_two_masses_learn_at_the_start_what_they_will_not_get():
    from workbench.design.possible import check_plant
    from workbench.plant import TWO_MASS, Limits, Plant

    said = []
    gains.early(Plant(TWO_MASS, limits=Limits(drive=3.0)), said.append)
    assert len(said) == 1 and said[0].startswith("No gains will be tuned: ") and "two masses" in said[0]
    with pytest.raises(WorkbenchError, match="two masses"):
        check_plant(Plant(TWO_MASS, limits=Limits(drive=3.0)))


def test_a_run_says_before_it_traces_that_it_will_tune_nothing(at, capsys, monkeypatch):
    campaign = at / "study" / "campaign" / "campaign.toml"
    campaign.write_text("\n".join(x for x in campaign.read_text().splitlines() if "actuator_limit" not in x))
    shutil.rmtree(at / "out", ignore_errors=True)
    (at / "study" / "study.py").unlink()
    (at / "study" / "study.toml").write_text('title = "t"\ncampaign = "campaign"\n[task]\n')

    def stop(*_):
        raise WorkbenchError("far enough.")

    monkeypatch.setattr(standard, "trace", stop)
    assert main(["run", "study", "--out", "out"]) == 2
    first, *_ = capsys.readouterr().err.splitlines()
    assert first.startswith("workbench: No gains will be tuned") and "actuator_limit" in first


def test_a_command_map_that_leaves_nothing_has_no_value_and_warns_nobody(at, monkeypatch):
    from workbench.campaign import load
    from workbench.identification.problem import Problem
    from workbench.identification.solve import solved_at
    from workbench.inverse.dynamics import inverse_dynamics

    campaign = load(at / "campaign")
    problem = Problem(campaign.plant, inverse_dynamics(campaign.records, campaign.bandwidth))
    monkeypatch.setattr(Problem, "command_scale", lambda *_: float("inf"))
    assert not solved_at(problem, problem.start()).cost < float("inf")  # warnings are errors here


def test_a_device_is_no_file_of_worst_cases_or_gains(capsys):
    from workbench.exporting import load, load_binary

    assert "a device" in refused(capsys, "replay", "/dev/zero")
    for loader in (load, load_binary):
        with pytest.raises(WorkbenchError, match="a device"):
            loader("/dev/zero")


def test_make_clean_removes_what_the_commands_made_and_nothing_else(tmp_path):
    """A study that somebody made is theirs; so is whatever else lies in the folder of the cache."""
    import subprocess

    root, cache = tmp_path / "checkout", tmp_path / "cache"
    for file in ("studies/axis/.steps/d/0-trace.step", "studies/axis/study.toml", "reports/axis/report.html", "reports/README.md",
                 ".venv/x", "workbench/__pycache__/x.pyc", "../cache/kernels/k.py", "../cache/times/t.json", "../cache/mine.txt"):  # fmt: skip
        (root / file).parent.mkdir(parents=True, exist_ok=True)
        (root / file).write_text("x")
    for name in ("Makefile", "requirements.lock", "pyproject.toml"):
        shutil.copy(Path(__file__).resolve().parents[2] / name, root / name)
    settings = {**os.environ, "WORKBENCH_CACHE": str(cache)}
    done = subprocess.run(["make", "clean"], cwd=root, env=settings, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    left = {p.relative_to(tmp_path).as_posix() for p in tmp_path.rglob("*") if p.is_file()}
    assert left == {"cache/mine.txt", *(f"checkout/{n}" for n in ("Makefile", "requirements.lock", "pyproject.toml",
                    "reports/README.md", "studies/axis/study.toml"))}  # fmt: skip
