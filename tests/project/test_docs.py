"""The README and the tutorial: every command in them is run, and what they quote of its output is what it says.

A command of make is run with --dry-run, since a test that runs the tests would not end.
"""

import json
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from itertools import takewhile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = {"README.md": ROOT / "README.md", "tutorial": ROOT / "docs" / "tutorial.md"}
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(page: str | Path) -> list[tuple[str, str]]:
    """Return (language, text) of the fenced blocks of a page; what is fenced without a language is taken for commands."""
    path = page if isinstance(page, Path) else PAGES[page]
    return [(kind or "sh", text) for kind, text in BLOCK.findall(path.read_text(encoding="utf-8"))]


def commands(text: str) -> list[str]:
    return [line.partition(" #")[0].strip() for line in text.splitlines() if line.strip()]


@pytest.fixture
def place(tmp_path):
    """A folder with what a checkout has and these commands read; what they write stays in it."""
    shutil.copytree(ROOT / "docs" / "tutorial", tmp_path / "docs" / "tutorial")
    shutil.copytree(ROOT / "studies" / "harmonic_drive_axis", tmp_path / "studies" / "harmonic_drive_axis")
    return tmp_path


def run(command: str, place: Path) -> str:
    """Run one command as a shell would and return what it says on stdout."""
    words = shlex.split(command)
    settings = [*takewhile(lambda w: re.match(r"[A-Z_]+=", w), words)]
    words = words[len(settings) :]
    if words[0] == "cc":
        if shutil.which("cc") is None:
            return ""
    elif words[0] == "make":
        words[1:1] = ["--dry-run", "--no-print-directory", "-C", str(ROOT)]
    else:
        assert words[0] == ".venv/bin/workbench", f"this test does not know how to run '{command}'"
        words[0:1] = [sys.executable, "-c", "import sys; from workbench.cli import main; sys.exit(main())"]
    done = subprocess.run(words, cwd=place, capture_output=True, text=True, timeout=600)
    # the README does not edit the file in between, and so the check has to say that this is to be done
    waits = (
        " check " in f" {command} " and re.findall(r"^(\w.*?): ", done.stdout, re.MULTILINE) == ["assumed scale"] * 2
    )
    assert done.returncode == (1 if waits else 0), f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


def edit(campaign: Path, text: str) -> None:
    """Put the keys of a TOML block in the place of the same keys of the same tables in campaign.toml.

    A key of no table was commented.
    """
    content = campaign.read_text(encoding="utf-8")
    for line in filter(str.strip, text[: text.index("[")].splitlines()):
        key = line.split("=")[0].strip()
        content, count = re.subn(rf"^# {key} = .*$", lambda m, line=line: line, content, flags=re.MULTILINE)
        assert count == 1, key
    for table, lines in re.findall(r"^\[(.+?)\]\n((?:\w.*\n)+)", text, re.MULTILINE):
        for line in lines.splitlines():
            key = line.split("=")[0].strip()
            pattern = rf"(^\[{re.escape(table)}\](?:(?!^\[).*\n)*?)^{key} = .*$"
            content, count = re.subn(pattern, lambda m, line=line: m[1] + line, content, flags=re.MULTILINE)
            assert count == 1, f"[{table}] {key}"
    tomllib.loads(content)
    campaign.write_text(content, encoding="utf-8")


def advice(outputs: Path) -> str:
    """Return which controller to take, as the report's first page says it."""
    return json.loads((outputs / "results.json").read_text(encoding="utf-8"))["advice"] or ""


