"""What a page's script needs of a drawing: where its graphs lie, their scales, and which artists belong to one trace.

Positions in pixels of the drawing (72 an inch, downwards), as in the SVG. An artist's group id says its trace: the page turns
"trace-3-0" into a class, so that all artists of one label, and those of the same look without one, go on and off together.
"""

import json

from workbench.report import numbers

FIGURES = 6  # of a limit or a place: more than a page's pixels tell apart


def marked(figure) -> str:
    """Name the groups of a drawn figure's graphs and traces, and return what a script needs, as JSON."""
    axes = figure.axes
    labels = _named(axes)
    count = 0
    for k, axis in enumerate(axes):
        axis.set_gid(f"plot-{k}")
        for artist, key in _keyed(axis, labels):
            artist.set_gid(f"trace-{key}-{count}")
            count += 1
        for n, text in enumerate(axis.texts):
            text.set_gid(f"note-{k}-{n}")
    return json.dumps({"plots": [_graph(a, axes) for a in axes], "traces": labels}, ensure_ascii=False)


def _named(axes) -> list[str]:
    """Return the labels of all graphs, each once, in their order."""
    found = [text for axis in axes for text in axis.get_legend_handles_labels()[1]]
    return list(dict.fromkeys(found))


def _keyed(axis, labels: list[str]):
    """Yield (artist, number of its trace): its label's, else that of the trace which looks alike in the whole figure."""
    looks = {}
    for other in axis.figure.axes:
        for artist in (*other.lines, *other.collections, *other.patches):
            if artist.get_label() in labels:
                looks.setdefault(_look(artist), labels.index(artist.get_label()))
    for artist in (*axis.lines, *axis.collections, *axis.patches):
        key = labels.index(artist.get_label()) if artist.get_label() in labels else looks.get(_look(artist))
        if key is not None:
            yield artist, key


def _look(artist) -> tuple:
    """Return what tells a trace from another one: colour, and dashes and marks where it has any."""
    from matplotlib.colors import to_hex

    colour = artist.get_color() if hasattr(artist, "get_color") else artist.get_facecolor()
    if getattr(colour, "ndim", 1) == 2:  # a collection's colours, one a part
        colour = colour[0] if len(colour) else "none"
    marks = (artist.get_linestyle(), artist.get_marker()) if hasattr(artist, "get_marker") else ("-", "None")
    return (to_hex(colour), *map(str, marks))


def _graph(axis, axes) -> dict:
    """Return where a graph lies and how its scales run. shares: the first graph with the same scale, each way."""
    width, height = axis.figure.get_size_inches() * 72.0
    box = axis.get_position()
    place = [box.x0 * width, (1 - box.y1) * height, box.x1 * width, (1 - box.y0) * height]
    groups = (axis.get_shared_x_axes(), axis.get_shared_y_axes())
    return {
        "box": [round(float(v), 3) for v in place],
        "x": _scale(axis.xaxis),
        "y": _scale(axis.yaxis),
        "shares": [next(k for k, a in enumerate(axes) if a is axis or g.joined(a, axis)) for g in groups],
    }


def _scale(axis) -> dict:
    """Return limits, kind ("linear", "log", or "fixed" where names stand along it) and label of one axis."""
    from matplotlib.ticker import FixedLocator

    low, high = axis.get_view_interval()
    kind = "fixed" if isinstance(axis.get_major_locator(), FixedLocator) else axis.get_scale()
    shown = [t for t in axis.get_major_ticks() if t.label1.get_visible() and t.label1.get_text()]
    return {
        "limits": [float(f"{float(v):.{FIGURES}g}") for v in (low, high)],
        "kind": kind,
        "label": axis.get_label_text().replace(numbers.NARROW, " "),
        "named": bool(shown),
    }
