"""The loop, closed with what was found: a step under gains tuned without and with it."""

import numpy as np

from workbench.cancellation.closed import take
from workbench.finding import capital
from workbench.plant import TWO_MASS
from workbench.report import numbers
from workbench.report.contents import Callout, Chapter, Figure, Items, Paragraph, StudyResult, Table
from workbench.report.drawing import AFTER, BEFORE, MUTED, STYLES, decades, envelope, svg
from workbench.report.wording import listed, named, typeset
from workbench.task.task import PHASES, Weights
from workbench.tracing.result import Trace
from workbench.verification.closed_loop import DECLARED, EXTENDED, ClosedLoop, Response

LEAST = 0.05  # of an encoder count, that an error is drawn down to
NEGLIGIBLE = 0.005  # overshoot: what is less is equal
LEVEL = 0.02  # relative change from which a figure is said to change
COLOURS = {(DECLARED, DECLARED): MUTED, (DECLARED, EXTENDED): BEFORE, (EXTENDED, EXTENDED): AFTER}
GAINS = {"kv": "1/s", "kvp": "{f}*s/{x}", "ki": "{f}/{x}"}


def closing(result: StudyResult) -> Chapter | None:
    """Return the chapter of the loop, or of the sentence why it is not closed; None where that was not asked for."""
    if result.closed is None:
        return None
    return absent(result.closed) if isinstance(result.closed, str) else closed_loop(result.trace, result.closed)


def closed_loop(found: Trace, closed: ClosedLoop) -> Chapter:
    """What the found effect is worth to a controller, in figures and as motion."""
    plant = found.after.plant
    blocks = [
        Callout(_worth(found, closed)),
        Paragraph(_assumed(found, closed)),
        _responses(closed, plant.displacement),
        _step(found, closed),
        _gains(closed, plant.effort, plant.displacement),
    ]
    if closed.cancelled:
        blocks += _compensation(closed, plant.displacement)
    if closed.followed:
        blocks.append(Items((_followed(closed, plant.displacement),)))
    return Chapter("The loop, closed with what was found", tuple(blocks))


def _causes(found: Trace) -> str:
    return named(found.causes)


def _seconds(value: float) -> str:
    return numbers.scaled(value, "s") if np.isfinite(value) else "never"


def _hundredths(ratio: float) -> str:
    """Return a ratio in hundredths of a per cent: what is less does not matter."""
    return f"{numbers.placed(100 * ratio, 2)}\u00a0%" if np.isfinite(ratio) else numbers.named(ratio)


def figures(found: Trace, closed: ClosedLoop) -> list[tuple]:
    """Return (figure, without, with what was found, how it is shown), of the step on the extended plant."""
    x = found.after.plant.displacement
    a, b = closed.tuned_on_declared, closed.tuned_on_extended
    return [
        ("rise time", a.rise, b.rise, _seconds),
        ("1 % time", a.time_1pct, b.time_1pct, _seconds),
        ("overshoot", a.overshoot, b.overshoot, _hundredths),
        ("final error", a.final_error, b.final_error, lambda v: numbers.scaled(v, x)),
    ]


def _worth(found: Trace, closed: ClosedLoop) -> str:
    """Return what tuning with the found effect changes, on the plant that has it."""
    texts = [
        f"{article} {name} of {shown(now)} instead of {shown(was)}"
        if _changed(was, now)
        else f"{article} {name} of {shown(now)} as before"
        for article, (name, was, now, shown) in zip(("a", "a", "an", "a"), figures(found, closed), strict=True)
    ]
    return f"On the plant with {_causes(found)}, gains tuned with it in the model give {listed(texts)}."


def of_loop(result: StudyResult) -> str:
    """Return what the loop answers on page 1; "" where it is not closed."""
    closed = result.closed
    return "" if closed is None or isinstance(closed, str) else f"{heading(result.trace, closed)}."


def heading(found: Trace, closed: ClosedLoop) -> str:
    """Return the figure in which tuning with the found effect changes most."""

    def size(figure: tuple) -> float:
        _, was, now, _ = figure
        least = NEGLIGIBLE if figure[0] == "overshoot" else 0.0
        was, now = max(was, least), max(now, least)
        return (
            abs(float(np.log(now / was)))
            if 0 < was < np.inf and 0 < now < np.inf
            else float("inf")
            if was != now
            else 0.0
        )

    name, was, now, shown = max(figures(found, closed), key=size)
    if not _changed(was, now):
        return f"Gains tuned with {_causes(found)} in the model step as those tuned without"
    return f"With {_causes(found)} in the model the {name} is {shown(now)} instead of {shown(was)}"


def _changed(was: float, now: float) -> bool:
    if not (np.isfinite(was) and np.isfinite(now)):
        return was != now
    return abs(now - was) > LEVEL * max(abs(was), abs(now))


def _assumed(found: Trace, closed: ClosedLoop) -> str:
    """Return what loop and what step this is."""
    plant = found.after.plant
    loop, x, asked = closed.loop, plant.displacement, Weights()
    two = ""
    if plant.kind == TWO_MASS:
        two = " Of the two masses the motor's encoder closes the loop, and the step and its figures are the load's."
    return (
        f"The bench's own controller is not known, so one is assumed: position P over velocity PI every "
        f"{_seconds(loop.sample_time)}, with one sample of delay, one of velocity filter and the record's encoder. Its three "
        "numbers are tuned by one search, on the declared and on the extended model, for the shortest 1 % time with an "
        f"overshoot of {100.0 * asked.overshoot:g} % at most and a sensitivity of the sampled loop of {asked.sensitivity:g} at most, within "
        "the limit of the drive. The "
        f"step goes {numbers.scaled(closed.step, x)} from {numbers.scaled(closed.start, x)}, the middle half of the "
        "validation record's travel. The extended model stands for the axis: these are predictions, to be checked on the bench."
        + two
    )


