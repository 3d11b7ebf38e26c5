"""What every tuned controller takes on the ladder that the gain table was tuned for: a table, and the same for results.json."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from workbench.report import numbers
from workbench.report.contents import Chapter, Table
from workbench.verification.regret import Regret


def contestants(every: Mapping[str, Regret]) -> list[dict]:
    """Return rows of results.json: the worst of each controller over all moves, and its middle."""
    return [
        {
            "controller": n,
            **dict(zip(("regret_time", "regret_error", "overshoot"), r.worst, strict=True)),
            "median_time": float(np.median(r.time)),
            "median_error": float(np.median(r.error)),
        }
        for n, r in every.items()
    ]


def with_contestants(chapter: Chapter, every: Mapping[str, Regret]) -> Chapter:
    """Return the chapter on the ladder with a table of regret, a row a controller."""
    rows = tuple(
        (
            c["controller"],
            *(shown(c[n]) for n in ("median_time", "regret_time", "median_error", "regret_error")),
            numbers.percent(c["overshoot"]) if np.isfinite(c["overshoot"]) else "–",
        )
        for c in contestants(every)
    )
    columns = ("controller", "time: median", "worst", "error: median", "worst", "worst overshoot")
    caption = (
        "Every controller on the same ladder: time and error over the references of each move. The gain table alone was tuned "
        "for all of these moves, the others for the task's step. “Never” does not come to rest in its band."
    )
    return replace(chapter, blocks=(*chapter.blocks, Table(columns, rows, caption, "lrrrrr")))


def shown(ratio: float) -> str:
    return numbers.number(ratio) if np.isfinite(ratio) else "never"
