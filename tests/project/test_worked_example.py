"""The page that adds an effect does what it shows: its blocks are run as one program, in an interpreter of its own."""

import re
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs" / "a-new-effect.md"
BLOCK = re.compile(r"^```(python|text)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def program(blocks: list[tuple[str, str]]) -> str:
    """The blocks of Python, one after another; what follows a block as text is printed between two marks."""
    return "\n".join(text if kind == "python" else "print('-' * 3)" for kind, text in blocks)


def test_the_worked_example_prints_what_the_page_shows():
    blocks = BLOCK.findall(PAGE.read_text(encoding="utf-8"))
    assert [kind for kind, _ in blocks].count("python") == 6
    code = program(blocks)
    command = [sys.executable, "-W", "error", "-c", code]
    done = subprocess.run(command, cwd=PAGE.parent.parent, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    shown = "".join(f"{text}---\n" for kind, text in blocks if kind == "text")
    assert done.stdout == shown
