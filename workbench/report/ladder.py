"""The chapter on the ladder: regret of a gain table, move by move, and the references that it is held against."""

from collections.abc import Mapping

import numpy as np

from workbench.design.climb import Climbed
from workbench.design.figures import COUNTS
from workbench.design.ladder import FEW, timed
from workbench.design.regret import Regret
from workbench.design.wording import worth_sentence
from workbench.plant import Plant
from workbench.report import numbers
from workbench.report.contents import Chapter, Figure, Paragraph, Table
from workbench.report.drawing import AFTER, BEFORE, MUTED, decades, svg

WIDE = 10.0  # regret from which on a drawing is logarithmic: below, steps of a tenth are to be seen


def ladder_chapter(
    climbed: Climbed, held: Regret, plant: Plant, rule: str, fewer: Mapping[str, Regret], others: Mapping[str, Regret]
) -> Chapter:
    """What the table takes over a reference for each move alone. held: regret on the plant that judges; fewer: of what has fewer
    levels, tuned alike; others: of controllers that were tuned for one step."""
    scenarios = len(set(climbed.on.scenarios))
    text = (
        f"{_served(held)} It is of rule {rule} and tuned for {len(climbed.on.moves)} moves at once: steps of ten counts to the full travel, both "
        "ways, from rest and after a reversal, without and with a load, a slow sine across zero speed and a step of load, each "
        f"the worst of {scenarios} case{'s' * (scenarios > 1)} of friction and inertia. Each move has a reference: a fixed PD that is tuned "
        "for it alone with the same limits, or this law with numbers for it alone where that is better. Regret is the "
        f"ratio of what the table takes to what its reference takes. {_runs_sentence(climbed)}"
    )
    return Chapter(
        "One table for every move",
        (
            Paragraph(text),
            _figure(climbed, held, plant),
            _references_table(climbed, held, plant),
            Paragraph(_worst_sentence(climbed, held, plant, rule)),
            Paragraph(worth_sentence(held, fewer)),
            _others_table({climbed.best.family.name: held, **fewer, **others}),
        ),
    )


def _served(held: Regret) -> str:
    """Say what one table takes over gains for each move alone."""
    if held.restless:
        return f"One table does not serve every move: it comes to no rest on {held.restless} of {held.time.size}."
    time, error, over = held.worst
    return (
        f"One table serves every move: it takes at most {numbers.number(time)} times as long as gains for one move alone, ends at most "
        f"{numbers.number(error)} times as far off (or {COUNTS:g} counts), and overshoots by {numbers.percent(over)} at most."
    )


def _others_table(regrets: Mapping[str, Regret]) -> Table:
    """The worst regret of every controller on the same ladder."""

    rows = tuple(
        (n, _cell(r.worst[0]), _cell(r.worst[1]), numbers.percent(r.worst[2]) if np.isfinite(r.worst[2]) else "–")
        for n, r in regrets.items()
    )
    caption = (
        "Worst regret over the same moves, against the same references. The table, fixed gains and the switch are tuned for all "
        "moves; the others for the one step of the task, so that they may be slow or restless on small ones."
    )
    return Table(("controller", "time", "error", "overshoot"), rows, caption, "lrrr")


def _worst_sentence(climbed: Climbed, held: Regret, plant: Plant, rule: str) -> str:
    """Say which move takes most over its reference, and what longer steps take."""
    on = climbed.on
    row, history = np.unravel_index(int(held.time.argmax()), held.time.shape)
    move, size = on.rungs[row][0], f"{numbers.scaled(abs(on.rungs[row][0].size), plant.displacement)}"
    text = (
        f"The most time over its reference is taken by a step of {size} {('from rest', 'after a reversal')[history]}"
        f"{', loaded' if move.load else ''}; steps of more than {FEW:g} counts take at most {numbers.number(_long(climbed, held))} times "
        "theirs."
    )
    if rule != "error" or not 0.0 < abs(move.size) < FEW * on.task.loop.count:
        return text
    allowed = COUNTS * on.task.loop.count / abs(move.size)
    return text + (
        f" A step as short may overshoot by {COUNTS:g} counts, {numbers.percent(allowed)} of it. Under the rule “error” the table's gains "
        "at that amplitude end every longer step, too, of which two counts are less; its reference has gains for it alone."
    )


def _long(climbed: Climbed, held: Regret) -> float:
    """Return the worst regret in time of steps of more than FEW counts."""
    least = FEW * climbed.on.task.loop.count
    long = np.array([r[0].kind == "step" and abs(r[0].size) > least for r in climbed.on.rungs])
    return float(held.time[long].max()) if long.any() else 1.0


def _cell(value: float) -> str:
    return numbers.number(value) if np.isfinite(value) else "not at rest"


