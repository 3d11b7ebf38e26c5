"""[compensation] of study.toml: named effects cancelled, and what that is worth on a slow motion that turns.

    [compensation]
    effects = ["presliding_hysteresis"]     # of the plant that the trace ended with, by name or by "name@at"
    source = "reference"                    # or "measured", or "observer"
    controller = "fixed PD"                 # as the comparison names it
    amplitude = { value = 0.02, unit = "rad" }
    frequency = { value = 0.2, unit = "Hz" }

Further keys: delay (samples), low_pass and bandwidth (Hz, of the observer), mismatch (share, 0.3).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from workbench.compensation import OBSERVED, REFERENCE, SOURCES, Compensator, compensated
from workbench.control import Controller
from workbench.errors import WorkbenchError, nearest
from workbench.finding import Finding, title
from workbench.plant import Plant
from workbench.report import numbers
from workbench.report.contents import Chapter, Figure, Paragraph, Table
from workbench.report.drawing import AFTER, BEFORE, svg
from workbench.report.wording import listed
from workbench.study.configuration import Study
from workbench.study.outcome import Part
from workbench.verification.compensating import Slow, Worth, bears, worth
from workbench.verification.task import Task

KEYS = ("effects", "controller", "amplitude", "frequency")
MORE = ("source", "delay", "low_pass", "bandwidth", "mismatch")
MISMATCH = 0.3


@dataclass(frozen=True)
class Asked:
    """What [compensation] says. options: of the compensator."""

    effects: tuple[str, ...]
    controller: str
    slow: Slow
    mismatch: float
    options: Mapping[str, object]

    def on(self, plant: Plant) -> Compensator:
        """Return the compensator of these effects as a plant has them."""
        options = dict(self.options)
        if options.get("source") == OBSERVED:
            options["mass"] = sum(e.parameters["inertia"].value for e in plant.effects if e.name == "inertia")
        return Compensator.of(plant, self.effects, **options)


def asked(study: Study, plant: Plant) -> Asked:
    """Return what [compensation] asks for; WorkbenchError names file and key."""
    one = study.table.table("compensation", KEYS, (*KEYS, *MORE))
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
    return Asked(tuple(effects), one.text("controller"), slow, one.number("mismatch", MISMATCH, above=0.0), options)


def compensation(
    study: Study, task: Task, makers: Mapping[str, Callable[[int], Controller]], say, model: Plant | None = None
) -> Part:
    """Return what compensation of named effects is worth on the plant of a task.

    model: the plant whose effects are taken, that of the task where absent. Where the two differ the task's is the rig's true
    law, and what compensation by that attains stands beside. Figures: compensation_following_ratio, its share of that
    attained by the true law (compensation_over_true), and the ratio with the mismatch.
    """
    given = asked(study, task.plant)
    if given.controller not in makers:
        raise WorkbenchError(
            f"{study.table.path('compensation')}: there is no controller '{given.controller}'; "
            f"{nearest(given.controller, makers)}"
        )
    say("compensating what was named")
    controller = makers[given.controller](len(FOUR))
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
    x = task.plant.displacement
    units = dict.fromkeys(("following_error_alone", "following_error_compensated"), x)
    rows = [{"gain": g, "following_error": e} for g, e in found.errors.items()]
    said = fallen(given, task, makers[given.controller](1))
    return Part(figures, units, (chapter(given, found, true, x),), said, {"compensation": rows})


def fallen(given: Asked, task: Task, controller: Controller) -> tuple[Finding, ...]:
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


def compensated_makers(study: Study, plant: Plant, makers: Mapping[str, Callable[[int], Controller]]) -> dict:
    """Return name -> maker of the controller of [compensation] with it; it is compared as any other."""
    given = asked(study, plant)
    if given.controller not in makers:
        return {}
    compensator = given.on(plant)
    return {f"{given.controller}, compensated": lambda lanes: compensated(makers[given.controller](lanes), compensator)}


FOUR = range(4)  # lanes: without, with, and off either way


def chapter(given: Asked, found: Worth, true: Worth, x: str) -> Chapter:
    """What it is worth, in a table and over time."""
    names = listed([title(e.partition("@")[0]) for e in given.effects])
    source = given.options["source"]
    share = given.mismatch
    heading = f"Compensated, the error of a slow motion that turns is {numbers.number(found.ratio, 2)} times smaller"
    feedback = (
        "It hangs on the reference alone, so the loop's margins are what they were."
        if source == REFERENCE
        else "It closes a path of its own around the plant: margins are those of the plant without these effects."
    )
    text = (
        f"The command gets what {names} will take of it, from the {source} position, by the definition that simulation and "
        f"identification have. The controller is “{given.controller}”, the motion a sine of {numbers.scaled(given.slow.amplitude, x)} "
        f"at {given.slow.frequency:g} Hz. {feedback}"
    )
    rows = [
        ("without", numbers.scaled(found.errors[0.0], x), ""),
        ("compensated", numbers.scaled(found.errors[1.0], x), factor(found.ratio)),
        *(
            (f"compensation {100 * s:+.0f} %", numbers.scaled(found.errors[1.0 + s], x), factor(found.errors[0.0] / found.errors[1.0 + s]))
            for s in (-share, share)
        ),
    ]  # fmt: skip
    if true is not found:
        rows.append(("by the plant's true law", numbers.scaled(true.errors[1.0], x), factor(true.ratio)))
    table = Table(
        ("", "largest following error", "smaller by"), tuple(rows), "Following error over the last two periods.", "lrr"
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
        "compensation", lambda: svg(heading, draw, height=2.6), "Error over time.", f"Two traces. {heading}."
    )
    return Chapter("Compensation of what was named", (Paragraph(text), table, figure))


def factor(ratio: float) -> str:
    return f"{numbers.number(ratio, 2)} times" if np.isfinite(ratio) else "it does not follow"
