"""The firmware of every controller of a design in every arithmetic: what it comes to, and where it is written."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from workbench.control import Controller
from workbench.design.climb import Climbed
from workbench.design.regret import Regret
from workbench.design.worth import regret_of
from workbench.errors import WorkbenchError
from workbench.firmware.export import export_firmware
from workbench.firmware.make import ARITHMETICS
from workbench.firmware.naming import slug
from workbench.firmware.on_ladder import SAID, compiled_regrets
from workbench.firmware.summary import Summary, summaries
from workbench.task.task import Task

FOLDER = "firmware"
LADDER = ("regret_time", "regret_error", "overshoot")  # of the worst regret
BY_LAW = "by the law, in float64"


@dataclass(frozen=True)
class Refused:
    """A controller that has no firmware in one arithmetic, and why."""

    controller: str
    arithmetic: str
    why: WorkbenchError


@dataclass(frozen=True, eq=False)
class EveryFirmware:
    """made: name -> a summary an arithmetic, the recommended controller first. folders: name -> where its firmware is written, below
    the outputs. refused: what could not be made. beside: who computes the gain table -> its worst regret on its ladder; empty where
    it cannot be compiled here.
    """

    made: Mapping[str, tuple[Summary, ...]]
    folders: Mapping[str, str]
    refused: tuple[Refused, ...]
    beside: Mapping[str, Regret]

    @property
    def figures(self) -> dict[str, float]:
        """Figures by which firmware may be judged: how it moves an axis beside the law, and its regrets on the ladder."""
        each, figures = [s for found in self.made.values() for s in found], {}
        if all(s.moved for s in each):
            for arithmetic, end in (("fixed", ""), ("float32", "_float32")):
                if errors := [s.moved.final_error for s in each if s.arithmetic == arithmetic]:
                    figures[f"firmware_error_counts{end}"] = max(errors)
            figures["firmware_moves_scattered"] = max(s.moved.scattered for s in each)
            figures["firmware_bits_equal"] = min(s.moved.same / s.moved.samples for s in each)
        for arithmetic, end in (("float32", ""), ("fixed", "_fixed")):  # float32 is what the table's header computes
            if found := self.beside.get(SAID[arithmetic]):
                figures |= {f"firmware_ladder_{n}{end}": x for n, x in zip(LADDER, found.worst, strict=True)}
        return figures

    def write(self, folder: Path) -> None:
        """Write every firmware below the folder of a study's outputs."""
        for name, found in self.made.items():
            for s in found:
                export_firmware(s.made, folder / self.folders[name] / s.arithmetic)


def every_firmware(
    named: Mapping[str, Callable[[int], Controller]], task: Task, verdict: int, climbed: Climbed | None = None
) -> EveryFirmware:
    """Return the firmware of controllers (name -> controller(lanes), the recommended one first) in every arithmetic.

    verdict: which the tables keep. climbed: the ladder of the gain table, which is climbed again as compiled.
    """
    made: dict[str, list[Summary]] = {}
    refused = []
    asked = [(name, controller, arithmetic) for name, controller in named.items() for arithmetic in ARITHMETICS]
    every = summaries([(controller, arithmetic) for _, controller, arithmetic in asked], task, verdict)
    for (name, _, arithmetic), found in zip(asked, every, strict=True):
        if isinstance(found, WorkbenchError):
            refused.append(Refused(name, arithmetic, found))
        else:
            made.setdefault(name, []).append(found)
    first = next(iter(named))
    folders = {n: FOLDER if n == first else f"{FOLDER}/{slug(n)}" for n in made}
    beside = _on_ladder(climbed, task) if climbed and made else {}
    return EveryFirmware({n: tuple(found) for n, found in made.items()}, folders, tuple(refused), beside)


def _on_ladder(climbed: Climbed, task: Task) -> dict[str, Regret]:
    """Return the worst regrets of a gain table as compiled, by who computes it; nothing where it cannot be made here."""
    held = compiled_regrets(climbed, task)
    law = regret_of(climbed.on, climbed.best, climbed.references, task) if held else None
    return {BY_LAW: law, **held} if held else {}
