"""The chapter on a closed drive: its gains beside the scheduled PD, what each file is, and what a format refused."""

from collections.abc import Mapping, Sequence

import numpy as np

from workbench.drive_tuning.comparison import ComparedDrive, SizeComparison
from workbench.drive_tuning.gains import DriveGains
from workbench.plant import Plant
from workbench.report import numbers
from workbench.report.contents import Chapter, Figure, Items, Paragraph, Table
from workbench.report.drawing import AFTER, BEFORE, MUTED, decades, svg

STYLES = (("scheduled", BEFORE, "--"), ("single", MUTED, ":"), ("sets", AFTER, "-"))


def drive_chapter(
    found: ComparedDrive, plant: Plant, scheduled: str, kept: Sequence[str], refused: Mapping[str, str]
) -> Chapter:
    """Return the chapter. scheduled: name of the PD schedule. kept: files."""
    gains, rows, smooth = found.gains, found.sizes, found.following
    blocks = [
        Paragraph(_said(gains, rows) + _followed(gains, smooth, plant)),
        _gains_table(gains, plant),
        _beside_table(rows, plant, scheduled),
    ]
    if len(rows) > 1:
        blocks.insert(2, _figure(gains, rows, plant, scheduled))
    if kept:
        files = ", ".join(kept)
        blocks.append(Paragraph(f"Written into the folder drive, each read again before it was kept: {files}."))
    if refused:
        blocks.append(Items(tuple(f"{name}: {sentence}" for name, sentence in refused.items())))
    return Chapter("A drive that takes no code", tuple(blocks))


def _arrives(rows: Sequence[SizeComparison]) -> str:
    """Say on how many of the moves the drive's own gains come within 1 %."""
    came = sum(np.isfinite(r.sets.time) for r in rows)
    return (
        f"With its own gains the drive comes within 1 % of the target in {came} of {len(rows)} moves. " if rows else ""
    )


def _said(gains: DriveGains, rows: Sequence[SizeComparison]) -> str:
    """What the drive comes to, what it was stated to be, and how its gains were found."""
    lag, n = gains.closed.lag, len(gains.notches)
    notches = ", ".join(
        f"{numbers.number(x.centre)} Hz ({numbers.number(x.width)} Hz wide, depth {numbers.number(x.depth, 2)})"
        for x in gains.notches
    )
    fed = [w for w, on in (("the reference's speed", gains.forward), ("its acceleration", gains.mass)) if on]
    return (
        f"{_arrives(rows)}The drive is a proportional loop of position over a proportional and integral loop of speed"
        + (f" and a current loop of {numbers.scaled(lag, 's')}" if lag else "")
        + (f", with notches at {notches}" if n else ", without notches")
        + (f"; it feeds forward {' and '.join(fed)}" if fed else "")
        + f". Its gains were searched on the simulated step with the limits and the cost of every other controller, {gains.tried} steps "
        f"in all; |S| is at most {numbers.number(float(gains.sensitivity.max()))} over the task's loads and factors on inertia and "
        "friction, sliding and sticking, and over the measured response where one shows a mode. "
        + (
            "Each set is for moves up to its size; the drive is told which one before the move."
            if gains.sizes.size > 1
            else "It has one set of gains, for the task's step."
        )
    )


def _followed(gains: DriveGains, smooth: tuple[float, float], plant: Plant) -> str:
    """What feed-forward is worth along a smooth move."""
    if not (gains.forward or gains.mass):
        return ""
    without, fed = (numbers.scaled(x, plant.displacement) for x in smooth)
    return f" Along a smooth move of the task's step, in three times its bound, it follows within {fed}, and within {without} without feed-forward."


def _gains_table(gains: DriveGains, plant: Plant) -> Table:
    """Every set."""
    speed, spring = (numbers.unit(f"{plant.effort}{t}/{plant.displacement}") for t in ("*s", ""))
    rows = tuple(
        (
            str(i),
            numbers.scaled(float(size), plant.displacement),
            *(numbers.number(float(v)) for v in point),
            numbers.number(float(peak)),
        )
        for i, (size, point, peak) in enumerate(zip(gains.sizes, gains.points, gains.sensitivity, strict=True), 1)
    )
    columns = ("set", "move", "kv (1/s)", f"kvp ({speed})", f"ki ({spring})", "Ms")
    return Table(columns, rows, "Gains of the drive, in SI; its files hold them in its own units.", "rrrrrr")


def _beside_table(rows: Sequence[SizeComparison], plant: Plant, scheduled: str) -> Table:
    """The worst arrival of each size under all three."""
    kinds = ("scheduled", "single", "sets") if len(rows) > 1 else ("scheduled", "sets")
    cells = tuple(
        (
            numbers.scaled(r.size, plant.displacement),
            *(_text(getattr(r, k).time, "s") for k in kinds),
            *(_text(getattr(r, k).error, plant.displacement) for k in kinds),
        )
        for r in rows
    )
    names = {"scheduled": scheduled, "single": "drive, one set", "sets": "drive"}
    columns = ("move", *(f"1 % time, {names[k]}" for k in kinds), *(f"error, {names[k]}" for k in kinds))
    return Table(
        columns, cells, "The worst over the task's scenarios, behind the same current loop.", "r" * len(columns)
    )


def _text(value: float, unit: str) -> str:
    return numbers.scaled(value, unit) if np.isfinite(value) else "never"


def _figure(gains: DriveGains, rows: Sequence[SizeComparison], plant: Plant, scheduled: str) -> Figure:
    """Time and error over the size of the move."""
    settled = {k: sum(np.isfinite(getattr(r, k).time) for r in rows) for k, _, _ in STYLES}
    heading = (
        f"Of {len(rows)} sizes of move {settled['sets']} come within 1 % with sets of gains, {settled['single']} with one set, "
        f"{settled['scheduled']} under the scheduled PD"
    )
    sizes = [r.size for r in rows]
    names = {"scheduled": scheduled, "single": "drive, one set", "sets": f"drive, {len(rows)} sets"}

    def draw(axes):
        for kind, color, style in STYLES:
            times = [1e3 * getattr(r, kind).time for r in rows]
            axes[0].loglog(sizes, times, color=color, ls=style, label=names[kind])
            axes[1].loglog(sizes, [getattr(r, kind).error for r in rows], color=color, ls=style)
        axes[1].axhline(gains.task.loop.count, color=MUTED, lw=0.8)
        axes[0].set_ylabel("1 % time (ms)")
        axes[1].set_ylabel(numbers.label("final error", numbers.unit(plant.displacement)))
        axes[1].set_xlabel(numbers.label("size of the move", numbers.unit(plant.displacement)))
        for axis in axes:
            decades(axis.xaxis)
        axes[0].legend(loc="upper left")

    return Figure(
        "drive", lambda: svg(heading, draw, rows=2, height=4.4, share=True),
        "The worst arrival over the task's scenarios. The line is one encoder count.", f"Two graphs over the size of a move. {heading}.",
    )  # fmt: skip
