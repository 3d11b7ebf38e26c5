"""A gain table on its ladder of moves where the compiled firmware closes the loop."""

from functools import partial

from workbench.design.climb import Climbed
from workbench.design.regret import Regret
from workbench.design.worth import regret_of
from workbench.errors import WorkbenchError
from workbench.firmware import host
from workbench.firmware.comparison import reach
from workbench.firmware.loop import followed_by_firmware
from workbench.firmware.make import Firmware, firmware
from workbench.processes import shared
from workbench.task.task import Task

SAID = {"float32": "in float32", "fixed": "in fixed point"}


def compiled_regrets(climbed: Climbed, task: Task) -> dict[str, Regret]:
    """Return the regret of a ladder's table on the plant of a task, as compiled, by arithmetic; of none that cannot be made here.

    Commands are rounded to encoder counts, as a drive takes them; the error is against the command as it was asked for.
    """
    try:
        host.compiler()
    except WorkbenchError:
        return {}
    best, known = climbed.best, climbed.references

    def held(arithmetic: str) -> Regret | None:
        try:
            made = firmware(best.controller(1), task.loop, task.plant, arithmetic, **reach(task))
        except WorkbenchError:
            return None
        return regret_of(climbed.on, best, known, task, partial(_followed, made))

    found = zip(SAID.values(), shared(held, list(SAID)), strict=True)
    return {name: regret for name, regret in found if regret is not None}


def _followed(made: Firmware, plant, loop, controller, scenarios, references, which, lasts):
    """As `workbench.simulation.followed`, by the firmware of the controller."""
    return followed_by_firmware(made, plant, loop, scenarios, references, which, lasts)