def _named(r: Response) -> str:
    return f"{r.tuned_on} model"


def _responses(closed: ClosedLoop, x: str) -> Table:
    """Every combination that matters, in figures."""
    factor, unit = numbers.prefixed(max(r.final_error for r in closed.responses if np.isfinite(r.final_error)), x)
    rows = tuple(
        (
            _named(r),
            f"{r.run_on} model",
            _seconds(r.rise),
            _seconds(r.time_1pct),
            _hundredths(r.overshoot),
            numbers.number(r.final_error * factor),
        )
        for r in closed.responses
    )
    columns = ("gains tuned on", "run on", "rise, 10 to 90 %", "1 % time", "overshoot", f"final error ({unit})")
    caption = f"The step: what the declared model promises, what becomes of it on the extended one, and the same tuned anew; the worst of {PHASES} encoder phases."  # fmt: skip
    return Table(columns, rows, caption, "llrrrr")


def _step(found: Trace, closed: ClosedLoop) -> Figure:
    """The error that is left, and the command."""
    plant = found.after.plant
    title = heading(found, closed)
    least = LEAST * (closed.loop.count or 1e-5 * closed.step)
    target = closed.start + closed.step

    def draw(axes):
        for k, ((tuned_on, run_on), (q, u)) in enumerate(closed.signals.items()):
            style = {"color": COLOURS[tuned_on, run_on], "ls": STYLES[k], "lw": 1.1}
            left = np.maximum(np.abs(target - q), least)
            axes[0].semilogy(
                *envelope(closed.time, left), **style, label=f"tuned on the {tuned_on}, run on the {run_on}"
            )
            axes[1].plot(*envelope(closed.time, u), **style)
        axes[0].axhline(0.01 * closed.step, color=MUTED, lw=0.7, ls=":")
        axes[0].set_ylabel(numbers.label("error, absolute", numbers.unit(plant.displacement)))
        axes[1].set_ylabel(numbers.label("command", numbers.unit(plant.effort)))
        axes[1].set_xlabel("time (s)")
        decades(axes[0].yaxis)
        axes[0].legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=1)

    caption = "What is left of the step (top; dotted: 1 % of it) and the command (bottom)."
    draws = lambda: svg(title, draw, rows=2, height=4.6, share=True)  # noqa: E731
    return Figure("closed_step", draws, caption, f"Two graphs over time for three loops. {title}.")


def _gains(closed: ClosedLoop, f: str, x: str) -> Table:
    """The tuned numbers."""
    names = list(closed.gains[DECLARED])
    units = [numbers.unit(GAINS[n].format(f=f, x=x)) for n in names]
    rows = tuple((f"{model} model", *(numbers.number(v[n]) for n in names)) for model, v in closed.gains.items())
    columns = ("tuned on", *(numbers.label(n, u) for n, u in zip(names, units, strict=True)))
    return Table(columns, rows, "The gains of the cascade.", "l" + "r" * len(names))


def _followed(closed: ClosedLoop, x: str) -> str:
    """Return how far the two models part when they follow the record's reference."""
    f = closed.followed
    was, now = (numbers.scaled(f.largest[n], x) for n in (DECLARED, EXTENDED))
    return (
        f"Along the reference of {f.record}, under the same gains, the motions that the two models predict differ by "
        f"{numbers.scaled(f.position, x)} rms, and their drives by {numbers.percent(f.drive)}. The extended model lags behind "
        f"the reference by {was} at most under the gains tuned on the declared one, and by {now} under its own."
    )


ADVICE = {
    "compensation": "Take the compensation: it gains more than new gains do, and keeps it where the effect is 30 % off.",
    "gains": "Take the new gains: compensation gains less, or loses it where the effect is 30 % off.",
    "both alike": "Compensation and new gains come to the same; the gains are simpler.",
    "neither": "Neither is worth much here: these gains bear the effect as it is.",
}


def _compensation(closed: ClosedLoop, x: str) -> list:
    """Return what cancelling the causes is worth beside new gains, and which of the two to take."""
    found = closed.cancelled
    factor, unit = numbers.prefixed(max(closed.tuned_on_declared.final_error, found.exact["final_error"], 1e-12), x)

    def row(name, one, following):
        cells = (_seconds(one["rise"]), _seconds(one["time_1pct"]), _hundredths(one["overshoot"]))
        lag = numbers.number(following * factor) if np.isfinite(following) else ""
        return (name, *cells, numbers.number(one["final_error"] * factor), lag)

    lags = closed.followed.largest if closed.followed else {DECLARED: np.nan, EXTENDED: np.nan}
    rows = [
        row("gains as they were", vars(closed.tuned_on_declared), lags[DECLARED]),
        row("new gains", vars(closed.tuned_on_extended), lags[EXTENDED]),
    ]
    for g, one in found.figures.items():
        rows.append(
            row("compensation" + (f", {typeset(f'{100 * (g - 1):+.0f}')} %" if g != 1.0 else ""), one, one["following"])
        )
    columns = ("what is changed", "rise", "1 % time", "overshoot", f"final error ({unit})", f"following ({unit})")
    names = listed([k.partition("@")[0].replace("_", " ") for k in found.effects])
    caption = f"Compensation of {names} from the measured position, under the gains as they were, beside new gains."
    advice = take(vars(closed.tuned_on_declared), vars(closed.tuned_on_extended), found)
    return [Table(columns, tuple(rows), caption, "lrrrrr"), Paragraph(ADVICE[advice])]


def absent(sentence: str) -> Chapter:
    """The chapter where the loop was not closed, and why."""
    return Chapter("The loop, closed with what was found", (Paragraph(capital(sentence)),))
