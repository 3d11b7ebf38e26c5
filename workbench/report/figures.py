"""The figures of the standard chapters. Each function returns SVG; what it shows is in its title."""

from collections.abc import Sequence

import numpy as np

from workbench.description.result import Equivalent
from workbench.identification.result import Series
from workbench.report import drawing, numbers
from workbench.report.drawing import AFTER, BEFORE, GRID, INK, MEASURED, MUTED, SERIES, STYLES, envelope
from workbench.report.wording import title as title_of
from workbench.residual.maps import BINS, borders
from workbench.tracing.result import CandidateScore

WITH, WITHOUT = {"color": AFTER, "linestyle": "-"}, {"color": BEFORE, "linestyle": (0, (4, 1.5))}
DENSE = 1500  # samples of an excerpt from which dashes would only look like noise
EACH = 20  # samples a bin in the mean, at least: of noise alone the bins' means hold one part of so many
LONGEST = 28  # letters of a candidate's name


def excerpt(title: str, before: Series, after: Series | None, window: slice, drive: str, effort: str) -> bytes:
    """Drive measured and predicted, and what each model leaves, over a window of one record."""
    t = before.time[window]
    factor, shown = numbers.prefixed(float(np.max(np.abs(before.measured[window]))), effort)
    small, fine = numbers.prefixed(float(np.max(np.abs(before.residual[window]))), effort)

    def draw(axes):
        top, bottom = axes
        top.plot(*envelope(t, before.measured[window] * factor), color=MEASURED, linewidth=3.2, label="measured")
        top.plot(*envelope(t, before.predicted[window] * factor), **WITHOUT, label="declared model")
        dense = {**WITHOUT, "linestyle": "-"} if t.size > DENSE else WITHOUT
        bottom.plot(*envelope(t, before.residual[window] * small), **dense, linewidth=0.9, label="declared model")
        if after is not None:
            top.plot(*envelope(t, after.predicted[window] * factor), **WITH, label="extended model")
            bottom.plot(*envelope(t, after.residual[window] * small), **WITH, linewidth=0.9, label="extended model")
        top.set_ylabel(numbers.label(drive, shown))
        bottom.set_ylabel(numbers.label("residual", fine))
        bottom.set_xlabel("time (s)")
        for a in axes:
            a.margins(x=0.01)
            a.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3)

    return drawing.svg(title, draw, rows=2, height=3.5, share=True)


def against(
    title: str, coordinates: Sequence[tuple], before: np.ndarray, after: np.ndarray | None, effort: str
) -> bytes:
    """Residual against coordinates (name, values, unit): median and the middle 80 % in bins, for each model."""
    small, fine = numbers.prefixed(float(np.quantile(np.abs(before), 0.99)), effort)

    def draw(axes):
        for a, (name, values, unit) in zip(axes, coordinates, strict=True):
            factor, shown = numbers.prefixed(float(np.quantile(np.abs(values), 0.99)), unit)
            models = [(before, WITHOUT, "declared model", "///")]
            if after is not None:
                models.append((after, WITH, "extended model", None))
            for residual, style, label, hatch in models:
                x, low, middle, high = bands(values * factor, residual * small)
                area = {"hatch": hatch, "edgecolor": style["color"]} if hatch else {"edgecolor": "none"}
                a.fill_between(x, low, high, facecolor=style["color"], alpha=0.22, linewidth=0, **area)
                a.plot(x, middle, **style, label=label)
            a.axhline(0, color=MUTED, linewidth=0.6)
            a.margins(x=0.01)
            a.set_xlabel(numbers.label(name, shown))
            a.set_ylabel(numbers.label("residual", fine))
            if len(models) > 1:
                a.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2)

    return drawing.svg(title, draw, rows=len(coordinates), height=0.35 + 1.6 * len(coordinates))


