"""What the notch among the numbers of a controller buys, beside the same search without it."""

from collections.abc import Mapping

import numpy as np

from workbench.design.optimise import Tuned
from workbench.report import numbers
from workbench.report.wording import listed


def _worst_of(tuned: Tuned) -> tuple[float, float]:
    """Return the worst 1 % time in s and final error in rad or m over the grid at the best point that a search found."""
    best = int(np.argmin(tuned.trail.cost))
    return float(tuned.trail.time[best]), float(tuned.trail.error[best])


def notch_sentence(tuned: Mapping[str, Tuned], unnotched: Mapping[str, Tuned], unit: str) -> str:
    """Say, controller by controller, what worst error, worst time and cost are with the notch and without. unit: of positions."""
    return (
        "What a notch among their numbers buys, by the same search without one: "
        + listed([_said(n, tuned[n], other, unit) for n, other in unnotched.items()])
        + "."
    )


def _said(name: str, ours: Tuned, other: Tuned, unit: str) -> str:
    (time, error), (late, left) = _worst_of(ours), _worst_of(other)
    return (
        f"{name} leaves {numbers.scaled(error, unit)} over the grid instead of {numbers.scaled(left, unit)} after {numbers.scaled(time, 's')} "
        f"instead of {numbers.scaled(late, 's')} ({numbers.percent(1.0 - ours.value / other.value)} of the cost)"
    )


def as_table(tuned: Mapping[str, Tuned], unnotched: Mapping[str, Tuned]) -> list[dict]:
    """Return the same as rows, SI."""
    rows = []
    for name, other in unnotched.items():
        for notch, one in ((True, tuned[name]), (False, other)):
            time, error = _worst_of(one)
            rows.append({"controller": name, "notch": notch, "cost": one.value, "time": time, "error": error})
    return rows
