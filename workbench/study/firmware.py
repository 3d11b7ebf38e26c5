"""The recommended controller as firmware, and what is compensated: files, page, and figures."""

from collections.abc import Callable, Mapping

from workbench.compensation import Compensated
from workbench.control import Controller
from workbench.design.climb import Climbed
from workbench.firmware.every import every_firmware
from workbench.firmware.image import verdict_of
from workbench.report.firmware import as_table, firmware_chapter
from workbench.study.outcome import Part
from workbench.study.wording import no_firmware
from workbench.task.task import Task


def as_firmware(tuned: Mapping[str, object], first: str) -> dict[str, Callable[[int], Controller]]:
    """Return name -> controller(lanes) of what becomes firmware: the recommended one first, and what is compensated."""
    paired = [n for n, t in tuned.items() if n != first and isinstance(t.controller(1), Compensated)]
    return {n: tuned[n].controller for n in (first, *paired)}


def firmware_part(
    named: Mapping[str, Callable[[int], Controller]], task: Task, traced: str, say, climbed: Climbed | None = None
) -> Part:
    """Return the firmware's part of a study; a finding where it has none (a drive without a limit, no counts).

    named: name -> controller(lanes), the recommended one first; beside it those whose compensation is firmware too. traced: the
    trace's verdict, which the table keeps; whether requirements are met is not known before the study ends. climbed: as of
    `every_firmware`.
    """
    say("writing the firmware")
    found = every_firmware(named, task, verdict_of(None, traced), climbed)
    refused = tuple(no_firmware(r.controller, r.arithmetic, r.why) for r in found.refused)
    if not found.made:
        return Part(findings=refused)
    chapter = firmware_chapter({n: (made, found.folders[n]) for n, made in found.made.items()}, found.beside)
    first, *others = (as_table(n, made) for n, made in found.made.items())
    return Part(found.figures, {}, (chapter,), refused, {"firmware": first | {"beside": others}}, (found.write,))
