"""Chapters on a contest of controllers: what each does, who is beaten on what, fronts, and error against margin."""

from collections.abc import Sequence

import numpy as np

from workbench.report import numbers, wording
from workbench.report.contents import Chapter, Figure, Items, Paragraph, Table
from workbench.report.drawing import MUTED, SERIES, STYLES, decades, svg
from workbench.verification.contest import Contest, Result
from workbench.verification.margin import AgainstMargin, Asked
from workbench.verification.wording import ms, verdict

COUNTS = 2.0  # of the encoder: what counts as exact
MARKS = ("o", "s", "^", "D", "v", "P", "X", "<", ">")


def _spanned(standing: Result, figure: str, scale: float = 1.0) -> str:
    """Median over the seeds, with what they span where that shows."""
    middle = numbers.number(scale * standing.median(figure))
    low, high = (numbers.number(scale * v) for v in standing.span(figure))
    return middle if low == high else f"{middle} ({low} to {high})"


def standings_table(contest: Contest) -> Table:
    """Every controller: times in ms, errors in micro-units of the position."""
    unit = contest.task.plant.displacement
    rows = []
    for name, s in contest.standings.items():
        rows.append(
            (
                name,
                _spanned(s, "time", 1e3),
                numbers.number(contest.over_bound(name)),
                _spanned(s, "time_loaded", 1e3),
                _spanned(s, "error", 1e6),
                _spanned(s, "error_loaded", 1e6),
                _spanned(s, "error_grid", 1e6),
                numbers.number(1e6 * s.median("error_spread")),
                numbers.number(s.median("sensitivity")) if "sensitivity" in s.values else "–",
            )
        )
    columns = (
        "controller", "1 % time (ms)", "of the bound", "loaded", f"error (µ{unit})", "loaded", "largest, grid",
        "spread, grid", "Ms",
    )  # fmt: skip
    t = contest.task
    caption = (
        f"Medians over the seeds, in brackets what they span. The bound is {ms(contest.bound)} without and "
        f"{ms(contest.bound_loaded)} with the load. Grid: inertia times {_listed(t.inertias)}, friction times "
        f"{_listed(t.frictions)}. One encoder count is {numbers.number(1e6 * t.loop.count)} µ{unit}."
    )
    return Table(columns, tuple(rows), caption, "lrrrrrrrr")


def _listed(values: Sequence[float]) -> str:
    return ", ".join(f"{v:g}" for v in values)


def _fronts_figure(contest: Contest, names: Sequence[str]) -> Figure:
    """What the searches found possible: worst 1 % time against worst error, over the grid."""
    unit = contest.task.plant.displacement
    fronts = {n: contest[n].tuned.trail.front() for n in names}
    least = {n: float(f[1].min()) if f[1].size else np.inf for n, f in fronts.items()}
    exact = [n for n in names if least[n] <= COUNTS * contest.task.loop.count]
    heading = f"{len(exact)} of {len(names)} controllers come down to {COUNTS:g} counts over the grid"
    heading += f": {wording.listed(exact)}" if exact else ""

    def draw(axes):
        for k, name in enumerate(names):
            time, error = fronts[name]
            style = {"color": SERIES[k % len(SERIES)], "ls": STYLES[k % len(STYLES)], "marker": MARKS[k % len(MARKS)]}
            axes[0].semilogy(1e3 * time, error, drawstyle="steps-post", ms=3, lw=0.9, label=name, **style)
        axes[0].axhline(contest.task.loop.count, color=MUTED, lw=0.8)
        axes[0].text(1.01, contest.task.loop.count, "one count", color=MUTED, ha="left", va="center",
                     transform=axes[0].get_yaxis_transform())  # fmt: skip
        axes[0].set_xlabel("worst 1 % time (ms)")
        axes[0].set_ylabel(numbers.label("worst final error", unit))
        decades(axes[0].yaxis)
        axes[0].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))

    return Figure(
        "fronts",
        lambda: svg(heading, draw, height=3.2),
        "Points that no other beats on both, of all that the searches of all seeds tried and that keep every limit.",
        f"Error over time for {len(names)} controllers. {heading}.",
    )


