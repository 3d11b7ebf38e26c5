"""Which controller to take, with everything that was found of each in one table."""

import numpy as np

from workbench.plant import Plant
from workbench.report import numbers
from workbench.report.contents import GOOD, Chapter, Marked, Paragraph, Table
from workbench.verification.recommend import Recommended

RECOMMENDED = "recommended"  # kind of the finding that says which controller to take


def recommended_chapter(found: Recommended, plant: Plant, counts: float) -> Chapter:
    """The sentence, and every candidate. counts: of the encoder, rad or m."""
    unit = plant.displacement
    rows = tuple(
        (
            Marked(r.name, GOOD) if r.name == found.name else r.name,
            _time(r.time),
            numbers.scaled(r.error, unit) if np.isfinite(r.error) else "–",
            _time(r.time_grid),
            numbers.scaled(r.error_grid, unit) if np.isfinite(r.error_grid) else "–",
            numbers.percent(r.overshoot_grid) if np.isfinite(r.overshoot_grid) else "–",
            numbers.number(r.sensitivity),
            str(r.numbers),
        )
        for r in found.rows
    )
    columns = ("controller", "1 % time", "error", "worst 1 % time", "worst error", "worst overshoot", "Ms", "numbers")
    caption = (
        "Nominal without load, and the worst over half to one and a half times inertia and friction and every load. One count is "
        f"{numbers.scaled(counts, unit)}."
        if counts
        else "Nominal without load, and the worst over half to one and a half times inertia and friction and every load."
    )
    return Chapter(
        "Which controller to take",
        (Paragraph(_first(found)), Table(columns, rows, caption, "lrrrrrrr")),
    )


def _first(found: Recommended) -> str:
    """Say why the recommended controller is taken."""
    if not found.row.allowed:
        return (
            f"None of {len(found.rows)} controllers, tuned by the same search, keeps the overshoot in the worst case; {found.name} "
            "comes nearest."
        )
    return (
        f"Of {len(found.rows)} controllers, tuned by the same search on the same cases, {found.name} has the least worst case. Ms is "
        "the largest amplification of a disturbance over all frequencies: the smaller, the further from instability."
    )


def _time(seconds: float) -> str:
    return numbers.scaled(seconds, "s", 4) if np.isfinite(seconds) else "never"
