"""A page in a headless browser: what a script finds in it once it has loaded, at a width, light or dark."""

import html
import json
import re
import resource
import shutil
import subprocess
from pathlib import Path

import pytest

NO_BROWSER = "no browser here"
NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
FRAME = """<!doctype html><html lang="en"><head><meta charset="utf-8"><title>frame</title></head><body style="margin:0">
<iframe id="page" title="page" srcdoc="{source}" style="border:0;width:{width}px;height:900px"></iframe>
<pre id="found"></pre><script>
document.getElementById("page").addEventListener("load", async (event) => {{
  const frame = event.target.contentWindow;
  const found = document.getElementById("found");
  try {{ found.textContent = JSON.stringify(await frame.eval("(async () => {{" + {script} + "}})()")); }}
  catch (error) {{ found.textContent = JSON.stringify({{ error: String(error) }}); }}
}});
</script></body></html>
"""


def browser() -> str:
    """Return the path of a browser; a test skips where there is none."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        pytest.skip(NO_BROWSER)
    return found


def ran(page: Path, script: str, folder: Path, width: int = 1400, dark: bool = False, scripts: bool = True):
    """Return what `script` (the body of an async function, run inside the page) returns.

    The page stands in a frame, so that it may be narrower than a browser's window. scripts: whether its own may run.
    """
    source = page.read_text(encoding="utf-8")
    if not scripts:
        source = re.sub(r"<script>.*?</script>", "", source, flags=re.DOTALL)
    if dark:  # the page's own rules for a reader who prefers dark, as that reader has them
        source = source.replace("(prefers-color-scheme: dark)", "(min-width: 1px)")
    place = folder / f"frame-{width}-{int(dark)}.html"
    place.write_text(
        FRAME.format(source=html.escape(source), width=width, script=json.dumps(script).replace("</", "<\\/")),
        encoding="utf-8",
    )
    return loaded(place, folder)


def command(folder: Path, *rest: str) -> list[str]:
    return [
        browser(), "--headless", "--no-sandbox", "--disable-gpu", "--window-size=1500,1000",
        f"--user-data-dir={folder / 'profile'}", "--host-resolver-rules=MAP * ~NOTFOUND", *rest,
    ]  # fmt: skip


def loaded(place: Path, folder: Path):
    """Return what a frame's script left in it."""
    asked = command(folder, "--virtual-time-budget=20000", "--dump-dom", place.as_uri())
    done = subprocess.run(asked, capture_output=True, text=True, timeout=120)
    text = re.search(r'<pre id="found">(.*?)</pre>', done.stdout, flags=re.DOTALL)
    assert text and text[1], done.stderr[-2000:]
    return json.loads(html.unescape(text[1]))


def opened(page: Path, folder: Path) -> float:
    """Return the seconds of a processor that opening a page takes, the browser's start included."""

    def spent() -> float:
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime

    before = spent()
    subprocess.run(command(folder, "--dump-dom", page.as_uri()), capture_output=True, timeout=120)
    return spent() - before
