"""What the tests of readers have in common: a file that is written, the sentence that refuses it, a library that is not there."""

import importlib

import pytest

from workbench.errors import WorkbenchError
from workbench.readers import read


def write(folder, content, name="run.csv"):
    path = folder / name
    path.write_bytes(content)
    return path


def sentence_of(path, columns):
    """Return the one sentence by which reading these columns is refused, behind the path that it begins with."""
    with pytest.raises(WorkbenchError) as caught:
        read(path, columns)
    sentence = str(caught.value)
    assert sentence.startswith(str(path)) and sentence[-1] in ".?" and "\n" not in sentence, sentence
    return sentence.removeprefix(str(path))


def take_away(monkeypatch, module):
    """Let a module be one that is not installed."""
    there = importlib.import_module

    def absent(wanted):
        if wanted == module:
            raise ImportError(wanted)
        return there(wanted)

    monkeypatch.setattr(importlib, "import_module", absent)
