"""What the declared model leaves, and what is left once the cause is known."""

from collections.abc import Sequence

import numpy as np

from workbench.identification.result import Fit, Series
from workbench.record import VALIDATION
from workbench.report import figures, numbers
from workbench.report.contents import Chapter, Figure, Paragraph, StudyResult
from workbench.report.dependence import keep, over_motion
from workbench.report.wording import named

REVERSALS = 4  # of the motion in the excerpt
SHORTEST = 400  # samples of the excerpt
STILL = 0.2  # of the velocity's rms


def residual(result: StudyResult) -> Chapter:
    """The residual in time, and against the coordinate that it follows."""
    trace = result.trace
    after = trace.extended
    names = _shown(trace.before)
    return Chapter("The residual before and after" if after else "The residual", (
        Paragraph(
            f"{_left(result, names)} A model is wrong where its residual is large: the measured drive less the drive that the model asks for on "
            "the measured motion, both behind the same filter."
        ),
        _in_time(result, trace.before, after, names),
        over_motion(result, trace.before, after, names),
    ))  # fmt: skip


def _left(result: StudyResult, names: Sequence[str]) -> str:
    """Say what share of the drive each model leaves on the record where the declared one errs most."""
    before, after = result.trace.before.nrmse, result.trace.after.nrmse
    name = max(names, key=lambda n: before[n])
    also = f", and the extended model {numbers.percent(after[name])}" if result.trace.causes else ""
    return f"On the record {name} the declared model leaves {numbers.percent(before[name])} of the measured {result.drive}{also}."


def _shown(fit: Fit) -> list[str]:
    """Return the validation records, which no parameter has seen; all where there are none."""
    return [n for n, s in fit.series.items() if s.role == VALIDATION] or list(fit.series)


def window(before: Series) -> slice:
    """Return the part, some reversals long, in which the declared model errs most."""
    inside = np.arange(before.time.size)[before.keep]
    r, v = np.zeros(before.time.size), before.velocity[inside]
    r[keep(before)] = before.residual[keep(before)]
    r = r[inside]
    moving = np.flatnonzero(np.abs(v) > STILL * np.sqrt(np.mean(v**2)))  # in dwells the sign of v is noise
    turns = moving[1:][np.diff(np.sign(v[moving])) != 0]
    between = float(np.median(np.diff(turns))) if turns.size > 3 else r.size / REVERSALS
    length = int(min(r.size, max(REVERSALS * between, SHORTEST)))
    total = np.concatenate(([0.0], np.cumsum(r**2)))
    first = int(np.argmax(total[length:] - total[:-length]))
    return slice(int(inside[first]), int(inside[first]) + length)


def _in_time(result: StudyResult, before: Fit, after: Fit | None, names: Sequence[str]) -> Figure:
    """Measured and predicted drive, and the residual, over an excerpt of one validation record."""
    name = max(names, key=lambda n: before.nrmse[n])
    series, better = before.series[name], after.series[name] if after else None
    part = window(series)
    effort = result.plant.effort
    left = series.squares.rms
    if better is None:
        heading = f"The declared model leaves {numbers.scaled(left, effort)} rms on the record {name}"
    else:
        factor, unit = numbers.prefixed(left, effort)
        added = named(result.trace.causes)
        heading = (
            f"Residual falls from {numbers.number(left * factor)} to {numbers.number(better.squares.rms * factor)} {unit} rms once "
            f"{added} {'is' if len(result.trace.causes) == 1 else 'are'} added"
        )
    start, end = series.time[part][[0, -1]]
    role = f"the {series.role} record {name}"
    caption = (
        f"Top: {result.drive} of {role}, measured and predicted. Bottom: what is left. The {numbers.number(end - start)} s "
        "are those in which the declared model errs most; the rms values are of the whole record"
        f"{'' if series.counts is None else ', without the samples at which the axis sticks or the log has a gap'}."
    )
    alt = f"Two graphs over time, of {result.drive} and of the residual, for {role}. {heading}."
    draw = lambda: figures.excerpt(heading, series, better, part, result.drive, effort)  # noqa: E731
    return Figure("residual_in_time", draw, caption, alt)
