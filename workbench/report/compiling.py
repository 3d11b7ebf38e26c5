"""From a report's data to the page and the paper, by one Typst template."""

import json
from contextlib import suppress
from functools import cache, partial
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
        return {"html": _made(_compiler(root, "html"), "html"), "pdf": _paper(root)}


def _paper(root: Path) -> bytes:
    """Return the PDF, with floating figures if that may be: where one comes to lie within a list that goes over a page's end, its
    structure is no list's any more, and the compiler refuses it."""
    import typst

    compiler = cache(partial(_compiler, root, "pdf"))
    made = partial(_made, kind="pdf", pdf_standards=STANDARDS)
    for tight in chain((t for t in TIGHTNESS if emptiest(_ends(compiler(t))) >= LEAST), TIGHTNESS):
        with suppress(typst.TypstError):
            return made(compiler(tight))
    return made(_compiler(root, "pdf", floating=False))


def _compiler(root: Path, kind: str, tight: float = 1.0, floating: bool = True):
    """Return a compiler of the template. One that was asked where blocks end has set the text, and makes the paper in a quarter of the time."""
    import typst

    inputs = {"format": kind, "tightness": f"{tight:g}", "placement": "auto" if floating else "none"}
    return typst.Compiler(
        str(root / TEMPLATE[0]), root=str(root), sys_inputs=inputs, font_paths=[str(drawing.fonts())],
        ignore_system_fonts=True,
    )  # fmt: skip


def _made(compiler, kind: str, **more) -> bytes:
    """Compile one kind. With warnings, so that "HTML export is under development" is not printed on every run."""
    made, _ = compiler.compile_with_warnings(format=kind, timestamp=EPOCH, **more)
    return made


def _ends(compiler) -> list[tuple[int, float]]:
    """Return (page, points from its top) of the end of each block on paper."""
    return [(int(e["page"]), float(e["y"])) for e in json.loads(compiler.query("<end>", field="value"))]


def emptiest(ends: list[tuple[int, float]]) -> float:
    """Return the share of its height that the emptiest page uses; one on which no block ends is full."""
    lowest: dict[int, float] = {}
    for page, y in ends:
        lowest[page] = max(lowest.get(page, 0.0), y)
    return min(((y - TOP) / HEIGHT for y in lowest.values()), default=1.0)
