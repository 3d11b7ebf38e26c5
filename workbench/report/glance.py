"""The one figure of the first page: what the model errs by without and with what was found, and how good each controller is."""

from textwrap import fill

import numpy as np

from workbench.record import ROLES, VALIDATION
from workbench.report import numbers
from workbench.report.advice import Advice
from workbench.report.contents import Figure, StudyResult
from workbench.report.drawing import AFTER, BEFORE, MEASURED, decades, svg
from workbench.tracing.headline import UNSEEN

ROW = 0.24  # inches of a bar
BESIDE = 0.62  # of the lower graph's width: for what stands beside a mark
MOST = 5  # controllers that are drawn: with more the figure leaves the first page
WIDE = 26  # characters of a name in a line
LABELS = 6  # of the logarithmic scale, at most: more would touch


def glance(result: StudyResult) -> Figure:
    """Bars of the error on the validation record; with gains, the worst case of each controller beneath."""
    bars, advice = _errors(result), result.advice
    title = _heading(result)
    rows = 1 + (advice is not None)
    drawn = len(advice.rows[:MOST]) if advice else 0
    heights = [len(bars), *([1.3 * drawn] if advice else [])]

    def draw(axes):
        for axis in axes:
            axis.get_subplotspec().get_gridspec().set_height_ratios([h + 1.2 for h in heights])
            axis.grid(False, axis="y")
        _drawn(axes[0], bars, result.drive)
        if advice:
            _judged(axes[1], advice)

    caption = (
        f"Error of the predicted {result.drive} on the {_role(result)} records, in per cent of the measured {result.drive}. No model "
        "can err by less than encoder steps and noise leave; how much more is unavoidable is not known."
    )
    if advice:
        which = (
            f"the best {drawn} of {len(advice.rows)} controllers do"
            if len(advice.rows) > drawn
            else "each controller does"
        )
        caption += (
            f" Below: the worst that {which} over half to one and a half times inertia and friction, and when they are within "
            "1 % of the target."
        )
    said = "; ".join(f"{name}: {numbers.percent(value)}" for name, value, _ in bars)
    height = 0.75 + ROW * sum(heights) + 0.45 * (rows - 1)
    return Figure(
        "glance", lambda: svg(title, draw, rows=rows, height=height), caption, f"Bars. {title}. {said}.", fixed=True
    )


def _role(result: StudyResult) -> str:
    """Return the role whose records the figure is of: validation where there is any."""
    return VALIDATION if np.isfinite(result.trace.before.validation) else ROLES[0]


def _errors(result: StudyResult) -> list[tuple[str, float, str]]:
    """Return (name, error, colour) of the declared and the extended model, and the lower bound."""
    trace, of = result.trace, _role(result)
    found = [("declared model", float(getattr(trace.before, of)), BEFORE)]
    if trace.causes:
        found.append(("with what was found", float(getattr(trace.after, of)), AFTER))
    least = float(trace.floor.get(of, np.nan))
    return [*found, ("noise leaves at least", least, MEASURED)] if np.isfinite(least) and least > UNSEEN else found


def _heading(result: StudyResult) -> str:
    """Return what the figure shows in one sentence."""
    first, *rest = _errors(result)
    model = f"The model errs by {numbers.percent(first[1])}"
    if result.trace.causes:
        model += f", and by {numbers.percent(rest[0][1])} with what was found"
    return f"{model}; recommended is {result.advice.controller}" if result.advice else model


def _drawn(axis, bars, drive: str) -> None:
    """Draw the errors as bars with their values."""
    y = np.arange(len(bars))[::-1]
    values = [100.0 * v for _, v, _ in bars]
    axis.barh(y, values, color=[c for _, _, c in bars], height=0.62)
    for at, value in zip(y, values, strict=True):
        axis.text(value, at, f"\u2002{numbers.percent(value / 100.0)}", va="center", ha="left")
    axis.set_yticks(y, [n for n, _, _ in bars])
    axis.set_xlim(0.0, 1.14 * max(values) or 1.0)
    axis.set_xlabel(f"error of the predicted {drive} (%)")


def _judged(axis, advice: Advice) -> None:
    """Mark the worst error of each controller, the recommended one filled, with its worst time."""
    rows = advice.rows[:MOST]
    y = np.arange(len(rows))[::-1]
    errors = np.array([float(r["error_grid"]) for r in rows])
    seen = errors[np.isfinite(errors) & (errors > 0.0)]
    least, most = (float(np.min(seen)), float(np.max(seen))) if seen.size else (1e-6, 1e-6)
    for at, value, row in zip(y, errors, rows, strict=True):
        place = min(max(value, least), most) if np.isfinite(value) else most
        first = row["name"] == advice.controller
        axis.plot(place, at, "o", ms=6, color=AFTER, markerfacecolor=AFTER if first else "none")
        time = float(row["time_grid"])
        when = f"after {numbers.scaled(time, 's')}" if np.isfinite(time) else "never within 1 %"
        axis.text(place, at, f"\u2003{numbers.scaled(value, advice.displacement)}, {when}", va="center", ha="left")
    axis.set_xscale("log")
    span = (np.log10(most / least) + 0.4) / (1.0 - BESIDE)  # so that what stands beside the last mark is in sight
    axis.set_xlim(least / 1.8, least / 1.8 * 10.0**span)
    axis.set_ylim(-0.6, len(y) - 0.4)
    axis.set_yticks(y, [fill(str(r["name"]), WIDE) for r in rows])
    axis.set_xlabel(numbers.label("worst final error", numbers.unit(advice.displacement)))
    powers = np.arange(np.ceil(np.log10(least / 1.8)), np.log10(3.0 * most))
    if powers.size > 1:  # what stands beside the marks needs no scale beneath it
        axis.set_xticks(10.0 ** powers[:: -(-powers.size // LABELS)], minor=False)
        axis.minorticks_off()
    decades(axis.xaxis)
