"""The chapter on axes that differ: both perspectives, what may be said of axes yet to be built, and what moves the error."""

import numpy as np

from workbench.report import numbers
from workbench.report.contents import Chapter, Heading, Items, Paragraph, Table
from workbench.report.robustness_figures import (
    beyond_figure,
    displacement,
    influence_figure,
    perspectives_figure,
    varied,
    worst_figure,
)
from workbench.robustness.distribution import FIXED, NORMAL, UNIFORM
from workbench.robustness.perspective import share_beyond_worst
from workbench.robustness.result import Series
from workbench.robustness.wording import ranking, statement
from workbench.robustness.worst import FILE

METRICS = {"final_error": "a final error", "time_1pct": "a 1 % time", "overshoot": "an overshoot"}


def chapter(found: Series) -> Chapter:
    """The whole chapter."""
    first = next(iter(found.columns))
    best = min(found.columns, key=lambda n: found.of_draws[n].maximum)
    return Chapter(
        "On axes that differ",
        (
            Paragraph(
                f"Of all controllers {best} leaves the least on the worst of the axes that were drawn. No two axes of a series are "
                "alike. The controllers, tuned once, are run on axes whose inertia and friction "
                f"are off on a grid, and on {numbers.count(found.cases.count)} axes drawn independently from the "
                "distributions below. A controller is robust in the first perspective when its largest error is small, in "
                "the second when its errors differ little; the two can disagree, so both are applied."
            ),
            _varied_table(found),
            Heading("Both perspectives"),
            perspectives_figure(found),
            _perspectives_table(found),
            Items(tuple(f.sentence for f in _rankings(found))),
            Heading("Axes yet to be built"),
            beyond_figure(found),
            Items(_statements(found)),
            Heading("Which parameter moves the error"),
            influence_figure(found, first),
            _influence_table(found),
            Heading("The worst axes"),
            worst_figure(found),
            _worst_table(found),
            Paragraph(
                f"robustness/{FILE} holds the exact draws of these axes: the command workbench replay runs one again, to the same "
                "bits, and draws its motion. robustness/draws.csv holds every draw."
            ),
        ),
    )


def _rankings(found: Series):
    unit = displacement(found)
    return ranking(found.of_grid, found.grid.title, unit) + ranking(found.of_draws, found.title, unit)


def _varied_table(found: Series) -> Table:
    """What is drawn, and from what."""
    rows = []
    for v in found.cases.varied:
        d, unit = v.distribution, numbers.unit(v.unit)
        span = f"{numbers.number(d.low)} to {numbers.number(d.high)}"
        text = {
            FIXED: numbers.number(d.low),
            NORMAL: f"normal, {numbers.number(d.mean)} ± {numbers.number(d.deviation)}, within {span}",
            UNIFORM: f"uniform, {span}",
        }.get(d.kind, f"uniform in the logarithm, {span}")
        rows.append((varied(v.name), text, "of nominal" if _of_nominal(v) else unit))
    return Table(("what differs", "distribution", "unit"), tuple(rows), f"Drawn with seed {found.seed}.", "lpl")


def _of_nominal(v) -> bool:
    """Whether what varies is a factor on its nominal value."""
    return v.relative or v.name in ("inertia", "friction")


def _error(value: float) -> str:
    return numbers.number(value, 2) if np.isfinite(value) else "never at rest"


def _perspectives_table(found: Series) -> Table:
    """Both perspectives of every controller, on the grid and over the draws."""
    unit = numbers.unit(displacement(found))
    rows = []
    for name in found.columns:
        g, d = found.of_grid[name], found.of_draws[name]
        time = float(found.grid.times[name].max())
        rows.append(
            (
                name, _error(g.maximum), _error(g.spread), numbers.scaled(time, "s", 4) if np.isfinite(time) else "never",
                _error(d.median), _error(d.high), _error(d.maximum), _error(d.spread),
            )
        )  # fmt: skip
    columns = (
        "controller", "grid: largest", "grid: spread", "grid: 1 % time", "draws: median", "99 %", "largest", "spread",
    )  # fmt: skip
    return Table(columns, tuple(rows), f"Final errors in {unit}: both perspectives.", "lrrrrrrr")


def _statements(found: Series) -> tuple[str, ...]:
    """Clopper-Pearson statements, each by itself, and what the worst draw bounds."""
    units = {"final_error": displacement(found), "time_1pct": "s", "overshoot": "1"}
    said = [
        f"Under {name}, {statement(share, f'{METRICS[metric]} of {numbers.scaled(share.limit, units[metric])}')}."
        for name, shares in found.shares.items()
        for metric, share in shares.items()
    ]
    p = share_beyond_worst(found.cases, found.confidence)
    said.append(
        f"Of all axes at most {numbers.percent(p)} exceed the largest of {numbers.count(found.cases.count)} independent "
        f"draws, with {numbers.percent(found.confidence)} confidence, whatever it is."
    )
    return (*said, "Each of these statements holds with its confidence by itself, not all of them together.")


def _influence_table(found: Series) -> Table:
    """Rank correlation with its standard error, every controller."""
    each = {n: {i.name: i for i in of} for n, of in found.influences.items()}
    names = list(dict.fromkeys(i.name for of in found.influences.values() for i in of))
    rows = [
        (varied(v), *(numbers.plus_minus(of[v].correlation, of[v].correlation_error, 1) for of in each.values()))
        for v in names
    ]
    caption = "Spearman's rank correlation of parameter and final error, ± its standard error by the jackknife."
    return Table(("parameter", *each), tuple(rows), caption, "l" + "r" * len(each))


def _worst_table(found: Series) -> Table:
    """The worst draw of each controller."""
    cases = [next(c for c in found.worst if c.controller == n) for n in found.columns]
    names = found.cases.names
    units = {v.name: "of nominal" if _of_nominal(v) else numbers.unit(v.unit) for v in found.cases.varied}
    rows = [
        (varied(v), *(numbers.number(float(c.values[i])) for c in cases), units[v]) for i, v in enumerate(names)
    ]  # fmt: skip
    rows.append(("final error", *(_error(c.metrics["final_error"]) for c in cases), numbers.unit(displacement(found))))
    rows.append(("draw", *(str(c.number) for c in cases), ""))
    return Table(
        ("what differs", *(c.controller for c in cases), "unit"),
        tuple(rows),
        "The worst axis of each.",
        "l" + "r" * len(cases) + "l",
    )