@pytest.mark.parametrize("page", PAGES)
def test_every_command_runs_and_says_what_is_quoted(page, place):
    said, ran = "", 0
    outputs = place / "reports" / "my_axis"
    for kind, text in blocks(page):
        if kind == "sh":
            for command in commands(text):
                said += run(command, place)
                ran += 1
        elif kind == "toml":
            edit(place / "studies" / "my_axis" / "campaign" / "campaign.toml", text)
        elif said and kind != "python":  # test_front.py runs that; what stands before the first command is a file
            told = said + (advice(outputs) if outputs.exists() else "")
            for line in filter(str.strip, text.splitlines()):
                assert line in told, f"'{line}' is not what the commands say:\n{told}"
    assert ran >= 3
    if page == "tutorial":
        digests = {re.search(r"[0-9a-f]{64}", p.read_text(encoding="utf-8"))[0] for p in outputs.glob("gains/*.h")}
        (digest,) = digests
        assert all(digest in (outputs / n).read_text(encoding="utf-8") for n in ("report.html", "results.json"))
        for named in re.findall(r"`(reports/[^`]+)`", PAGES[page].read_text(encoding="utf-8")):
            assert (place / named).exists(), named


OTHERS = [
    p for p in sorted((ROOT / "docs").rglob("*.md")) if p not in PAGES.values() and "\n```sh\n" in p.read_text("utf-8")
]


@pytest.mark.parametrize("page", OTHERS, ids=lambda p: p.name)
def test_the_commands_of_every_other_page_run_on_logs_of_their_names(page, place, monkeypatch):
    from benchmarks.trace import asked

    shutil.copy(ROOT / "docs" / "tutorial" / "excitation.csv", place / "run1.csv")
    shutil.copy(ROOT / "docs" / "tutorial" / "moves.csv", place / "run2.csv")
    for command in [c for kind, text in blocks(page) if kind == "sh" for c in commands(text)]:
        said = run(command, place)
        if "benchmarks.trace" in said:  # of a benchmark, which takes hours, its options
            monkeypatch.setattr(sys, "argv", shlex.split(said.partition("-m ")[2]))
            asked()


def test_the_first_result_takes_no_more_than_five_lines_and_ones_own_data_three_commands():
    first, own, *_ = (commands(text) for kind, text in blocks("README.md") if kind == "sh")
    assert len(first) <= 5 and any("trace" in c for c in first)
    assert [c.split()[1] for c in own] == ["new", "check", "run"]


def test_the_tutorial_begins_with_the_first_lines_of_its_log():
    kind, text = blocks("tutorial")[0]
    assert kind == "text" and (ROOT / "docs/tutorial/excitation.csv").read_text().startswith(text)


def test_the_pages_name_every_verb_and_no_file_that_is_not_there():
    from workbench.cli import VERBS

    readme = PAGES["README.md"].read_text(encoding="utf-8")
    assert not [verb for verb in VERBS if f"`{verb}`" not in readme]
    for page, path in PAGES.items():
        text = path.read_text(encoding="utf-8")
        for link in re.findall(r"\]\(([^)#:]+)\)", text):
            assert (path.parent / link).exists(), f"{page} links to '{link}'."


def test_the_page_of_types_is_made_of_the_code():
    command = [sys.executable, "tools/type_table.py"]
    made = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True, encoding="utf-8").stdout
    page = (ROOT / "docs" / "types.md").read_text(encoding="utf-8")
    assert page == made, "write it anew: python tools/type_table.py > docs/types.md"


def test_no_more_than_thirty_words_are_our_own_and_they_are_in_order():
    words = re.findall(r"^\| ([a-z].*?) \| ", (ROOT / "docs" / "glossary.md").read_text("utf-8"), re.MULTILINE)[1:]
    assert 20 <= len(words) <= 30 and words == sorted(words)


def test_the_architecture_is_a_map_of_two_thousand_words_at_most_whose_chapters_are_there():
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    assert len(text.split()) <= 2000
    chapters = set(re.findall(r"\]\((architecture/[\w-]+\.md)\)", text))
    assert chapters == {f"architecture/{p.name}" for p in (ROOT / "docs" / "architecture").glob("*.md")}
    for link in re.findall(r"\]\(([^)#:]+)\)", text):
        assert (ROOT / "docs" / link).exists(), link
