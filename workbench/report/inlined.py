"""Drawings as part of a page: SVG that several may share one page, with text that can be selected and names for the script."""

import re
from html import escape

DRAWING = re.compile(r'<div data-figure="([a-z0-9_]+)" class="drawing"></div>')
TRIM = re.compile(r"(?<=\.\d{2})\d+")  # a hundredth of a pixel is enough on a page


def inlined(page: str, figures: dict[str, bytes], alts: dict[str, str]) -> str:
    """Return the page with each drawing in its place. figures: file name -> SVG. alts: name -> what it shows."""
    return DRAWING.sub(lambda m: _element(figures[f"{m[1]}.svg"].decode(), m[1], alts[m[1]]), page)


def _element(svg: str, name: str, alt: str) -> str:
    """Return one drawing as an element: ids are its own, only those that are referred to stay, its style is the page's."""
    svg = re.sub(r"<style.*?</style>|<title>.*?</title>|<defs>\s*</defs>|<!--.*?-->", "", svg, flags=re.DOTALL)
    svg = re.sub(r' xmlns(:xlink)?="[^"]*"| version="1.1"| transform="rotate\(-?0 [^)]*\)"', "", svg)
    svg = svg.replace("xlink:href", "href").replace("font-family: 'DejaVu Sans', Verdana, sans-serif; ", "")
    svg = re.sub(r"<defs>\s*</defs>", "", svg)
    used = set(re.findall(r'(?:url\(#|href="#)([^")]+)', svg))
    svg = re.sub(r' id="([^"]+)"', lambda m: _own(m[1], name, used), svg)
    svg = re.sub(r"(url\(#|href=\"#)([^\")]+)", rf"\g<1>{name}-\g<2>", svg)
    svg = re.sub(r" d=\"[^\"]*\"", lambda m: TRIM.sub("", m[0]).replace("\n", ""), svg)
    svg = re.sub(r">\s+<", "><", svg).strip()
    said = f' role="img" aria-label="{escape(alt)}"'
    svg = re.sub(r'(<svg[^>]*?) width="[^"]*" height="[^"]*"', lambda m: m[1] + said, svg, count=1)
    return f'<div class="drawing" role="group" tabindex="0" aria-label="Drawing {name.replace("_", " ")}">{svg}</div>'


def _own(identity: str, name: str, used: set[str]) -> str:
    """Return the attribute that stands for an id: a class for what the script looks for, an id for what is referred to."""
    kept = f' id="{name}-{identity}"' if identity in used else ""
    for pattern, said in (
        (r"plot-(\d+)", ' data-plot="{}"'),
        (r"trace-(\d+)-\d+", ' data-trace="{}"'),
        (r"(note)-.*", ' class="{}"'),
        (r"([xy]tick|legend)_\d+", ' class="{}"'),
        (r"(PathCollection)_\d+", ' class="marks"'),
    ):
        if m := re.fullmatch(pattern, identity):
            return kept + said.format(m[1])
    return kept
