"""Outputs appear whole or not at all."""

import os
import subprocess
import sys

import pytest

from workbench.errors import WorkbenchError
from workbench.outputs import MARK, whole


def names(folder):
    return sorted(p.name for p in folder.iterdir())


def test_a_block_that_ends_well_becomes_the_folder(tmp_path):
    with whole(tmp_path / "out", "done") as beside:
        (beside / "done").write_text("1")
        assert not (tmp_path / "out").exists()
    assert names(tmp_path) == ["out"] and names(tmp_path / "out") == ["done"]


def test_a_block_that_raises_leaves_the_earlier_output_as_it_was(tmp_path):
    with whole(tmp_path / "out", "done") as beside:
        (beside / "done").write_text("first")
    with pytest.raises(RuntimeError), whole(tmp_path / "out", "done") as beside:
        (beside / "done").write_text("second")
        raise RuntimeError
    assert (tmp_path / "out" / "done").read_text() == "first" and names(tmp_path) == ["out"]


def test_an_earlier_output_is_replaced_with_all_its_files(tmp_path):
    for content in ("a", "b"):
        with whole(tmp_path / "out", "done") as beside:
            (beside / "done").write_text("1")
            (beside / content).write_text("1")
    assert names(tmp_path / "out") == ["b", "done"]


def test_a_folder_with_other_files_is_refused_and_kept(tmp_path):
    (tmp_path / "mine.txt").write_text("keep")
    with pytest.raises(WorkbenchError, match="did not write"), whole(tmp_path, "done"):
        raise AssertionError("not reached")
    assert (tmp_path / "mine.txt").read_text() == "keep"


def test_a_file_in_the_place_of_the_folder_is_refused(tmp_path):
    (tmp_path / "out").write_text("x")
    with pytest.raises(WorkbenchError, match="is a file"), whole(tmp_path / "out", "done"):
        raise AssertionError("not reached")


def test_what_a_killed_run_left_is_swept_and_a_living_one_is_left_alone(tmp_path):
    ended = subprocess.run([sys.executable, "-c", "import os; print(os.getpid())"], capture_output=True, text=True)
    dead, alive = (tmp_path / f".out{MARK}{pid}-x" for pid in (ended.stdout.strip(), os.getpid()))
    dead.mkdir(), alive.mkdir()
    with whole(tmp_path / "out", "done") as beside:
        (beside / "done").write_text("1")
    assert not dead.exists() and alive.exists()
