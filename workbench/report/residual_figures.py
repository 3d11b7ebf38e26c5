"""The figures of where a residual lives. Each function returns SVG; what it shows is in its title."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.report import numbers
from workbench.report.drawing import AFTER, BEFORE, MEASURED, MUTED, decades, svg
from workbench.residual.maps import STROKE, TIME, Map
from workbench.residual.residual_maps import Residual, ResidualMaps
from workbench.residual.window import BACKWARD, DIRECTIONS, EITHER, FORWARD

ROW = 1.3  # inches of a row
HEAD = 0.95  # inches of title and legend
LIVES = "where it lives"
SPREAD = 2.0  # standard errors of a mean that are drawn
# Of a coordinate's bins, in a row without a sample, across which no curve is drawn. Of eleven axes three have more, all of a turn (0.19 to 0.25);
# with half of it four more have gaps where they hardly ever accelerate or slip, with twice one of the three has a line across
GAP = 0.1

Model = tuple[str, Residual, dict]


@dataclass(frozen=True)
class Shade:
    """What is shaded: spans (low, high) of a coordinate, SI, of speed where that is velocity; in graphs of one direction or of both.

    title: the finding of the figure in which it is.
    """

    coordinate: str
    spans: tuple[tuple[float, float], ...]
    direction: int
    title: str

    def over(self, coordinate: str, direction: int = EITHER) -> tuple[tuple[float, float], ...]:
        """Return the spans to be shaded in a graph over this coordinate, of this direction of motion."""
        if coordinate != self.coordinate or (EITHER not in (direction, self.direction) and direction != self.direction):
            return ()
        if coordinate == "velocity" and direction == BACKWARD:
            return tuple((-high, -low) for low, high in self.spans)
        return self.spans


def _models(w: ResidualMaps) -> list[Model]:
    """Return (label, residual, style) of each model."""
    found = [("declared model", w.before, {"color": BEFORE})]
    return found + ([("extended model", w.after, {"color": AFTER})] if w.after else [])


def _prefix(w: ResidualMaps, coordinate: str | None = None) -> tuple[float, str]:
    """Return (factor, unit) that suits the largest rms of all maps, or of those over one coordinate."""
    chosen = [m.rms for m in w.before.maps if m.coordinate == (coordinate or m.coordinate)]
    seen = (float(np.nanmax(r)) for r in chosen if np.isfinite(r).any())  # a bin that no sample falls into has no rms
    return numbers.prefixed(max(seen, default=0.0), w.unit)


def multiples(title: str, w: ResidualMaps, coordinates: Sequence[str], shade: Shade | None = None) -> bytes:
    """Mean and rms over each coordinate: a row a coordinate, backward motion on the left and forward on the right."""
    small, fine = _prefix(w)

    def draw(axes):
        for k, coordinate in enumerate(coordinates):
            for axis, direction in zip(axes[2 * k : 2 * k + 2], (BACKWARD, FORWARD), strict=True):
                for label, residual, style in _models(w):
                    m = next(m for m in residual.over(coordinate) if m.direction == direction)
                    _curve(axis, m, small, label, style)
                if shade:
                    shaded(
                        axis,
                        shade.over(coordinate, direction),
                        numbers.prefixed(float(np.max(np.abs(m.edges))), m.unit)[0],
                    )
                axis.axhline(0, color=MUTED, linewidth=0.6)
                axis.set_title(f"moving {DIRECTIONS[direction]}" if k == 0 else "", loc="left", fontweight="normal")
            axes[2 * k].set_ylabel(numbers.label("residual", fine))
        _legend(axes)

    return svg(title, draw, rows=len(coordinates), columns=2, height=HEAD + ROW * len(coordinates))


def _curve(axis, m: Map, small: float, label: str, style: dict) -> None:
    """Draw mean, its standard error and rms of one model over one coordinate."""
    factor, shown = numbers.prefixed(float(np.max(np.abs(m.edges))), m.unit)
    error = SPREAD * np.nan_to_num(m.error) * small
    x, mean, error, rms = _where_seen(m.count > 0, m.centre * factor, m.mean * small, error, m.rms * small)
    axis.fill_between(x, mean - error, mean + error, facecolor=style["color"], alpha=0.25, linewidth=0)
    axis.plot(x, mean, **style, label=f"mean, {label}")
    axis.plot(x, rms, ":", **style, linewidth=1.0, label=f"rms, {label}")
    axis.margins(x=0.01)
    if m.coordinate == STROKE:
        from matplotlib.ticker import NullLocator

        axis.set_xscale("log")
        axis.xaxis.set_minor_locator(NullLocator())
        decades(axis.xaxis)
    elif m.coordinate != "velocity":  # whose two ways lie on two sides of zero
        axis.set_xlim(*(factor * m.edges[[0, -1]]))
    axis.set_xlabel(numbers.label(m.coordinate, shown))


def _where_seen(seen: np.ndarray, *values: np.ndarray) -> list[np.ndarray]:
    """Return values (n,) where samples fall, `seen` (n,) of bool; NaN between two such places that lie more than GAP apart, across which a line
    would say what nobody measured: of a turn, the part where the axis never is."""
    cuts = 1 + np.flatnonzero(np.diff(np.flatnonzero(seen)) > GAP * seen.size)
    return [np.insert(x[seen], cuts, np.nan) for x in values]


def shaded(axis, spans: Sequence[tuple[float, float]], factor: float = 1.0) -> None:
    """Shade where lives what no effect explains. A moment is too short to be seen on a long record without its border."""
    for low, high in spans:
        axis.axvspan(factor * low, factor * high, color=MEASURED, alpha=0.4, linewidth=1.0, zorder=0.5, label=LIVES)


def _legend(axes) -> None:
    """Put one legend under the whole figure, with what is in any of its graphs."""
    known = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True):
            known.setdefault(label, handle)
    axes[0].figure.legend(known.values(), known.keys(), loc="outside lower center", ncols=2)


def over_time(title: str, w: ResidualMaps, shade: Shade | None = None) -> bytes:
    """Rms of each record over its time, a row a record."""
    small, fine = _prefix(w, TIME)
    rows = w.before.over(TIME)

    def draw(axes):
        for axis, m in zip(axes, rows, strict=True):
            for label, residual, style in _models(w):
                one = next(o for o in residual.over(TIME) if o.record == m.record)
                axis.stairs(one.rms * small, one.edges, **style, label=label)
            if shade:
                shaded(axis, [s for s in shade.over(TIME) if m.edges[0] < s[1] and s[0] < m.edges[-1]])
            axis.set_title(m.record.replace("$", r"\$"), loc="left", fontweight="normal")
            axis.set_ylabel(numbers.label("rms", fine))
            axis.set_ylim(bottom=0.0)
            axis.margins(x=0.01)
        axes[-1].set_xlabel("time (s)")
        _legend(axes)

    return svg(title, draw, rows=len(rows), height=HEAD + 1.15 * len(rows))


def spectra(title: str, w: ResidualMaps) -> bytes:
    """Density over frequency and amplitude over order, both logarithmic."""
    small, fine = _prefix(w)
    x = "rad" if w.rotary else "m"

    def draw(axes):
        for label, residual, style in _models(w):
            frequency, order = residual.spectra
            axes[0].semilogy(frequency.at, frequency.amplitude * small, **style, label=label)
            axes[1].loglog(order.at, order.amplitude * small, **style, linewidth=0.9)
        axes[0].set_xlabel("frequency (Hz)")
        axes[0].set_ylabel(numbers.label("density", f"{fine}/\u221aHz"))
        axes[1].set_xlabel(numbers.label("order", f"1/{x}"))
        axes[1].set_ylabel(numbers.label("amplitude", fine))
        for axis in (axes[0].yaxis, axes[1].yaxis, axes[1].xaxis):
            decades(axis)
        _legend(axes)

    return svg(title, draw, rows=2, height=4.2)
