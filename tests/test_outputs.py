"""Outputs appear whole or not at all."""

import errno
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from workbench import outputs
from workbench.errors import WorkbenchError
from workbench.outputs import MARK, whole

HERE = Path(__file__).resolve().parent


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


def written(place, content):
    with whole(place, "done") as beside:
        (beside / "part").mkdir()
        (beside / "part" / "a.txt").write_text(content)
        (beside / "done").write_text(content)


def test_a_link_is_followed_and_stays_a_link(tmp_path):
    (tmp_path / "target").mkdir()
    (tmp_path / "lnk").symlink_to(tmp_path / "target")
    for content in ("first", "second"):
        written(tmp_path / "lnk", content)
    assert (tmp_path / "lnk").is_symlink() and (tmp_path / "target" / "done").read_text() == "second"
    assert names(tmp_path) == ["lnk", "target"] and names(tmp_path / "target") == ["done", "part"]


@pytest.fixture
def mounted(tmp_path, monkeypatch):
    """A folder that behaves as a mount point does: it can be neither renamed nor renamed over (EBUSY)."""
    place, rename = tmp_path / "mount", os.rename
    place.mkdir()

    def busy(a, b):
        if place in (Path(a), Path(b)):
            raise OSError(errno.EBUSY, "Device or resource busy", str(a))
        rename(a, b)

    monkeypatch.setattr(os, "rename", busy)
    monkeypatch.setattr(os.path, "ismount", lambda p: Path(p) == place)
    return place


def test_a_mount_point_is_written_inside_and_replaced(mounted):
    for content in ("first", "second"):
        written(mounted, content)
        assert (mounted / "part" / "a.txt").read_text() == content
    assert names(mounted) == ["done", "part"] and names(mounted.parent) == ["mount"]


def test_a_failure_at_any_move_into_a_mount_point_leaves_the_old_output(mounted, monkeypatch):
    written(mounted, "first")
    rename = os.rename
    for failing in range(5):
        left = [failing]

        def full(a, b, left=left):
            left[0] -= 1
            if left[0] == -1:
                raise OSError(errno.ENOSPC, "No space left on device", str(b))
            rename(a, b)

        monkeypatch.setattr(os, "rename", full)
        with pytest.raises(WorkbenchError, match="No space left on device"):
            written(mounted, "second")
        assert (mounted / "done").read_text() == (mounted / "part" / "a.txt").read_text() == "first"
        assert names(mounted) == ["done", "part"]


KILLED = """
import os, signal, sys
sys.path.insert(0, {tests!r})
from pathlib import Path
from workbench import outputs
from test_outputs import written
rename, left, place = os.rename, [{at}], Path({place!r})
def kill(a, b):
    left[0] -= 1
    if left[0] < 0:
        os.kill(os.getpid(), signal.SIGKILL)
    rename(a, b)
os.rename = kill
os.path.ismount = lambda p: {mount} and Path(p) == place
outputs._swapped = lambda one, other: False
written(place, "second")
"""


@pytest.mark.parametrize(("mount", "moments"), [(True, (0, 1, 2, 3, 4)), (False, (1, 2))])
def test_a_run_killed_while_it_replaces_an_output_loses_nothing(tmp_path, mount, moments):
    for at in moments:
        place = tmp_path / f"out{at}"
        written(place, "first")
        code = KILLED.format(tests=str(HERE), at=at, place=str(place), mount=mount)
        ended = subprocess.run([sys.executable, "-c", code], capture_output=True)
        assert ended.returncode == -9, ended.stderr
        outputs.replaceable(place, "done")
        assert (place / "done").read_text() == (place / "part" / "a.txt").read_text() == "first"
        assert names(place) == ["done", "part"] and names(tmp_path) == [place.name]
        shutil.rmtree(place)
    assert names(tmp_path) == []


def test_an_output_is_there_at_every_moment_of_its_replacement(tmp_path, monkeypatch):
    written(tmp_path / "out", "first")
    gone = []
    monkeypatch.setattr(shutil, "rmtree", lambda p, ignore_errors: gone.append((tmp_path / "out" / "done").read_text()))
    monkeypatch.setattr(os, "rename", refused := lambda a, b: (_ for _ in ()).throw(OSError(errno.ENOTEMPTY, "", "")))
    if not outputs._swapped(tmp_path / "out", tmp_path / "out"):
        return
    written(tmp_path / "out", "second")
    assert gone == ["second"] and refused


@pytest.mark.parametrize("name", ["x" * 300, "a\0b", "file/below"])
def test_a_place_that_cannot_be_is_refused_before_anything_is_computed(tmp_path, name):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(WorkbenchError, match="cannot be written|is a file"):
        outputs.replaceable(tmp_path / name, "done")
    assert names(tmp_path) == ["file"]


def test_a_folder_with_a_long_name_is_written(tmp_path):
    for content in ("first", "second"):
        written(tmp_path / ("ü" * 127), content)
    assert names(tmp_path) == ["ü" * 127]


def test_a_folder_that_may_not_be_written_is_refused_before_anything_is_computed(tmp_path, monkeypatch):
    def refused(**_):
        raise PermissionError(errno.EACCES, "Permission denied", str(tmp_path / "ro"))

    monkeypatch.setattr(outputs.tempfile, "mkdtemp", refused)  # also where root runs the tests, who may write anywhere
    with pytest.raises(WorkbenchError, match=r"Permission denied .*name another folder"):
        outputs.replaceable(tmp_path / "ro" / "out", "done")


def test_a_full_disk_is_one_sentence_and_the_old_output_stands(tmp_path):
    """A limit on the size of files takes the place of a disk that is full."""
    written(tmp_path / "out", "first")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(WorkbenchError, match=r"out cannot be written: File too large.*is as it was"):
            written(tmp_path / "out", "x" * 5000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert (tmp_path / "out" / "done").read_text() == "first" and names(tmp_path) == ["out"]


def test_two_that_write_one_place_at_once_leave_one_whole_output(tmp_path):
    code = (
        f"import sys; sys.path.insert(0, {str(HERE)!r}); from pathlib import Path; from test_outputs import written\n"
    )
    code += f"for k in range(100): written(Path({str(tmp_path / 'out')!r}), sys.argv[1])"
    both = [subprocess.Popen([sys.executable, "-c", code, word], stderr=subprocess.PIPE) for word in ("a", "b")]
    said = [b.communicate()[1] for b in both]
    assert [b.returncode for b in both] == [0, 0], said
    assert (tmp_path / "out" / "done").read_text() == (tmp_path / "out" / "part" / "a.txt").read_text()
    assert names(tmp_path) == ["out"]