def bins(values: np.ndarray) -> np.ndarray:
    """Return the borders of bins that hold EACH samples in the mean, where these are few."""
    return borders(values, min(BINS, max(values.size // EACH, 2)))


def bands(values: np.ndarray, residual: np.ndarray, least: int = 8) -> tuple[np.ndarray, ...]:
    """Return (centre, 10 %, median, 90 %) of the residual in the bins that hold at least so many samples."""
    low, high = np.quantile(values, (0.002, 0.998))
    edges = bins(values[(values >= low) & (values <= high)])
    index = np.digitize(values, edges) - 1
    rows = []
    for k in range(edges.size - 1):
        inside = residual[index == k]
        if inside.size >= least:
            rows.append(((edges[k] + edges[k + 1]) / 2, *np.quantile(inside, (0.1, 0.5, 0.9))))
    return tuple(np.array(rows).reshape(-1, 4).T)


def ranking(title: str, candidates: Sequence[CandidateScore], added: Sequence[tuple[str, str]], share: float) -> bytes:
    """Held-out gain of the candidates, best on top, with one standard error. share: what a candidate must explain."""
    best = list(candidates)[::-1]
    y = np.arange(len(best))

    def draw(axes):
        (a,) = axes
        colours = [AFTER if (c.effect, c.at) in added else MEASURED for c in best]
        gains = 100 * np.array([max(c.gain, 0.0) for c in best])
        scatter = 100 * np.array([c.scatter for c in best])
        a.barh(
            y,
            gains,
            color=colours,
            height=0.62,
            xerr=scatter,
            error_kw={"ecolor": INK, "elinewidth": 0.9, "capsize": 2.2},
        )
        a.axvline(100 * share, color=BEFORE, linestyle=(0, (4, 1.5)), linewidth=1.0)
        twice = {c.effect for k, c in enumerate(best) if c.effect in [o.effect for o in best[:k]]}
        a.set_yticks(y, [_short(c, c.effect in twice) for c in best])
        a.set_xlim(0, max(400 * share, 1.05 * float(np.max(gains + scatter, initial=0.0))))
        a.set_xlabel("reduction of the held-out squared residual (%)")
        a.grid(False, axis="y")
        keys = _keys(any((c.effect, c.at) in added for c in best))
        a.figure.legend(handles=keys, loc="outside lower center", ncols=3)

    return drawing.svg(title, draw, height=1.1 + 0.2 * max(len(best), 2))


def _short(c: CandidateScore, twice: bool) -> str:
    """Return the name of a bar; twice: whether another one has it too, at another place."""
    name = title_of(c.effect) + (f" ({c.at})" if twice else "") + (" (freed)" if c.kind == "correction" else "")
    name = name if len(name) <= LONGEST else name[: LONGEST - 1] + "\u2026"
    return name.replace("$", r"\$")


def _keys(any_added: bool) -> list:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    keys = [Patch(color=AFTER, label="added to the model")] if any_added else []
    return [*keys, Patch(color=MEASURED, label="not added"), Line2D([], [], color=BEFORE, linestyle=(0, (4, 1.5)), linewidth=1.0, label="least share that counts")]  # fmt: skip


def description(title: str, curves: Sequence[tuple[str, Equivalent]], rotary: bool) -> bytes:
    """Equivalent stiffness and loss over amplitude, logarithmic where all values are positive."""
    unit = "N\u00b7m/rad" if rotary else "N/m"
    names = ("stiffness k\u2091", "loss c\u2091\u03c9")

    def draw(axes):
        for a, which, name in zip(axes, ("stiffness", "loss"), names, strict=True):
            values = [getattr(e, which) for _, e in curves]
            for k, ((label, e), v) in enumerate(zip(curves, values, strict=True)):
                a.plot(
                    e.amplitude,
                    v,
                    color=SERIES[k % len(SERIES)],
                    linestyle=STYLES[k % len(STYLES)],
                    label=label.replace("$", r"\$"),
                )
            a.set_xscale("log")
            drawing.decades(a.xaxis)
            if all(np.all(v > 0) for v in values) and values:
                a.set_yscale("log")
                drawing.decades(a.yaxis)
            a.set_ylabel(numbers.label(name, unit))
            a.grid(True, which="minor", axis="x", color=GRID, linewidth=0.25)
        axes[-1].set_xlabel(numbers.label("amplitude A", "rad" if rotary else "m"))
        if len(curves) > 1:
            axes[0].legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2)

    return drawing.svg(title, draw, rows=2, height=3.6, share=True)
