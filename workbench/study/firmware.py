"""The recommended controller as firmware: its files, its page, and its figures."""

from collections.abc import Callable
from pathlib import Path

from workbench.control import Controller
from workbench.errors import WorkbenchError
from workbench.finding import Finding
from workbench.firmware.export import export_firmware
from workbench.firmware.image import verdict_of
from workbench.firmware.make import ARITHMETICS
from workbench.firmware.summary import summary
from workbench.report.firmware import as_table, firmware_chapter
from workbench.study.outcome import Part
from workbench.verification.task import Task

FOLDER = "firmware"
NONE = "no firmware"


def firmware_part(name: str, controller: Callable[[int], Controller], task: Task, traced: str, say) -> Part:
    """Return the firmware's part of a study; a finding where it has none (a drive without a limit, no counts).

    controller(lanes). traced: the trace's verdict, which the table keeps; whether requirements are met is not known before the study ends.
    """
    say("writing the firmware")
    made, refused = [], []
    for kind in ARITHMETICS:
        try:
            made.append(summary(controller, task, kind, verdict_of(None, traced)))
        except WorkbenchError as error:
            refused.append(Finding(NONE, kind, f"There is no firmware in {kind}: {error}", {}, ""))
    if not made:
        return Part(findings=tuple(refused))

    def write(folder: Path) -> None:
        for s in made:
            export_firmware(s.made, folder / FOLDER / s.arithmetic)

    figures = {}
    if all(s.moved for s in made):
        figures["firmware_error_counts"] = max(s.moved.error for s in made)
        figures["firmware_bits_equal"] = min(s.moved.same / s.moved.samples for s in made)
    chapter = firmware_chapter(name, made, FOLDER)
    return Part(figures, {}, (chapter,), tuple(refused), {"firmware": as_table(name, made)}, (write,))
