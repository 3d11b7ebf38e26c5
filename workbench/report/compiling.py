"""From a report's data to the page and the paper, by one Typst template."""

import json
from contextlib import suppress
from functools import partial
from importlib.resources import files
from itertools import chain
from pathlib import Path

from workbench import outputs
from workbench.report import drawing

TEMPLATE = ("report.typ", "report.css", "report.js")
STANDARDS = ["a-3a", "ua-1"]  # archived with its structure; readable by a screen reader
EPOCH = 0  # PDF/A wants a date: the same one always
# Of type and figures on paper, the first with which no page stays nearly empty. A few per cent are not seen; where none of them
# mends it, the first stands.
TIGHTNESS = (1.0, 0.985, 0.97, 0.955, 1.015, 0.94)
TOP, HEIGHT = 68.0, 712.0  # points of an A4 page: its upper margin, and what lies between the margins
LEAST = 0.34  # of that height, that is used on every page


def compiled(data: dict, beside: dict[str, bytes]) -> dict[str, bytes]:
    """Return "html" -> the page and "pdf" -> the paper. data: as JSON holds it. beside: name -> figure or other file."""
    with outputs.passing("report") as root:
        for name in TEMPLATE:
            (root / name).write_bytes(files("workbench.report").joinpath(name).read_bytes())
        with (root / "report.css").open("a") as style:
            style.write(f"@media screen and (prefers-color-scheme: dark) {{{drawing.dark()}}}\n")
        for name, content in beside.items():
            (root / name).write_bytes(content)
        (root / "report.json").write_text(json.dumps(data), encoding="utf-8")
        return {"html": _one(root, "html"), "pdf": _paper(root)}


def _paper(root: Path) -> bytes:
    """Return the PDF, with floating figures if that may be: where one comes to lie within a list that goes over a page's end, its
    structure is no list's any more, and the compiler refuses it."""
    import typst

    made = partial(_one, root, "pdf", pdf_standards=STANDARDS)
    for tight in chain((t for t in TIGHTNESS if emptiest(_ends(root, t)) >= LEAST), TIGHTNESS):
        with suppress(typst.TypstError):
            return made(tight)
    return made(floating=False)


def _options(root: Path, kind: str, tight: float, floating: bool = True) -> dict:
    inputs = {"format": kind, "tightness": f"{tight:g}", "placement": "auto" if floating else "none"}
    return {
        "root": str(root), "sys_inputs": inputs, "font_paths": [str(drawing.fonts())],
        "ignore_system_fonts": True,
    }  # fmt: skip


def _one(root: Path, kind: str, tight: float = 1.0, floating: bool = True, **more) -> bytes:
    """Compile one kind. With warnings, so that "HTML export is under development" is not printed on every run."""
    import typst

    known = _options(root, kind, tight, floating)
    made, _ = typst.compile_with_warnings(str(root / TEMPLATE[0]), format=kind, timestamp=EPOCH, **known, **more)
    return made


def _ends(root: Path, tight: float) -> list[tuple[int, float]]:
    """Return (page, points from its top) of the end of each block on paper."""
    import typst

    ask = partial(typst.query, str(root / TEMPLATE[0]), "<end>", field="value", **_options(root, "pdf", tight))
    return [(int(e["page"]), float(e["y"])) for e in json.loads(ask())]


def emptiest(ends: list[tuple[int, float]]) -> float:
    """Return the share of its height that the emptiest page uses; one on which no block ends is full."""
    lowest: dict[int, float] = {}
    for page, y in ends:
        lowest[page] = max(lowest.get(page, 0.0), y)
    return min(((y - TOP) / HEIGHT for y in lowest.values()), default=1.0)
