"""Equivalent stiffness and loss over amplitude: what a controller sees of the nonlinearity."""

import numpy as np

from workbench.description.result import Equivalent
from workbench.finding import capital
from workbench.report import figures, numbers
from workbench.report.contents import Chapter, Figure, Paragraph, StudyResult, Table
from workbench.report.wording import listed

ROWS = 8
ROUNDING = 1e-9  # of the stiffness: a loss of less is what rounding leaves of a spring (1e-11 of it was met); halved or doubled, the same


def description(result: StudyResult) -> Chapter | None:
    """The curves, and a small table of them; None where nothing was described."""
    if not result.equivalent:
        return None
    names = listed([e.title for e, _ in result.equivalent])
    text = (
        f"{_lossy(result)} Under a sinusoidal motion of amplitude A, {names} {'acts' if len(result.equivalent) == 1 else 'act'} in the first "
        "harmonic like a spring k\u2091 with a damper c\u2091. A is zero to peak, half of the stroke between reversals. The loss "
        "c\u2091\u03c9 does not depend on frequency where the effect does not; the energy lost in a cycle is \u03c0A\u00b2c\u2091\u03c9."
    )
    return Chapter("Equivalent stiffness and loss over amplitude", (Paragraph(text), _drawn(result), _table(result)))


def _drawn(result: StudyResult) -> Figure:
    """Stiffness and loss over amplitude."""
    curves = [(e.title, q) for e, q in result.equivalent]
    heading = _falling(result)
    caption = f"Equivalent stiffness (top) and loss (bottom) over amplitude, of {listed([n for n, _ in curves])}."
    draw = lambda: figures.description(heading, curves, result.plant.rotary)  # noqa: E731
    return Figure("equivalent", draw, caption, f"Two graphs over amplitude. {heading}.")


def _lost(q: Equivalent, i: int) -> float:
    """Return the loss at one amplitude; 0 where it is what rounding leaves of a spring."""
    return 0.0 if abs(q.loss[i]) < ROUNDING * abs(q.stiffness[i]) else float(q.loss[i])


def _lossy(result: StudyResult) -> str:
    """Say of the effect that is described first how much of it is spring and how much loss, at both ends of the amplitudes."""
    effect, q = result.equivalent[0]
    unit = result.plant.displacement
    ends = [
        f"{numbers.number(_lost(q, i) / float(q.stiffness[i]), 2)} times its stiffness at {numbers.scaled(float(q.amplitude[i]), unit, 2)}"
        for i in (0, -1)
        if q.stiffness[i]
    ]
    return (
        f"The loss of {effect.title} is {listed(ends)}."
        if ends
        else f"{capital(effect.title)} is no spring, but a loss."
    )


def _falling(result: StudyResult) -> str:
    """Say by how much the stiffness changes over the amplitudes, for the effect in which it changes most."""
    unit = result.plant.displacement

    def change(pair) -> float:
        first, last = (abs(float(pair[1].stiffness[i])) for i in (0, -1))
        return first / last if first > 0 and last > 0 else 1.0

    effect, q = max(result.equivalent, key=lambda pair: abs(np.log(change(pair))))
    ratio = change((effect, q))
    low, high = (numbers.scaled(float(q.amplitude[i]), unit, 2) for i in (0, -1))
    if 0.9 < ratio < 1.1:
        return f"Equivalent stiffness hardly changes from {low} to {high}"
    verb = "falls" if ratio > 1 else "rises"
    first, last = (numbers.quantity(float(q.stiffness[i]), f"{result.plant.effort}/{unit}") for i in (0, -1))
    return f"Stiffness of {effect.title} {verb} from {first} at {low} to {last} at {high}"


def _table(result: StudyResult) -> Table:
    """A few amplitudes of each curve."""
    rotary = result.plant.rotary
    unit = "N\u00b7m/rad" if rotary else "N/m"
    rows = []
    for effect, q in result.equivalent:
        for k, i in enumerate(np.unique(np.linspace(0, q.amplitude.size - 1, ROWS).astype(int))):
            values = (float(q.stiffness[i]), _lost(q, i))
            amplitude = numbers.scaled(float(q.amplitude[i]), result.plant.displacement)
            loss_factor = numbers.number(_lost(q, i) / float(q.stiffness[i]), 2) if q.stiffness[i] else "\u2013"
            name = capital(effect.title) if k == 0 else ""
            rows.append((name, amplitude, *map(numbers.number, values), loss_factor))
    columns = (
        "effect",
        "amplitude",
        f"k\u2091 ({unit})",
        f"c\u2091\u03c9 ({unit})",
        "loss factor c\u2091\u03c9 / k\u2091",
    )
    return Table(columns, tuple(rows), "Equivalent stiffness and loss at a few amplitudes.", "prrrr")
