"""A study: its declaration, its stamp, and what happens where something is wrong."""

import hashlib
import json
import shutil
from pathlib import Path

import pytest

from workbench.errors import WorkbenchError
from workbench.study import configuration, stamp
from workbench.study.configuration import MissingData, Requirement

ROOT = Path(__file__).resolve().parents[2]
SHORT = 'title = "t"\ncampaign = "campaign"\n'


@pytest.fixture
def study(tmp_path):
    """Return a function that writes a study with the carried campaign and this study.toml, and gives its folder."""

    def write(text: str) -> Path:
        folder = tmp_path / "studies" / "one"
        folder.mkdir(parents=True, exist_ok=True)
        if not (folder / "campaign").exists():
            shutil.copytree(ROOT / "studies" / "harmonic_drive_axis" / "campaign", folder / "campaign")
        (folder / "study.toml").write_text(text)
        return folder

    return write


def refused(folder, *words):
    with pytest.raises(WorkbenchError) as caught:
        configuration.load(folder)
    for word in ("study.toml", *words):
        assert word in str(caught.value)


def test_a_mistyped_key_is_answered_with_the_nearest(study):
    refused(study(SHORT + 'questoin = "x"\n'), "questoin", "question")


def test_a_campaign_that_is_not_there_is_named(study):
    refused(study('title = "t"\ncampaign = "elsewhere"\n'), "elsewhere", "campaign.toml")


def test_a_null_character_in_a_name_is_refused(study):
    refused(study('title = "t"\ncampaign = "else\\u0000where"\n'), "campaign", "null character")


def test_a_requirement_without_a_bound_is_refused(study):
    refused(
        study(SHORT + "[requirements]\nvalidation_error_after = { unit = '1' }\n"), "validation_error_after", "at_most"
    )


def test_amplitudes_the_wrong_way_round_are_refused(study):
    refused(study(SHORT + "[describe]\nlowest = 1.0\nhighest = 0.1\ncount = 5\n"), "lowest", "highest")


@pytest.mark.parametrize(
    ("requirement", "value", "passed"),
    [
        (Requirement("x", at_most=1.0), 1.0, True),
        (Requirement("x", at_most=1.0), 1.1, False),
        (Requirement("x", at_least=1.0), 0.9, False),
        (Requirement("x", at_least=0.5, at_most=1.0), 0.7, True),
        (Requirement("x", at_most=1.0), float("nan"), False),
        (Requirement("x", equals="cause"), "cause", True),
        (Requirement("x", equals="cause"), "unknown", False),
        (Requirement("x", at_most=1.0), "cause", False),
    ],
)
def test_a_requirement_passes_only_within_its_bound(requirement, value, passed):
    assert requirement.passed(value) is passed


def test_measured_data_is_found_checked_and_asked_for(study, tmp_path, monkeypatch):
    content = b"1,2\n"
    digest = hashlib.sha256(content).hexdigest()
    loaded = configuration.load(study(f'title = "t"\n[data.record]\npath = "rig/a.csv"\nsha256 = "{digest}"\n'))
    monkeypatch.delenv("WORKBENCH_DATA", raising=False)
    with pytest.raises(MissingData, match="WORKBENCH_DATA"):
        loaded.measured("record")
    monkeypatch.setenv("WORKBENCH_DATA", str(tmp_path))
    with pytest.raises(MissingData, match="no such file"):
        loaded.measured("record")
    (tmp_path / "rig").mkdir()
    (tmp_path / "rig" / "a.csv").write_bytes(content)
    assert loaded.measured("record").read_bytes() == content
    (tmp_path / "rig" / "a.csv").write_bytes(b"1,3\n")
    with pytest.raises(WorkbenchError, match="sha256"):
        loaded.measured("record")


def test_the_stamp_changes_with_any_input_file_and_with_nothing_else(study):
    folder = study(SHORT)
    first = stamp.inputs(folder)
    assert stamp.inputs(folder) == first
    (folder / "study.toml").write_text(SHORT + "# a note\n")
    assert stamp.inputs(folder) != first


def test_outputs_that_were_touched_are_not_taken_for_whole(tmp_path):
    (tmp_path / "a.json").write_text("{}")
    stamp.write(tmp_path, "digest")
    assert stamp.unchanged(tmp_path, "digest") and not stamp.unchanged(tmp_path, "another")
    (tmp_path / "a.json").write_text("{ }")
    assert not stamp.unchanged(tmp_path, "digest")
    (tmp_path / "a.json").unlink()
    assert not stamp.unchanged(tmp_path, "digest")


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """The main study's own records with the first chapters only, run once into a folder of its own: (Ran, folder, Outcome)."""
    from workbench.study import standard
    from workbench.study.running import run

    top = tmp_path_factory.mktemp("ran")
    folder = top / "studies" / "axis"
    shutil.copytree(ROOT / "studies" / "harmonic_drive_axis" / "campaign", folder / "campaign")
    text = SHORT + "[describe]\nlowest = 1e-5\nhighest = 1.0\ncount = 5\n"
    (folder / "study.toml").write_text(
        text + '[requirements]\nverdict = { equals = "cause" }\nvalidation_error_after = { at_most = 1e-9 }\n'
    )
    outcomes, steps = [], standard.run
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(standard, "run", lambda *given: outcomes.append(steps(*given)) or outcomes[0])
        return run(str(folder)), folder, outcomes[0]


def test_a_run_writes_report_results_trace_and_predictions(ran):
    place = ran[0].folder
    assert place == ran[1].parent.parent / "reports" / "axis"
    for name in ("report.html", "report.pdf", "results.json", "trace.json", "predictions/val_moves.csv"):
        assert (place / name).stat().st_size > 0


def test_checks_say_what_holds_and_what_does_not(ran):
    checks = json.loads((ran[0].folder / "results.json").read_text())["checks"]
    assert [(c["name"], c["passed"]) for c in checks] == [("verdict", True), ("validation error after", False)]
    assert all({"name", "value", "unit", "bound", "passed", "words"} == set(c) for c in checks)
    assert not ran[0].passed


def test_a_second_run_with_nothing_changed_computes_nothing(ran):
    from workbench.study.running import run

    again = run(str(ran[1]))
    assert not again.fresh and again.lines == ran[0].lines and again.passed == ran[0].passed


def test_a_requirement_on_a_figure_that_is_not_there_names_the_nearest(study, ran, monkeypatch):
    """The study has come to what `ran` has: its requirement is looked up, and nothing is written."""
    from workbench.study import standard
    from workbench.study.running import run

    monkeypatch.setattr(standard, "run", lambda *_: ran[2])
    folder = study(SHORT + "[requirements]\nvalidation_eror_after = { at_most = 1 }\n")
    with pytest.raises(WorkbenchError, match="validation_error_after"):
        run(str(folder))
    assert not (folder.parent.parent / "reports").exists() or not any((folder.parent.parent / "reports").iterdir())
