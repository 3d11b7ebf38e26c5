"""[compensation] of study.toml: named effects cancelled, and what that is worth on a slow motion that turns.

    [compensation]
    effects = ["presliding_hysteresis"]     # of the plant that the trace ended with, by name or by "name@at"
    source = "reference"                    # or "measured", or "observer"
    controller = "fixed PD"                 # as the comparison names it
    amplitude = { value = 0.02, unit = "rad" }
    frequency = { value = 0.2, unit = "Hz" }

Further keys: delay (samples), low_pass and bandwidth (Hz, of the observer), mismatch (share, 0.3).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.cancellation.contestant import SUFFIX, contestant
from workbench.cancellation.following import Slow, Worth, bears, worth
from workbench.compensation import OBSERVED, REFERENCE, SOURCES, Compensator
from workbench.control import Controller
from workbench.design.design import Designed
from workbench.errors import WorkbenchError, nearest
from workbench.finding import Finding, title
from workbench.plant import Plant
from workbench.report import numbers
from workbench.report.contents import Chapter, Figure, Paragraph, Table
from workbench.report.drawing import AFTER, BEFORE, svg
from workbench.report.wording import listed, typeset
from workbench.study.configuration import Study
from workbench.study.outcome import Part
from workbench.task.task import Task

KEYS = ("effects", "controller", "amplitude", "frequency")
MORE = ("source", "delay", "low_pass", "bandwidth", "mismatch")
MISMATCH = 0.3


@dataclass(frozen=True)
class Asked:
    """What [compensation] says. options: of the compensator. where: the file and table that say it."""

    effects: tuple[str, ...]
    controller: str
    slow: Slow
    mismatch: float
    options: Mapping[str, object]
    where: str = "[compensation]"

    def on(self, plant: Plant) -> Compensator:
        """Return the compensator of these effects as a plant has them."""
        options = dict(self.options)
        if options.get("source") == OBSERVED:
            options["mass"] = sum(e.parameters["inertia"].value for e in plant.effects if e.name == "inertia")
        return Compensator.of(plant, self.effects, **options)


def asked(study: Study, plant: Plant, of: str = "") -> Asked:
    """Return what [compensation] asks for, or its table of a name, which may have one of its own; WorkbenchError names file and key."""
    further = tuple(n for n, v in study.table.values["compensation"].items() if isinstance(v, dict) and "effects" in v)
    one = study.table.table("compensation", KEYS, (*KEYS, *MORE, *further))
    one = one.table(of, KEYS, (*KEYS, *MORE)) if of else one
    x = plant.displacement
    effects = one.values["effects"]
    if not (isinstance(effects, list) and effects and all(isinstance(e, str) for e in effects)):
        raise WorkbenchError(f"{one.path('effects')}: give a list of names of effects.")
    slow = Slow(one.quantity("amplitude", x, above=0.0), one.quantity("frequency", "Hz", above=0.0))
    options = {
        "source": one.choice("source", SOURCES, "source") if "source" in one else REFERENCE,
        "delay": int(one.number("delay", 0)),
        "low_pass": one.quantity("low_pass", "Hz", above=0.0) if "low_pass" in one else 0.0,
        "bandwidth": one.quantity("bandwidth", "Hz", above=0.0) if "bandwidth" in one else 0.0,
    }
    off = one.number("mismatch", MISMATCH, above=0.0)
    return Asked(tuple(effects), one.text("controller"), slow, off, options, study.table.path("compensation"))


def compensation(
    study: Study, task: Task, factories: Mapping[str, Callable[[int], Controller]], say, model: Plant | None = None,
    margins: Callable[[str, Compensator, Sequence[float]], Mapping[float, float]] | None = None, of: str = "",
) -> Part:  # fmt: skip
    """Return what compensation of named effects is worth on the plant of a task, to the controller with the gains that it has.

    model: the plant whose effects are taken, that of the task where absent. Where the two differ the task's is the rig's true
    law, and what compensation by that attains stands beside. Figures: compensation_following_ratio, its share of that
    attained by the true law (compensation_over_true), and the ratio with the mismatch. margins: (controller, compensator,
    gains) -> gain -> Ms of the loop with the compensation; the figures compensation_sensitivity, and _off with the mismatch. of:
    name of the table [compensation.of], after which its figures are then called.
    """
    given = asked(study, task.plant, of)
    chosen(given, factories)
    say("compensating what was named")
    controller = factories[given.controller](len(FOUR))
    found = worth(task.plant, task.loop, controller, given.on(model or task.plant), given.slow, given.mismatch)
    true = found
    if model is not None and model.digest != task.plant.digest:
        true = worth(task.plant, task.loop, controller, given.on(task.plant), given.slow, given.mismatch)
    figures = {
        "compensation_following_ratio": found.ratio,
        "compensation_following_ratio_true": true.ratio,
        "compensation_over_true": found.ratio / true.ratio,
        "compensation_following_ratio_off": found.off(given.mismatch),
        "following_error_alone": found.errors[0.0],
        "following_error_compensated": found.errors[1.0],
    }
    ms = margins(given.controller, given.on(model or task.plant), tuple(found.errors)) if margins else {}
    if ms:
        figures |= {"compensation_sensitivity": ms[1.0], "compensation_sensitivity_off": max(ms.values())}
    x = task.plant.displacement
    units = dict.fromkeys(("following_error_alone", "following_error_compensated"), x)
    rows = [{"gain": g, "following_error": e, "sensitivity": ms.get(g)} for g, e in found.errors.items()]
    said = _fallen(given, task, factories[given.controller](1))
    chapter = _chapter(given, found, true, x, ms, of)
    return Part(
        _named(figures, of), _named(units, of), (chapter,), said, {f"compensation{f'_{of}' if of else ''}": rows}
    )


def _named(values: dict, of: str) -> dict:
    """Return values by name, of a further compensation with its name behind."""
    return {f"{n}_{of}" if of else n: v for n, v in values.items()}


def chosen(given: Asked, controllers: Mapping[str, object]) -> None:
    """Raise WorkbenchError where [compensation] names a controller that there is not."""
    if given.controller not in controllers:
        raise WorkbenchError(
            f"{given.where}: there is no controller '{given.controller}'; {nearest(given.controller, controllers)}"
        )


def with_compensated(
    made: Designed, given: Asked | None, task: Task, seeds: Sequence[int], say: Callable[[str], None]
) -> Designed:
    """Return the design with the controller of [compensation] beside the others, with the compensation and tuned with it."""
    if given is None:
        return made
    chosen(given, made.tuned)
    one = contestant(made, task, given.controller, given.on(made.plant), seeds, say)
    return replace(made, tuned={**made.tuned, f"{given.controller}{SUFFIX}": one})


def _fallen(given: Asked, task: Task, controller: Controller) -> tuple[Finding, ...]:
    """Return a finding where the controller does not stand on the plant that its compensation leaves, which sees its motion."""
    compensator = given.on(task.plant)
    if compensator.source == REFERENCE or bears(task.plant, task.loop, controller, compensator, given.slow):
        return ()
    sentence = (
        f"Without {' and '.join(given.effects)} the controller “{given.controller}” does not follow a slow motion: what is to be "
        "cancelled is what holds the loop up."
    )
    return (
        Finding(
            "not stable alone", "compensation", sentence, {}, "raise its gains first, or compensate from the reference"
        ),
    )


FOUR = range(4)  # lanes: without, with, and off either way


def _chapter(given: Asked, found: Worth, true: Worth, x: str, ms: Mapping[float, float], of: str = "") -> Chapter:
    """What it is worth, in a table and over time. ms: gain -> Ms. of: name of a further compensation."""
    names = listed([title(e.partition("@")[0]) for e in given.effects])
    source = given.options["source"]
    share = given.mismatch
    heading = f"Compensated, the error of a slow motion that turns is {numbers.number(found.ratio, 2)} times smaller"
    feedback = (
        "It hangs on the reference alone, so the loop's margins are what they were."
        if source == REFERENCE
        else "It closes a path of its own around the plant: margins are those of the plant without these effects."
    )
    off, left = (numbers.scaled(found.errors[g], x) for g in (0.0, 1.0))
    text = (
        f"The largest following error of a slow motion falls from {off} to {left} once the command gets what {names} will take of it, "
        f"from the {source} position, by the definition that simulation and identification have. The controller is “{given.controller}”, the motion a sine of {numbers.scaled(given.slow.amplitude, x)} "
        f"at {given.slow.frequency:g} Hz. {feedback}"
    )
    labels = {0.0: "none", 1.0: "as identified"} | {
        1.0 + s: f"{typeset(f'{100 * s:+.0f}')} % of it" for s in (-share, share)
    }
    rows = [
        (labels[g], numbers.scaled(found.errors[g], x), _factor(found.errors[0.0] / found.errors[g]) if g else "", _margin(ms, g))
        for g in labels
    ]  # fmt: skip
    if true is not found:
        rows.append(("by the plant's true law", numbers.scaled(true.errors[1.0], x), _factor(true.ratio), ""))
    columns = ("compensation", "largest following error", "smaller by", "Ms")
    caption = (
        "Following error over the last two periods. Ms: the largest |S| of the linearised loop with the compensation in it, "
        "over amplitudes from two counts to gross sliding."
    )
    kept = slice(None) if ms else slice(3)
    table = Table(
        columns[kept], tuple(r[kept] for r in rows), caption if ms else caption.split(" Ms:")[0], "lrrr"[kept]
    )

    def draw(axes):
        (a,) = axes
        scale, shown = numbers.prefixed(found.errors[0.0], x)
        step = max(found.time.size // 2000, 1)
        a.plot(found.time[::step], scale * found.without[::step], color=BEFORE, label="without")
        a.plot(found.time[::step], scale * found.with_it[::step], color=AFTER, label="compensated")
        a.set_xlabel("time (s)")
        a.set_ylabel(f"r − q ({shown})")
        a.legend(loc="upper right")

    figure = Figure(
        f"compensation_{of}" if of else "compensation",
        lambda: svg(heading, draw, height=2.6),
        "Error over time.",
        f"Two traces. {heading}.",
    )
    return Chapter("Compensation of what was named" + (f": the {of}" if of else ""), (Paragraph(text), table, figure))


def _margin(ms: Mapping[float, float], gain: float) -> str:
    """Ms at one gain of the compensation, as a table shows it."""
    value = ms.get(gain, np.nan)
    return numbers.number(value) if np.isfinite(value) else "unstable" if gain in ms else ""


def _factor(ratio: float) -> str:
    return f"{numbers.number(ratio, 2)} times" if np.isfinite(ratio) else "it does not follow"
