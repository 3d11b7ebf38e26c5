"""Write a report: chapters become data, and one Typst template makes both the page and the PDF of them.

Nothing of the moment or the machine enters: no date, no path, no random name; fonts come from Typst and matplotlib.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import fields
from pathlib import Path

from workbench.processes import shared
from workbench.report import drawing
from workbench.report.chapters import standard
from workbench.report.compiling import compiled
from workbench.report.contents import Block, Chapter, Figure, Marked, StudyResult
from workbench.report.inlined import inlined
from workbench.report.wording import printable

ATTACHED = ("results.json", "trace.json")  # whichever stands beside the report goes into the PDF


def write(result: StudyResult, folder: Path, stem: str = "report", figures: Mapping[str, bytes] | None = None) -> None:
    """Write report.html, report.pdf and figures/*.svg into an existing folder; the same bytes for the same result.

    stem: of the two files' names. figures: file name -> SVG of those that are drawn already.
    """
    chapters = standard(result)
    named, known = _figures(chapters), dict(figures or {})
    made = known | _drawn(named, known)
    figures = {n: made[n] for n in named}
    data = {
        "title": result.title,
        "name": result.name,
        "over": " \u00b7 ".join(
            (f"{result.kind} {result.name}", *(c for c in (result.campaign,) if c != result.title))
        ),
        "question": result.question,
        "campaign": result.campaign,
        "attached": next((n for n in ATTACHED if (folder / n).is_file()), ""),
        "chapters": [{"title": c.title, "blocks": [_as_data(b) for b in c.blocks]} for c in chapters],
    }
    (folder / "figures").mkdir(exist_ok=True)
    for name, svg in figures.items():
        (folder / "figures" / name).write_bytes(svg)
    beside = {data["attached"]: (folder / data["attached"]).read_bytes()} if data["attached"] else {}
    pages = compiled(_plain(data), figures | beside)
    alts = {b.name: printable(b.alt) for c in chapters for b in c.blocks if isinstance(b, Figure)}
    pages["html"] = inlined(pages["html"].decode("utf-8"), figures, alts).encode("utf-8")
    for ending, content in pages.items():
        (folder / f"{stem}.{ending}").write_bytes(content)


def drawn(result: StudyResult, beside: StudyResult | None = None) -> dict[str, bytes]:
    """Return file name -> SVG of every figure of a result, or of those that another one, which lacks something yet, has not."""
    return _drawn(_figures(standard(result)), _figures(standard(beside)) if beside else ())


def _figures(chapters: Sequence[Chapter]) -> dict[str, Figure]:
    """Return file name -> figure of every one in the chapters."""
    figures = [b for c in chapters for b in c.blocks if isinstance(b, Figure)]
    names = [f"{f.name}.svg" for f in figures]
    if twice := next((f.name for f, n in zip(figures, names, strict=True) if names.count(n) > 1), None):
        raise ValueError(f"Two figures of the report are named '{twice}'.")
    return dict(zip(names, figures, strict=True))


def _drawn(figures: Mapping[str, Figure], but: Collection[str]) -> dict[str, bytes]:
    """Return file name -> SVG of figures but of these names."""
    left = {n: f for n, f in figures.items() if n not in but}
    drawing.started()
    return dict(zip(left, shared(lambda f: f.svg() if callable(f.svg) else f.svg, [*left.values()]), strict=True))


def _as_data(block: Block) -> dict:
    """Return a block as JSON data for the template; a figure names its file."""
    data = {f.name: getattr(block, f.name) for f in fields(block)}
    if isinstance(block, Figure):
        data["svg"] = f"{block.name}.svg"
    return {"kind": type(block).__name__.lower(), **data}


def _plain(value):
    """Return data as JSON holds it: every string printable, marked text as an object."""
    if isinstance(value, bool):
        return value
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, Marked):
        return {"text": printable(value.text), "tone": value.tone}
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    return [_plain(v) for v in value]
