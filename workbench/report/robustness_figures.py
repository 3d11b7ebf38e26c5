"""Figures of the chapter on axes that differ; what each shows is in its title."""

from collections.abc import Mapping

import numpy as np

from workbench.finding import title
from workbench.report import numbers
from workbench.report.contents import Figure
from workbench.report.drawing import AFTER, BEFORE, MUTED, SERIES, STYLES, decades, envelope, svg
from workbench.robustness.result import Series
from workbench.robustness.workload import Work
from workbench.robustness.worst import Replayed, replay
from workbench.task.task import PHASES

FLOOR = 0.05  # of an encoder count: where a logarithmic axis begins
OWN = {"phase": "phase of the encoder's counts"}  # what varies and is no effect's
SHOWN = 8  # parameters of the figure on influence


def displacement(found: Series) -> str:
    """SI unit of the position."""
    return found.work.task.plant.displacement


def varied(name: str) -> str:
    """Return what varies, as it is read: "encoder eccentricity: phase" of "encoder_eccentricity.phase"."""
    effect, _, parameter = name.partition(".")
    return f"{title(effect)}: {parameter.replace('_', ' ')}" if parameter else OWN.get(name, title(name))


def _listed(values) -> str:
    """Factors as they are read."""
    return ", ".join(numbers.exact(v) for v in values)


def _shown(found: Series, errors) -> np.ndarray:
    least = FLOOR * (found.work.task.loop.count or 1e-9)
    return np.maximum(np.ravel(errors), least)


def perspectives_figure(found: Series) -> Figure:
    """Every error of the grid, its largest (first perspective) and its spread (second)."""
    unit = numbers.unit(displacement(found))
    names = list(found.grid.errors)
    best = {p: min(names, key=lambda n: getattr(found.of_grid[n], p)) for p in ("maximum", "spread")}
    same = best["maximum"] == best["spread"]
    heading = (
        f"{best['maximum']} is the most robust in both perspectives"
        if same
        else f"{best['maximum']} has the smallest largest error, {best['spread']} the smallest spread"
    )

    def draw(axes):
        (axis,) = axes
        for k, name in enumerate(reversed(names)):
            e = _shown(found, found.grid.errors[name])
            e = e[np.isfinite(e)]
            if not e.size:
                continue
            axis.plot([e.min(), e.max()], [k, k], "-", color=MUTED, lw=5, alpha=0.35, solid_capstyle="butt",
                      label="spread (second)" if k == 0 else None)  # fmt: skip
            axis.plot(
                e, np.full(e.size, k), "o", ms=3.5, color=AFTER, label="one point of the grid" if k == 0 else None
            )
            axis.plot(e.max(), k, "|", ms=15, mew=2, color=BEFORE,
                      label="largest (first)" if k == 0 else None)  # fmt: skip
        axis.set_xscale("log")
        axis.set_yticks(range(len(names)), list(reversed(names)))
        axis.set_ylim(-0.6, len(names) - 0.4)
        axis.set_xlabel(numbers.label("final error", unit))
        decades(axis.xaxis)
        axis.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=3)

    return Figure(
        "robust_perspectives",
        lambda: svg(heading, draw, height=1.3 + 0.32 * len(names)),
        f"Final errors over {found.grid.title}: factors {_listed(found.grid.frictions)} and {_listed(found.grid.inertias)}, each "
        f"the worst of {PHASES} encoder phases.",
        f"Errors of {len(names)} controllers on a logarithmic axis. {heading}.",
    )


