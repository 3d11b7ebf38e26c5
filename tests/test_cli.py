"""The command line: verbs, exit codes, sentences."""

import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from workbench.cli import main

ROOT = Path(__file__).resolve().parent.parent
CAMPAIGN = ROOT / "studies" / "harmonic_drive_axis" / "campaign"


def test_help_names_every_verb(capsys):
    with pytest.raises(SystemExit) as stopped:
        main(["--help"])
    assert stopped.value.code == 0
    said = capsys.readouterr().out
    for verb in ("new", "check", "run", "trace", "effects"):
        assert verb in said


def test_the_package_can_be_run_as_a_module():
    said = subprocess.run([sys.executable, "-m", "workbench", "--version"], capture_output=True, text=True, check=True)
    assert said.stdout.startswith("workbench ")


def test_without_a_verb_the_help_is_shown_and_the_exit_code_is_2(capsys):
    assert main([]) == 2 and "usage" in capsys.readouterr().out


def test_effects_lists_names_formulas_units_and_causes(capsys):
    assert main(["effects"]) == 0
    said = capsys.readouterr().out
    from workbench.definition import catalogue

    for e in catalogue().values():
        assert e.name in said and e.formula in said and e.cause in said


def test_an_unknown_effect_is_answered_with_the_nearest(capsys):
    assert main(["effects", "stribek_friction"]) == 2
    assert "stribeck_friction" in capsys.readouterr().err


def test_an_unknown_study_is_answered_with_one_sentence_and_no_traceback(capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    assert main(["run", "harmonic_drive_axes"]) == 2
    said = capsys.readouterr().err
    assert "harmonic_drive_axis" in said and "Traceback" not in said and said.count("\n") == 1


def test_a_folder_without_a_campaign_is_refused_and_nothing_is_written(tmp_path, capsys):
    assert main(["trace", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    assert "campaign.toml" in capsys.readouterr().err and not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "words",
    [
        ("trace", "harmonic_drive_axes", "--out", "out"),
        ("response", "harmonic_drive_axes", "--out", "out"),
        ("diff", "harmonic_drive_axes", "harmonic_drive_axis", "--out", "out"),
        ("diff", "harmonic_drive_axis", "harmonic_drive_axes", "--out", "out"),
        ("check", "harmonic_drive_axes"),
    ],
)
def test_a_campaign_that_is_not_there_is_answered_with_the_nearest_study_and_nothing_is_written(
    words, tmp_path, capsys, monkeypatch
):
    (tmp_path / "studies").symlink_to(ROOT / "studies")
    monkeypatch.chdir(tmp_path)
    assert main([*words]) == 2
    said = capsys.readouterr().err
    assert "campaign.toml" in said and "'harmonic_drive_axis'" in said and said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_an_internal_error_has_an_exit_code_of_its_own(monkeypatch, capsys):
    from workbench.verbs import effects

    def broken(given):
        raise RuntimeError("broken")

    monkeypatch.setattr(effects, "do", broken)
    assert main(["effects"]) == 70
    assert "internal error" in capsys.readouterr().err


@pytest.mark.parametrize(("options", "closing"), [((), True), (("--no-close",), False)])
def test_the_loop_is_closed_unless_it_is_left_out(options, closing, tmp_path, monkeypatch):
    seen = []
    nothing = SimpleNamespace(sentence="", findings=())
    monkeypatch.setattr(
        "workbench.study.traced.run", lambda *_, closing, resample: seen.append(closing) or (nothing, nothing)
    )
    assert main(["trace", str(CAMPAIGN), "--out", str(tmp_path / "out"), *options]) == 0
    assert seen == [closing]


def test_a_record_cut_short_is_refused_with_its_row_and_the_earlier_output_stays(tmp_path, capsys):
    folder, out = tmp_path / "campaign", tmp_path / "out"
    shutil.copytree(CAMPAIGN, folder)
    out.mkdir()
    (out / "trace.json").write_text("earlier")
    import gzip

    record = folder / "val_moves.csv.gz"
    lines = gzip.decompress(record.read_bytes()).decode().splitlines()
    lines[500] = lines[500].rsplit(",", 1)[0]
    record.write_bytes(gzip.compress("\n".join(lines).encode()))
    assert main(["trace", str(folder), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert "val_moves" in said and "501" in said
    assert (out / "trace.json").read_text() == "earlier"


def test_help_imports_nothing_heavy():
    code = "import sys; from workbench.cli import _parser; _parser(); print([m for m in ('numpy', 'casadi', 'numba') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.stdout.strip() == "[]", done.stderr


def _ended(main: str, **given) -> subprocess.CompletedProcess:
    """Return how a process ends whose command is `main`, a line that prints and returns a code."""
    code = f"import atexit, sys; from workbench import cli; atexit.register(print, 'last'); cli.main = lambda: {main}; cli.command()"
    return subprocess.run([sys.executable, "-c", code], text=True, stderr=subprocess.PIPE, timeout=60, **given)


def test_a_command_that_has_done_its_work_ends_with_its_code_and_has_said_all():
    done = _ended("print('x' * 300_000) or 3", stdout=subprocess.PIPE)
    assert done.returncode == 3 and done.stderr == ""
    assert done.stdout.split() == ["x" * 300_000, "last"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_what_a_full_disk_did_not_take_is_no_success():
    with open("/dev/full", "w") as full:
        done = _ended("print('x') or 0", stdout=full)
    assert done.returncode != 0 and "No space left" in done.stderr
