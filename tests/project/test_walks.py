"""The tool that counts ways through the code, on a tree whose ways are seen at a glance."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

TOOLS = Path(__file__).resolve().parents[2] / "tools"
FILES = {
    "workbench/base.py": "def low(x): return x\ndef unseen(x): return x\n",
    "workbench/middle.py": "from workbench.base import low\nclass Box:\n    def open(self): return low(self)\n"
    "def boxed(x) -> Box: return Box()\ndef plain(x): return 1\n",
    "workbench/top.py": "from workbench.middle import Box, boxed, plain\n"
    "def do(given, other):\n    box = boxed(given)\n    box.open()\n    plain(other)\n    return [plain(b) for b in (box,)]\n",
}


@pytest.fixture
def tools(monkeypatch):
    monkeypatch.syspath_prepend(str(TOOLS))
    import walking
    import walks

    return walking, walks


def test_a_value_and_what_is_computed_from_it_is_followed_and_nothing_else(tools):
    walking, walks = tools
    tree = walking.Tree({Path(name): ast.parse(text) for name, text in FILES.items()})
    walk = walks.walked(tree, "top", "do", "given", 9)
    assert [name for _, name in walk.path] == ["do", "boxed", "Box.open", "low", "plain"]
    assert walk.numbers() == (5, 3, 1, 2)  # from low, in base, back up to plain, in middle
    assert walks.walked(tree, "top", "do", "other", 9).path == [("workbench.top", "do"), ("workbench.middle", "plain")]
    assert len(walks.walked(tree, "top", "do", "given", 2).path) == 4


# Climbs back up the layers that each way had when it was last shortened; the way inside a trace may turn with its rules a little
MOST = {
    "folder to Record": 8,  # two of them to turn a model in the drive's own unit into N*m
    "campaign path to trace.json": 8,
    "Trace to report": 1,
    "plant to controllers": 6,
    "records inside trace()": 27,  # two of them to ask of rest what presliding would leave there, one whether a law bends a gap, one for spellings
}


def test_no_way_climbs_back_up_the_layers_more_often_than_it_did():
    done = subprocess.run([sys.executable, TOOLS / "walks.py"], capture_output=True, text=True, check=True)
    counts = {line[:28].strip(): line[28:].split() for line in done.stdout.splitlines()}
    assert counts.keys() == MOST.keys() and min(int(stays) for stays, *_ in counts.values()) > 10
    assert {way: int(n[4]) for way, n in counts.items() if int(n[4]) > MOST[way]} == {}