def margin_figure(found: AgainstMargin, unit: str, asked: float) -> Figure:
    """Worst error over the limit on the sensitivity."""
    names = list(found.values)
    errors = found.values[names[0]]["error_grid"]
    at = int(np.argmin(np.abs(found.limits - asked)))
    heading = (
        f"{names[0]}: {numbers.scaled(float(errors[at]), unit)} at Ms = {found.limits[at]:g}, "
        f"{numbers.scaled(float(errors[-1]), unit)} at Ms = {found.limits[-1]:g}"
    )

    def draw(axes):
        for k, name in enumerate(names):
            for figure, style, said in (("error_grid", STYLES[0], "over the grid"), ("error", STYLES[1], "nominal")):
                axes[0].semilogy(
                    found.limits, found.values[name][figure], ls=style, marker=MARKS[k % len(MARKS)], ms=4, color=SERIES[k % len(SERIES)],
                    label=f"{name}, {said}",
                )  # fmt: skip
        axes[0].axvline(asked, color=MUTED, lw=0.8, ls=":")
        axes[0].set_xlabel("limit on Ms, at every amplitude")
        axes[0].set_ylabel(numbers.label("final error", unit))
        decades(axes[0].yaxis)
        axes[0].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))

    return Figure(
        "error_against_margin",
        lambda: svg(heading, draw, height=2.8),
        "Everything is tuned anew for each limit. Dotted: the limit that this study holds.",
        f"Error over the limit on the sensitivity. {heading}.",
    )


def asked_table(rows: Sequence[Asked], limits: np.ndarray, own: float) -> Table:
    """Figures that were asked for and that the margin forbids: what is had with it, and at which limit on Ms they are had.

    limits (n,): that were tried. own: the study's limit.
    """
    cells = []
    for r in rows:
        had, said = r.had_at(limits), numbers.quantity if r.unit == "1" else numbers.scaled
        loosest = f"{said(float(r.values[-1]), r.unit)} at Ms = {limits[-1]:g}"
        cells.append((
            r.what,
            said(r.asked, r.unit),
            said(r.obtained, r.unit),
            f"at Ms = {had:g}" if had is not None else f"at none: {loosest}",
            r.why,
        ))  # fmt: skip
    columns = ("figure", "asked", f"had with Ms ≤ {own:g}", "asked is had", "why")
    caption = f"Where the margin wins. Limits on Ms that were tried: {_listed(limits)}."
    return Table(columns, tuple(cells), caption, "wrrrp")


def contest_chapter(contest: Contest, ours: Sequence[str], baselines: Sequence[str], fronts: Sequence[str]) -> Chapter:
    """What each controller does, and for each of ours which baseline is beaten on what, and which is not."""
    unit = contest.task.plant.displacement
    w = contest.task.weights
    text = (
        "Every controller is tuned by the same search (differential evolution, then Nelder and Mead), from the same seeds, on "
        "the same scenarios, with the same drive, encoder, delay and velocity filter, and the same limits: an overshoot of "
        f"at most {numbers.percent(w.overshoot)}, and a sensitivity of at most {w.sensitivity:g} in gross sliding and at every "
        "amplitude that it schedules. What is stated and not tuned says so. The cost is the largest over the grid of 1 % time over "
        f"the bound plus {w.error:g} a decade of final error."
    )
    said = tuple(
        verdict(contest, mine, b, unit).sentence
        for mine in ours
        for b in baselines
        if b in contest.standings and b != mine
    )
    return Chapter(
        "Controllers, tuned alike",
        (Paragraph(text), standings_table(contest), _fronts_figure(contest, fronts), Items(said)),
    )
