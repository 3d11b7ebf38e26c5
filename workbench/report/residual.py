"""What the declared model leaves, and what is left once the cause is known."""

from collections.abc import Sequence

import numpy as np

from workbench.identify.result import Fit, Series
from workbench.record import VALIDATION
from workbench.report import figures, numbers
from workbench.report.contents import Chapter, Figure, Paragraph, StudyResult
from workbench.report.wording import listed, title

REVERSALS = 7  # of the motion in the excerpt
SHORTEST = 400  # samples of the excerpt
PORTIONS = 60  # bins over a coordinate
LEAST = 0.1  # share of the residual power from which a coordinate is said to explain it


def residual(result: StudyResult) -> Chapter:
    """The residual in time, and against the coordinate that it follows."""
    trace = result.trace
    after = trace.after if trace.causes else None
    names = shown(trace.before)
    return Chapter("The residual before and after" if after else "The residual", (
        Paragraph(
            "The residual is the measured drive less the drive that the model asks for on the measured motion, both behind "
            "the same filter. What can be read from it is where a model is wrong, not only how much."
        ),
        in_time(result, trace.before, after, names),
        over_motion(result, trace.before, after, names),
    ))  # fmt: skip


def shown(fit: Fit) -> list[str]:
    """Return the validation records, which no parameter has seen; all where there are none."""
    return [n for n, s in fit.series.items() if s.role == VALIDATION] or list(fit.series)


def keep(series: Series) -> np.ndarray:
    """Return the indices in which errors count."""
    return np.arange(series.time.size)[series.keep]


def window(before: Series) -> slice:
    """Return the part, some reversals long, in which the declared model errs most."""
    inside = keep(before)
    r, v = before.residual[inside], before.velocity[inside]
    turns = np.flatnonzero(np.diff(np.sign(v)) != 0)
    between = float(np.median(np.diff(turns))) if turns.size > 3 else r.size / REVERSALS
    length = int(min(r.size, max(REVERSALS * between, SHORTEST)))
    total = np.concatenate(([0.0], np.cumsum(r**2)))
    first = int(np.argmax(total[length:] - total[:-length]))
    return slice(int(inside[first]), int(inside[first]) + length)


def in_time(result: StudyResult, before: Fit, after: Fit | None, names: Sequence[str]) -> Figure:
    """Measured and predicted drive, and the residual, over an excerpt of one validation record."""
    name = max(names, key=lambda n: before.nrmse[n])
    series, better = before.series[name], after.series[name] if after else None
    part = window(series)
    effort = result.plant.effort
    left = _rms(series)
    if better is None:
        heading = f"The declared model leaves {numbers.scaled(left, effort)} rms of {name}"
    else:
        factor, unit = numbers.prefixed(left, effort)
        added = listed([title(c.effect) for c in result.trace.causes])
        heading = (
            f"Residual falls from {numbers.number(left * factor)} to {numbers.number(_rms(better) * factor)} {unit} rms once "
            f"{added} is added"
        )
    start, end = series.time[part][[0, -1]]
    role = f"the {series.role} record {name}"
    caption = (
        f"Top: {result.drive} of {role}, measured and predicted. Bottom: what is left. The {numbers.number(end - start)} s "
        "are those in which the declared model errs most; the rms values are of the whole record."
    )
    alt = f"Two graphs over time, of {result.drive} and of the residual, for {role}. {heading}."
    draw = lambda: figures.excerpt(heading, series, better, part, result.drive, effort)  # noqa: E731
    return Figure("residual_in_time", draw, caption, alt)


def over_motion(result: StudyResult, before: Fit, after: Fit | None, names: Sequence[str]) -> Figure:
    """The residual against velocity and position, the one that it follows more on top."""
    plant = result.plant
    left = _pooled(before, names, "residual")
    right = _pooled(after, names, "residual") if after else None
    coordinates = []
    for name, unit in (("velocity", f"{plant.displacement}/s"), ("position", plant.displacement)):
        values = _pooled(before, names, name)
        then = explained(values, right) if right is not None else float("nan")
        coordinates.append((explained(values, left), then, name, values, unit))
    coordinates.sort(key=lambda c: -c[0])
    share, then, name, *_ = coordinates[0]
    heading = f"{name.capitalize()} alone explains {numbers.percent(share)} of the residual power"
    if share < LEAST:
        heading = f"Neither velocity nor position explains the residual: {numbers.percent(share)} at most"
    elif right is not None:
        added = listed([title(c.effect) for c in result.trace.causes])
        heading += f"; with {added} added, {numbers.percent(then * _ratio(right, left))} of it is left to explain"
    caption = (
        f"Residual on {'all validation records' if len(names) > 1 else 'the record ' + names[0]} against {coordinates[0][2]} and "
        f"{coordinates[1][2]}, in {PORTIONS} bins: median (line) and the middle 80 % (area). What a coordinate explains is the "
        "power of the residual's mean over its bins."
    )
    others = f"{coordinates[1][2].capitalize()} explains {numbers.percent(coordinates[1][0])}."
    drawn = [(c[2], c[3], c[4]) for c in coordinates]
    draw = lambda: figures.against(heading, drawn, left, right, plant.effort)  # noqa: E731
    return Figure(
        "residual_over_motion", draw, f"{caption} {others}", f"Two graphs of the residual. {heading}. {others}"
    )


def explained(values: np.ndarray, residual: np.ndarray) -> float:
    """Return the share of the residual's power that is a function of these values, by means over bins."""
    edges = np.linspace(np.min(values), np.max(values), PORTIONS + 1)[1:-1]
    index = np.searchsorted(edges, values)
    count = np.bincount(index, minlength=PORTIONS)
    total = np.bincount(index, weights=residual, minlength=PORTIONS)
    power = float(residual @ residual)
    return float(np.sum(total**2 / np.maximum(count, 1))) / power if power > 0 else 0.0


def _pooled(fit: Fit, names: Sequence[str], which: str) -> np.ndarray:
    return np.concatenate([getattr(fit.series[n], which)[keep(fit.series[n])] for n in names])


def _ratio(after: np.ndarray, before: np.ndarray) -> float:
    power = float(before @ before)
    return float(after @ after) / power if power > 0 else 0.0


def _rms(series: Series) -> float:
    return float(np.sqrt(np.mean(series.residual[keep(series)] ** 2)))
