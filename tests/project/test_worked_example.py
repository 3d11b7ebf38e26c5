"""Pages that add something of one's own do what they show: the blocks of one are run as a program, in an interpreter of its own."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
BLOCK = re.compile(r"^```(python|text)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def program(blocks: list[tuple[str, str]]) -> str:
    """The blocks of Python, one after another; what follows a block as text is printed between two marks."""
    return "\n".join(text if kind == "python" else "print('-' * 3)" for kind, text in blocks)


@pytest.mark.parametrize(("page", "count"), [("a-new-effect.md", 6), ("a-new-part.md", 3)])
def test_a_page_prints_what_it_shows(page, count, tmp_path):
    blocks = BLOCK.findall((DOCS / page).read_text(encoding="utf-8"))
    assert [kind for kind, _ in blocks].count("python") == count
    code = program(blocks)
    command = [sys.executable, "-W", "error", "-c", code]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    shown = "".join(f"{text}---\n" for kind, text in blocks if kind == "text")
    assert done.stdout == shown
