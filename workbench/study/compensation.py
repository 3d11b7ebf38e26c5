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

from workbench.cancellation.following import Slow
from workbench.cancellation.worth import Cancellation, Factories, Margins, cancellation_worth
from workbench.compensation import REFERENCE, SOURCES
from workbench.errors import WorkbenchError
from workbench.plant import Plant
from workbench.report.compensation import compensation_chapter
from workbench.study.configuration import Study
from workbench.study.outcome import Part
from workbench.task.task import Task

KEYS = ("effects", "controller", "amplitude", "frequency")
MORE = ("source", "delay", "low_pass", "bandwidth", "mismatch")
MISMATCH = 0.3


def asked(study: Study, plant: Plant, of: str = "") -> Cancellation:
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
    return Cancellation(tuple(effects), one.text("controller"), slow, off, options, study.table.path("compensation"))


def compensation(
    study: Study, task: Task, factories: Factories, say: Callable[[str], None], model: Plant | None = None,
    margins: Margins | None = None, of: str = "",
) -> Part:  # fmt: skip
    """Return what compensation of named effects is worth on the plant of a task, to the controller with the gains that it has.

    model, margins: as of `cancellation_worth`. of: name of the table [compensation.of], after which its figures are then called.
    """
    given = asked(study, task.plant, of)
    say("compensating what was named")
    found = cancellation_worth(given, task, factories, model, margins)
    x = task.plant.displacement
    units = dict.fromkeys(("following_error_alone", "following_error_compensated"), x)
    tables = {f"compensation{f'_{of}' if of else ''}": found.rows}
    chapter = compensation_chapter(found, x, of)
    return Part(_named(found.figures, of), _named(units, of), (chapter,), found.findings, tables)


def _named(values: Mapping, of: str) -> dict:
    """Return values by name, of a further compensation with its name behind."""
    return {f"{n}_{of}" if of else n: v for n, v in values.items()}
