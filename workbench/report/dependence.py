"""The residual against the coordinate that it follows: which physical effect it may come from is seen there."""

from collections.abc import Sequence

import numpy as np

from workbench.finding import capital
from workbench.identification.result import Fit, Series
from workbench.report import figures, numbers
from workbench.report.contents import Figure, StudyResult
from workbench.report.wording import named

LEAST = 0.1  # share of the residual power from which a coordinate is said to explain it
SHOWN = 2  # coordinates in the figure


def keep(series: Series) -> np.ndarray:
    """Return the indices in which errors count: of an axis that sticks, those at which it moves."""
    inside = np.arange(series.time.size)[series.keep]
    return inside if series.counts is None else inside[series.counts[inside]]


def coordinates(result: StudyResult, names: Sequence[str]) -> list[tuple[str, np.ndarray, str]]:
    """Return (name, values, unit) of what physical effects follow.

    Friction follows velocity, springs position, a wrong inertia acceleration, a delay or lag the rate of the drive, and a
    periodic cause the place within its period.
    """
    before, unit, effort = result.trace.before, result.plant.displacement, result.plant.effort
    position = _pooled(before, names, "position")
    found = [
        ("velocity", _pooled(before, names, "velocity"), f"{unit}/s"),
        ("position", position, unit),
        ("acceleration", _pooled(before, names, "velocity", rate=True), f"{unit}/s^2"),
        (f"rate of the {result.drive}", _pooled(before, names, "measured", rate=True), f"{effort}/s"),
    ]
    for p in (p for c in result.trace.causes for p in c.parameters if p.parameter == "order" and p.value > 0):
        name = f"position within one period of order {numbers.exact(p.value, 3)}"
        found.append((name, np.mod(position, 2 * np.pi / p.value), unit))
    return found


def over_motion(result: StudyResult, before: Fit, after: Fit | None, names: Sequence[str]) -> Figure:
    """Return the residual against two coordinates, the one that it follows most on top."""
    left = _pooled(before, names, "residual")
    right = _pooled(after, names, "residual", where=before) if after else None
    judged = sorted(((explained(c[1], left), c) for c in coordinates(result, names)), key=lambda j: -j[0])[:SHOWN]
    share, (name, values, _) = judged[0]
    heading = f"{capital(name)} alone explains {numbers.percent(share)} of the residual power"
    if share < LEAST:
        heading = f"No one signal of the motion explains the residual: {numbers.percent(share)} at most"
    elif right is not None:
        added = named(result.trace.causes)
        then = explained(values, right) * _ratio(right, left)
        heading += f"; with {added} added, {numbers.percent(then)} of it is left to explain"
    caption = (
        f"Residual on {'all validation records' if len(names) > 1 else 'the record ' + names[0]} against {name} and "
        f"{judged[1][1][0]}, in {figures.bins(values).size - 1} bins: median (line) and the middle 80 % (area). What a coordinate explains is the "
        "power of the residual's mean over its bins."
    )
    others = f"{capital(judged[1][1][0])} explains {numbers.percent(judged[1][0])}."
    drawn = [c for _, c in judged]
    draw = lambda: figures.against(heading, drawn, left, right, result.plant.effort)  # noqa: E731
    return Figure(
        "residual_over_motion", draw, f"{caption} {others}", f"Two graphs of the residual. {heading}. {others}"
    )


def explained(values: np.ndarray, residual: np.ndarray) -> float:
    """Return the share of the residual's power that is a function of these values, by means over bins."""
    index = np.searchsorted(figures.bins(values)[1:-1], values)
    count = np.bincount(index)
    total = np.bincount(index, weights=residual)
    power = float(residual @ residual)
    return float(np.sum(total**2 / np.maximum(count, 1))) / power if power > 0 else 0.0


def _pooled(fit: Fit, names: Sequence[str], which: str, rate: bool = False, where: Fit | None = None) -> np.ndarray:
    """Return a signal, or its rate of change, of these records one after another. where: the fit whose samples count, if another."""
    found = []
    for n in names:
        s = fit.series[n]
        values = getattr(s, which)
        found.append((np.gradient(values, s.time) if rate else values)[keep((where or fit).series[n])])
    return np.concatenate(found)


def _ratio(after: np.ndarray, before: np.ndarray) -> float:
    power = float(before @ before)
    return float(after @ after) / power if power > 0 else 0.0
