"""The recommended controller as firmware, and what is compensated: files, page, and figures."""

from collections.abc import Callable, Mapping
from pathlib import Path

from workbench.compensation import Compensated
from workbench.control import Controller
from workbench.design.climb import Climbed
from workbench.design.regret import Regret
from workbench.design.worth import regret_of
from workbench.errors import WorkbenchError
from workbench.exporting.numbers import slug
from workbench.finding import Finding
from workbench.firmware.export import export_firmware
from workbench.firmware.image import verdict_of
from workbench.firmware.make import ARITHMETICS
from workbench.firmware.on_ladder import SAID, compiled_regrets
from workbench.firmware.summary import summaries
from workbench.report.firmware import as_table, firmware_chapter
from workbench.study.outcome import Part
from workbench.task.task import Task

FOLDER = "firmware"
NONE = "no firmware"


def as_firmware(tuned: Mapping[str, object], first: str) -> dict[str, Callable[[int], Controller]]:
    """Return name -> controller(lanes) of what becomes firmware: the recommended one first, and what is compensated."""
    paired = [n for n, t in tuned.items() if n != first and isinstance(t.controller(1), Compensated)]
    return {n: tuned[n].controller for n in (first, *paired)}


def firmware_part(
    named: Mapping[str, Callable[[int], Controller]], task: Task, traced: str, say, climbed: Climbed | None = None
) -> Part:
    """Return the firmware's part of a study; a finding where it has none (a drive without a limit, no counts).

    named: name -> controller(lanes), the recommended one first; beside it those whose compensation is firmware too. traced: the
    trace's verdict, which the table keeps; whether requirements are met is not known before the study ends. climbed: the ladder of the
    gain table, which is climbed again as compiled.
    """
    say("writing the firmware")
    made, refused = {}, []
    asked = [(name, controller, kind) for name, controller in named.items() for kind in ARITHMETICS]
    every = summaries([(controller, kind) for _, controller, kind in asked], task, verdict_of(None, traced))
    for (name, _, kind), found in zip(asked, every, strict=True):
        if isinstance(found, WorkbenchError):
            refused.append(Finding(NONE, kind, f"There is no firmware of {name} in {kind}: {found}", {}, ""))
        else:
            made.setdefault(name, []).append(found)
    made = {n: tuple(found) for n, found in made.items() if found}
    if not made:
        return Part(findings=tuple(refused))
    first = next(iter(named))
    folders = {n: FOLDER if n == first else f"{FOLDER}/{slug(n)}" for n in made}

    def write(folder: Path) -> None:
        for name, found in made.items():
            for s in found:
                export_firmware(s.made, folder / folders[name] / s.arithmetic)

    each = [s for found in made.values() for s in found]
    figures = {}
    if all(s.moved for s in each):
        for kind, name in (("fixed", ""), ("float32", "_float32")):
            if errors := [s.moved.final_error for s in each if s.arithmetic == kind]:
                figures[f"firmware_error_counts{name}"] = max(errors)
        figures["firmware_moves_scattered"] = max(s.moved.scattered for s in each)
        figures["firmware_bits_equal"] = min(s.moved.same / s.moved.samples for s in each)
    more, beside = _on_ladder(climbed, task) if climbed else ({}, {})
    figures |= more
    chapter = firmware_chapter({n: (found, folders[n]) for n, found in made.items()}, beside)
    tables = [as_table(n, found) for n, found in made.items()]
    return Part(figures, {}, (chapter,), tuple(refused), {"firmware": tables[0] | {"beside": tables[1:]}}, (write,))


def _on_ladder(climbed: Climbed, task: Task) -> tuple[dict[str, float], dict[str, Regret]]:
    """Return the worst regrets of a gain table as compiled, and by who computes it; nothing where it cannot be made here."""
    held = compiled_regrets(climbed, task)
    if not held:
        return {}, {}
    figures = {}
    for arithmetic, suffix in (("float32", ""), ("fixed", "_fixed")):  # float32 is what the table's header computes
        if found := held.get(SAID[arithmetic]):
            names = ("regret_time", "regret_error", "overshoot")
            figures |= {f"firmware_ladder_{n}{suffix}": x for n, x in zip(names, found.worst, strict=True)}
    law = regret_of(climbed.on, climbed.best, climbed.references, task)
    return figures, {"by the law, in float64": law, **held}
