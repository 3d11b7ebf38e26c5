"""The chapter on limit cycles: over which gains the loop hunts, as it is predicted and as it is simulated."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from workbench.firmware.naming import slug
from workbench.limit_cycle.gain_region import THIRD, Region
from workbench.report import numbers
from workbench.report.contents import Chapter, Equation, Figure, Items, Paragraph, Table
from workbench.report.drawing import AFTER, BEFORE, GRID, INK, MUTED, svg
from workbench.task.task import Task

PICKED = 8  # rows of the table
FAINT = 0.16  # of a predicted case's shade


def chapter(found: Mapping[str, Region], task: Task, said: Sequence[str]) -> Chapter:
    """A figure and a table of each controller. said: what was found, a sentence each."""
    text = (
        "A loop hunts where a motion keeps itself going. Friction with memory is, for a motion of one amplitude, a spring and a "
        "loss; the drive's limit makes the command's share smaller as it grows. Where the loop that is linear for one amplitude "
        "balances on the edge of stability, a limit cycle is predicted:"
    )
    more = (
        "C is the first harmonic of the command over that of the reading, P the sampled axis with its hold, delay and velocity "
        "filter. Each cycle found is then balanced again with odd harmonics up to the nineteenth, and counts where they leave "
        "it. A schedule's gains jump where a reversal is found, some encoder counts after it; the balance knows where. The "
        "simulation is released from rest at a third of the predicted amplitude, at it and at three times it; what still moves in "
        "the last quarter hunts. "
        f"A balance of harmonics says enough where the third is at most {numbers.percent(THIRD)}, of the simulated cycle or, where "
        "none is simulated, of the predicted one; cases beyond do not count."
    )
    r = next(iter(found.values()))
    axis = "" if (r.inertia, r.friction) == (1.0, 1.0) else (
        f" The axis has {numbers.exact(r.inertia)} times its inertia and {numbers.exact(r.friction)} times its friction."
    )  # fmt: skip
    balance = Equation("1 + C(A, omega) thin P(omega; k_e (A), c_e (A)) = 0", "one plus C times P is zero")
    blocks = [Items(tuple(said)), Paragraph(text), balance, Paragraph(more + axis)]
    for name, one in found.items():
        blocks += [_figure(name, one), _table(name, one, task)]
    return Chapter("Which gains hunt", tuple(blocks))


def _figure(name: str, r: Region) -> Figure:
    """The region over both gains: shaded where a cycle is predicted, dots where it is simulated."""
    wrong = int(np.sum(r.judged & ~r.right))
    heading = (
        f"{name}: prediction and simulation agree in all {int(r.judged.sum())} cases"
        if not wrong
        else f"{name}: prediction and simulation agree in all but {wrong} of {int(r.judged.sum())} cases"
    )

    return Figure(
        f"hunting_{slug(name)}",
        lambda: svg(heading, partial(_draw, r), height=4.0),
        f"Factors on the gains of {name}; 1 is as tuned.",
        f"A grid of {r.first.size} by {r.second.size} pairs of gains. {heading}.",
    )


def _draw(r: Region, axes) -> None:
    """Draw the region: its cases as simulated on the shade of what is predicted."""
    (axis,) = axes
    step = [np.sqrt(x[1] / x[0]) for x in (r.first, r.second)]
    edges = [np.append(x / s, x[-1] * s) for x, s in zip((r.first, r.second), step, strict=True)]
    for i, j in np.argwhere(r.predicted):
        axis.fill_between(edges[0][i : i + 2], edges[1][j], edges[1][j + 1], color=AFTER, alpha=FAINT, lw=0)
    x, y = np.meshgrid(r.first, r.second, indexing="ij")
    marks = (
        (r.exists & r.judged, "o", AFTER, "simulated: hunts"),
        (~r.exists, ".", MUTED, "simulated: comes to rest"),
        (r.exists & ~r.judged, "s", INK, f"hunts, third harmonic above {100 * THIRD:.0f} %"),
        (r.judged & ~r.right, "x", BEFORE, "prediction is wrong"),
    )
    for where, mark, colour, label in marks:
        if where.any():
            axis.plot(x[where], y[where], mark, ms={".": 3, "x": 8}.get(mark, 4.5), color=colour, label=label, ls="")
    axis.fill_between([], [], color=AFTER, alpha=FAINT, lw=0, label="predicted: hunts")
    axis.axvline(1.0, color=GRID, lw=1.5, zorder=0)
    axis.axhline(1.0, color=GRID, lw=1.5, zorder=0)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.grid(False)
    axis.set_xlim(edges[0][0], edges[0][-1])
    axis.set_ylim(edges[1][0], edges[1][-1])
    axis.set_xlabel(f"factor on {r.dials.first}")
    axis.set_ylabel(f"factor on {r.dials.second}")
    for one in (axis.xaxis, axis.yaxis):
        one.set_major_formatter(lambda v, _: numbers.exact(v, 2))
        one.set_minor_formatter(lambda v, _: "")
    axis.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=2)


def _table(name: str, r: Region, task: Task) -> Table:
    """Some of the cycles, predicted beside simulated."""
    x = task.plant.displacement
    rows = []
    at = [(int(i), int(j)) for i, j in np.argwhere(r.exists)]
    for i, j in [at[k] for k in np.unique(np.linspace(0, len(at) - 1, min(PICKED, len(at))).astype(int))] if at else []:
        near = r.nearest((i, j))
        rows.append(
            (
                numbers.number(float(r.first[i]), 2), numbers.number(float(r.second[j]), 2),
                numbers.scaled(near.amplitude, x) if near else "none", numbers.scaled(float(r.amplitude[i, j]), x),
                numbers.quantity(near.omega, "rad/s") if near else "none",
                numbers.quantity(float(r.omega[i, j]), "rad/s"), numbers.percent(float(r.third[i, j])),
                "speed" if r.limited[i, j] else "",
            )
        )  # fmt: skip
    columns = (f"{r.dials.first} ×", f"{r.dials.second} ×", "amplitude, predicted", "simulated", "frequency, predicted",
               "simulated", "third harmonic", "limited by")  # fmt: skip
    caption = (
        f"Some of the limit cycles of {name}. Where the axis' speed limits the motion, frequency is not predicted."
    )
    kept = slice(None) if r.limited.any() else slice(-1)
    caption = caption if r.limited.any() else f"Some of the limit cycles of {name}."
    return Table(columns[kept], tuple(row[kept] for row in rows), caption, "rrrrrrrl"[kept])
