"""reports/index.html: every study with its headline, and links to what it wrote."""

import json
import os
import tempfile
from html import escape
from importlib.resources import files
from pathlib import Path

from workbench.report.wording import printable

FILE = "index.html"
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark"><title>Reports</title><style>{style}</style></head>
<body><header><h1>Reports</h1><p class="question">Every study that was run here, with what it found.</p></header><main>
{studies}
</main></body></html>
"""
STUDY = """<section><h2><a href="{name}/report.html">{title}</a></h2><p>{sentence}</p>{judged}
<p class="over"><a href="{name}/report.pdf">PDF of {name}</a> · <a href="{name}/results.json">numbers of {name}</a></p></section>"""


def write_index(folder: Path) -> Path:
    """Write index.html into the folder of reports, of all studies whose results lie there, by name; return its path."""
    studies = "\n".join(_entry(p.parent.name, _read(p)) for p in sorted(folder.glob("*/results.json")))
    style = files("workbench.report").joinpath("report.css").read_text(encoding="utf-8")
    content = PAGE.format(style=style, studies=studies or "<p>None yet.</p>")
    handle, beside = tempfile.mkstemp(prefix=f".{FILE}-", dir=folder)
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        file.write(content)
    os.chmod(beside, 0o644)
    os.replace(beside, folder / FILE)
    return folder / FILE


def _read(path: Path) -> dict:
    """Return a study's results; nothing where another run is just replacing them, or they are no results."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _entry(name: str, results: dict) -> str:
    """Return one study as HTML; nothing where it has no headline."""
    if "sentence" not in results:
        return ""
    checks = results.get("checks", [])
    failed = [c.get("words", c["name"]) for c in checks if not c["passed"]]
    judged = f"<p>Not reached: {_safe(', '.join(failed))}.</p>" if failed else ""
    more = results.get("advice", "")
    sentence = _safe(results["sentence"]) + (f"</p><p>{_safe(more)}" if more else "")
    return STUDY.format(name=escape(name), title=_safe(results.get("title", name)), sentence=sentence, judged=judged)


def _safe(text: str) -> str:
    return escape(printable(str(text)))