def _rested(value: float, unit: str) -> str:
    return numbers.scaled(value, unit) if np.isfinite(value) else "not at rest"


def _runs_sentence(climbed: Climbed) -> str:
    return (
        f"Of {len(climbed.runs)} searches from other seeds none ends more than {numbers.percent(climbed.spread - 1.0)} above "
        "the best."
    )


def _figure(climbed: Climbed, held: Regret, plant: Plant) -> Figure:
    """Regret over the size of a step."""
    time, error, _ = held.worst
    heading = (
        f"Over all sizes the table takes at most {numbers.number(time)} times its reference's time, {numbers.number(error)} times its error"
        if not held.restless
        else f"The table comes to rest on {held.time.size - held.restless} of {held.time.size} moves"
    )
    rows = np.flatnonzero(timed(climbed.on)[:, 0])
    size = np.array([abs(climbed.on.rungs[r][0].size) for r in rows])
    laden = np.array([climbed.on.rungs[r][0].load != 0.0 for r in rows])

    def draw(axes):
        for axis, values, name in ((axes[0], held.time, "time"), (axes[1], held.error, "error")):
            for history, mark in ((0, "o"), (1, "s")):
                for loaded, colour in ((False, AFTER), (True, BEFORE)):
                    at = laden == loaded
                    label = f"{'loaded' if loaded else 'no load'}, {('from rest', 'after a reversal')[history]}"
                    axis.semilogx(size[at], values[rows][at, history], mark, ms=4, color=colour, label=label, alpha=0.8)
            axis.axhline(1.0, color=MUTED, lw=0.8)
            if np.max(values[np.isfinite(values)], initial=1.0) > WIDE:
                axis.set_yscale("log")
                decades(axis.yaxis)
            axis.set_ylabel(f"regret in {name}")
            decades(axis.xaxis)
        axes[1].set_xlabel(numbers.label("step", numbers.unit(plant.displacement)))
        axes[0].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))

    return Figure(
        "ladder",
        lambda: svg(heading, draw, rows=2, height=4.4, share=True),
        "Time and error over those of a reference for each move alone, worst over friction and inertia.",
        f"Two graphs over the size of a step. {heading}.",
    )


def _references_table(climbed: Climbed, held: Regret, plant: Plant) -> Table:
    """The reference of each size, the worst of its moves beside it."""
    on, known = climbed.on, climbed.references
    rows = []
    for size in sorted({abs(r[0].size) for r, t in zip(on.rungs, timed(on)[:, 0], strict=True) if t}):
        at = [k for k, r in enumerate(on.rungs) if r[0].kind == "step" and abs(r[0].size) == size]
        rows.append(
            (
                numbers.scaled(size, plant.displacement),
                *(_rested(float(f(known.time[at])), "s") for f in (np.min, np.max)),
                *(_rested(float(f(known.error[at])), plant.displacement) for f in (np.min, np.max)),
                _cell(float(held.time[at].max())),
                _cell(float(held.error[at].max())),
                numbers.percent(over) if np.isfinite(over := float(held.overshoot[at].max())) else "–",
            )
        )
    columns = ("step", "reference: 1 % time from", "to", "error from", "to", "worst regret: time", "error", "overshoot")
    return Table(columns, tuple(rows), "References over the moves of one size, and the table's worst regret.", "r" * 8)


def as_table(climbed: Climbed, held: Regret, others: Mapping[str, Regret]) -> dict[str, object]:
    """What results.json holds: every move with its reference and the table's regret, every run of the search, and the worst regrets
    of other controllers."""
    on, known = climbed.on, climbed.references
    moves = [
        {
            **vars(move), "reference": {"law": str(known.law[r, h]), "time": known.time[r, h], "error": known.error[r, h]},
            "regret_time": held.time[r, h], "regret_error": held.error[r, h], "overshoot": held.overshoot[r, h],
        }
        for r, rung in enumerate(on.rungs)
        for h, move in enumerate(rung)
    ]  # fmt: skip
    runs = [{"seed": c.seed, "cost": c.value, "numbers": c.numbers} for c in climbed.runs]
    worst = {n: dict(zip(("time", "error", "overshoot"), r.worst, strict=True)) for n, r in others.items()}
    return {"moves": moves, "runs": runs, "others": worst, "scenarios": [list(s) for s in dict.fromkeys(on.scenarios)]}


def figures_of(climbed: Climbed, held: Regret) -> dict[str, float]:
    """Return the figures by which a study may be judged."""
    time, error, over = held.worst
    return {
        "ladder_regret_time": time,
        "ladder_regret_time_long": _long(climbed, held),
        "ladder_regret_error": error,
        "ladder_overshoot": over,
        "search_spread": climbed.spread,
    }