def beyond_figure(found: Series) -> Figure:
    """How many of the drawn axes exceed an error."""
    unit = numbers.unit(displacement(found))
    limit = next((s["final_error"].limit for s in found.shares.values() if "final_error" in s), None)
    n = found.cases.count
    if limit is None:
        heading = f"Of {numbers.count(n)} drawn axes, how many exceed an error"
    else:
        least = min(found.shares, key=lambda c: found.shares[c]["final_error"].upper)
        share = found.shares[least]["final_error"]
        some = f"{numbers.count(share.exceeded)} of {numbers.count(n)} drawn axes exceed"
        heading = (
            f"Under {least} {some if share.exceeded else f'none of {numbers.count(n)} drawn axes exceeds'} the limit"
        )

    def draw(axes):
        (axis,) = axes
        for k, (name, metrics) in enumerate(found.columns.items()):
            e = np.sort(_shown(found, metrics["final_error"]))
            finite = np.isfinite(e)
            above = 1.0 - np.arange(n) / n
            axis.step(e[finite], above[finite], where="post", color=SERIES[k % len(SERIES)], ls=STYLES[k % len(STYLES)],
                      label=name)  # fmt: skip
        if limit is not None:
            axis.axvline(limit, color=MUTED, lw=0.8, ls=":")
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_xlabel(numbers.label("final error", unit))
        axis.set_ylabel("share of axes beyond it")
        decades(axis.xaxis)
        decades(axis.yaxis)
        axis.legend(loc="lower left")

    dotted = "" if limit is None else f" Dotted: the limit of {numbers.scaled(limit, displacement(found))}."
    return Figure(
        "robust_beyond",
        lambda: svg(heading, draw, height=3.0),
        f"Share of the drawn axes whose final error is larger.{dotted}",
        f"Falling curves of {len(found.columns)} controllers, both axes logarithmic. {heading}.",
    )


def influence_figure(found: Series, name: str) -> Figure:
    """Shares of the errors' scatter that each parameter accounts for, with two standard errors."""
    top = found.influences[name][:SHOWN]
    sure = [i.name for i in top if i.sure]
    heading = (
        f"Of all that varies, {varied(sure[0])} moves the error of {name} most"
        if sure
        else f"No single parameter moves the error of {name}"
    )

    def draw(axes):
        (axis,) = axes
        y = np.arange(len(top))[::-1]
        share = np.array([i.share for i in top])
        error = np.array([2 * i.share_error for i in top])
        axis.barh(y, share, color=AFTER, height=0.6)
        axis.errorbar(share, y, xerr=error, fmt="none", ecolor=BEFORE, capsize=2.5, lw=1)
        axis.set_yticks(y, [varied(i.name) for i in top])
        axis.set_xlabel("first-order share of the scatter of ranks, with two standard errors")
        axis.axvline(0.0, color=MUTED, lw=0.7)

    return Figure(
        "robust_influence",
        lambda: svg(heading, draw, height=1.0 + 0.26 * max(len(top), 1)),
        f"By which share the scatter of final errors under {name} would shrink if one parameter were known exactly.",
        f"Bars of {len(top)} parameters. {heading}.",
    )


def motion(work: Work, runs: Mapping[str, Replayed], heading: str) -> bytes:
    """Error and command over time of replayed cases, by name."""
    plant = work.task.plant
    least = FLOOR * (work.task.loop.count or 1e-9)

    def draw(axes):
        for k, (name, r) in enumerate(runs.items()):
            style = {"color": SERIES[k % len(SERIES)], "ls": STYLES[k % len(STYLES)], "lw": 1.0}
            time = r.trajectories.time
            left = np.maximum(np.abs(r.target - r.position), least)
            axes[0].semilogy(*envelope(time, left), label=name, **style)
            axes[1].plot(*envelope(time, r.trajectories["u"][:, 0]), **style)
        axes[0].set_ylabel(numbers.label("error, absolute", numbers.unit(plant.displacement)))
        axes[1].set_ylabel(numbers.label("command", numbers.unit(plant.effort)))
        axes[1].set_xlabel("time (s)")
        decades(axes[0].yaxis)
        axes[0].legend(loc="lower left")

    return svg(heading, draw, rows=2, height=4.2, share=True)


def worst_figure(found: Series) -> Figure:
    """The worst axis of each controller: what is left of the error over time."""
    cases = [next(c for c in found.worst if c.controller == n) for n in found.columns]
    last = max(cases, key=lambda c: c.metrics["final_error"])
    end = numbers.scaled(last.metrics["final_error"], displacement(found))
    heading = f"On the worst of {numbers.count(found.cases.count)} axes {last.controller} is left with {end}"

    def drawn() -> bytes:
        return motion(found.work, {c.controller: replay(found.work, c) for c in cases}, heading)

    return Figure(
        "robust_worst",
        drawn,
        "Each controller on its own worst axis, replayed from the draw that is kept.",
        f"Error and command over time of {len(cases)} controllers. {heading}.",
    )
