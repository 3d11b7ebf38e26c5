"""How a result shows itself in a notebook: its sentence, a table and a small drawing, as one piece of HTML.

A class hands its rows to `page` from `_repr_html_`. matplotlib is imported where something is drawn, and nowhere else.
"""

from base64 import b64encode
from collections.abc import Callable, Iterable, Sequence
from html import escape
from io import BytesIO

WIDTH, HEIGHT = 6.0, 2.4  # inches of a drawing
DOTS = 96  # an inch: a pixel of a page; a bitmap, since a record has more samples than a vector drawing should hold
MOST = 40  # rows of a table: more are counted, so that a long result does not fill the notebook


def _number(value: float) -> str:
    """Return a number as tables show it: four digits, a dash for none."""
    return "–" if value != value else f"{value:.4g}"


def _table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return an HTML table; numbers are set to the right."""
    rows = list(rows)
    body = ["".join(_cell(value) for value in row) for row in rows[:MOST]]
    if len(rows) > MOST:
        body.append(f'<td colspan="{len(head)}">and {len(rows) - MOST} more</td>')
    top = "".join(f"<th>{escape(name)}</th>" for name in head)
    return f"<table><thead><tr>{top}</tr></thead><tbody>{''.join(f'<tr>{row}</tr>' for row in body)}</tbody></table>"


def _cell(value: object) -> str:
    if isinstance(value, str):
        return f'<td style="text-align:left">{escape(value)}</td>'
    return f"<td>{_number(value)}</td>"


def _drawing(draw: Callable, title: str, *, rows: int = 1) -> str:
    """Return an HTML image of what draw(axes) draws; axes: a list of `rows` matplotlib axes with one abscissa."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with matplotlib.rc_context({"font.size": 8.0, "axes.grid": True, "grid.alpha": 0.4, "legend.frameon": False}):
        figure = Figure(figsize=(WIDTH, HEIGHT * rows), dpi=DOTS, layout="constrained")
        FigureCanvasAgg(figure)
        draw(list(figure.subplots(rows, squeeze=False, sharex=True).ravel()))
        out = BytesIO()
        figure.savefig(out, format="png")
    return f'<img alt="{escape(title)}" src="data:image/png;base64,{b64encode(out.getvalue()).decode()}">'


def page(
    sentence: str,
    head: Sequence[str],
    rows: Iterable[Sequence[object]],
    draw: Callable | None = None,
    *,
    graphs: int = 1,
) -> str:
    """Return the HTML of a result. draw(axes): its drawing of `graphs` graphs, one above the other."""
    shown = _drawing(draw, sentence, rows=graphs) if draw else ""
    return f"<div><p>{escape(sentence)}</p>{_table(head, rows)}{shown}</div>"
