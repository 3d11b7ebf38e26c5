"""How figures are drawn: matplotlib without its global state, and SVG that is the same bytes for the same numbers.

Text stays text, so that a figure can be searched and read aloud. Colours are told apart by colour-blind readers (Okabe
and Ito 2008) and lie apart in lightness; a page in dark mode swaps them by the style that is put into the SVG.
"""

import re
import warnings
from collections.abc import Callable
from html import escape
from io import BytesIO
from pathlib import Path
from textwrap import fill

import numpy as np

from workbench.finding import capital
from workbench.report import numbers
from workbench.report.plotted import marked
from workbench.report.wording import printable

INK, MUTED, GRID = "#1f2933", "#5b6672", "#d9dee4"
BEFORE, AFTER, MEASURED = "#d55e00", "#0b62a0", "#a6b0bb"
SERIES = (AFTER, BEFORE, "#117a54", "#a03b7e", INK, "#8c6d1f", "#6a51a3")
# Seven colours and five dashes: the first two traces that look alike are 35 apart.
STYLES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)))
DARK = {INK: "#e3e8ee", MUTED: "#a6b0bb", GRID: "#3a434e", MEASURED: "#687482", BEFORE: "#ff9c4a", AFTER: "#6bb6ff", "#117a54": "#52d09b", "#a03b7e": "#f096cf", "#8c6d1f": "#d9b44a", "#6a51a3": "#b9a3f0"}  # fmt: skip

WIDTH = 5.4  # inches: paper shows it a fifth larger, and on a telephone its type is still legible
BINS = 700  # of a long trace: about one per pixel
LETTERS = 64  # of a title's line: the bold letters of other fonts may be wider

SETTINGS = {
    "svg.fonttype": "none",
    "svg.hashsalt": "workbench",
    "font.family": ["DejaVu Sans"],
    "font.size": 8.2,
    "axes.titlesize": 8.2,
    "axes.labelsize": 8.2,
    "legend.fontsize": 7.8,
    "legend.frameon": False,
    "legend.borderaxespad": 0.2,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": MUTED,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.7,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "grid.color": GRID,
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.2,
    "hatch.linewidth": 0.6,
    "savefig.transparent": True,
}


def fonts() -> Path:
    """Return the folder of the fonts that matplotlib brings, with which Typst sets the text of figures too."""
    import matplotlib

    return Path(matplotlib.get_data_path(), "fonts", "ttf")


def started() -> None:
    """Load what every figure needs, before processes share them."""
    import matplotlib.backends.backend_svg
    import matplotlib.figure  # noqa: F401


def svg(
    title: str, draw: Callable, *, rows: int = 1, columns: int = 1, height: float = 2.6, share: str | bool = False
) -> bytes:
    """Return a figure under a title that says what is found. draw(axes): axes is a list, row by row.

    share: the axis of abscissae; side by side, graphs share their ordinate.
    """
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    title = capital(printable(title))
    with matplotlib.rc_context(), warnings.catch_warnings():
        # text stays text: a letter that this font lacks is drawn with another one where the figure is shown
        warnings.filterwarnings("ignore", "Glyph .* missing")
        # what a user has set for other drawings must not enter the bytes
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(SETTINGS)
        figure = Figure(figsize=(WIDTH, height), layout="constrained")
        FigureCanvasSVG(figure)
        axes = figure.subplots(
            rows, columns, squeeze=False, sharex=share, sharey="row" if columns > 1 else False
        ).ravel()
        draw(list(axes))
        figure.suptitle(fill(title, LETTERS), parse_math=False, x=0.008, ha="left", fontsize=8.9, fontweight="bold")
        figure.get_layout_engine().execute(figure)  # once, so that `marked` reads what is then saved
        figure.set_layout_engine(None)  # with any, one that does nothing too, all is drawn once more before it is saved
        plotted = marked(figure)
        out = BytesIO()
        figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    return _finished(out.getvalue().decode("utf-8"), title, plotted)


def dark() -> str:
    """Return the style that swaps colours in dark mode. It names no ancestor: a mark is drawn from a copy that has none."""
    return "".join(
        f'[style*="{role}: {light}"]{{{role}:{swapped} !important}}'
        for light, swapped in DARK.items()
        for role in ("fill", "stroke")
    )


def _finished(text: str, title: str, plotted: str) -> bytes:
    """Return the SVG with a title of its own, fonts to fall back on, colours for dark mode and what a page's script needs of
    it, and without its header."""
    start = text.index("<svg")
    text = re.sub(r"\s*<metadata>.*?</metadata>", "", text[start:], flags=re.DOTALL)
    text = text.replace("'DejaVu Sans'", "'DejaVu Sans', Verdana, sans-serif")
    # matplotlib leaves black text without a fill; all other colours are stated
    head = f"<title>{escape(title)}</title><style>@media screen and (prefers-color-scheme: dark){{{dark()}}}</style>"
    end = text.index(">") + 1
    return (text[: end - 1] + f' data-graphs="{escape(plotted)}">' + head + text[end:]).encode("utf-8")


def envelope(x: np.ndarray, y: np.ndarray, bins: int = BINS) -> tuple[np.ndarray, np.ndarray]:
    """Return a trace thinned to the least and the largest value of each bin, in their order; short ones stay whole."""
    if x.size <= 2 * bins:
        return x, y
    edges = np.linspace(0, x.size, bins + 1).astype(int)
    index = []
    for a, b in zip(edges[:-1], edges[1:], strict=True):
        low, high = a + int(np.argmin(y[a:b])), a + int(np.argmax(y[a:b]))
        index += sorted({low, high})
    return x[index], y[index]


def decades(axis) -> None:
    """Label the decades of a logarithmic axis "10⁻³", as text; where fewer than two are in sight, steps between them too."""
    from matplotlib.ticker import FuncFormatter

    def text(value, _):
        e = int(round(np.log10(value)))
        return {0: "1", 1: "10"}.get(e, f"10{str(e).translate(numbers.SUPERSCRIPT)}")

    def between(value, _):
        low, high = np.log10(axis.get_view_interval())
        seen = np.floor(high) - np.ceil(low) + 1
        e = int(np.floor(np.log10(value) + 1e-9))
        digit = float(f"{value / 10.0**e:.3g}")  # steps below a decade need not be whole
        shown = numbers.exact(value, 3) if -1 <= e <= 2 else f"{digit:g}·{text(10.0**e, None)}"
        return shown if seen < 1 or (seen < 2 and digit in (2, 5)) else ""

    axis.set_major_formatter(FuncFormatter(text))
    axis.set_minor_formatter(FuncFormatter(between))
