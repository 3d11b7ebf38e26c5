"""A study's axes driven by its firmware: the compiled C in the loop, compared with the law in float64."""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from workbench.compensation import Compensated
from workbench.errors import WorkbenchError, nearest
from workbench.firmware import quantisation
from workbench.firmware.comparison import Comparison, comparison, reach
from workbench.firmware.export import files_of
from workbench.firmware.image import verdict_of
from workbench.firmware.make import ARITHMETICS, Firmware, firmware
from workbench.outputs import replaceable, whole
from workbench.robustness import worst
from workbench.robustness.cases import independent
from workbench.robustness.vary import applied
from workbench.robustness.workload import Block, Work

FOLDER = "firmware/verified"  # beside what the study itself writes of its recommended controller
FILE = "verify.json"
SEED = 20190  # of the axes that are drawn; another gives other axes of the same kind


@dataclass(frozen=True)
class Compared(Comparison):
    """One controller in one arithmetic over the axes."""

    controller: str
    arithmetic: str


def _compared(
    work: Work, name: str, arithmetic: str, values: np.ndarray, verdict: int = 0
) -> tuple[Firmware, Compared]:
    """Run one controller of a study on axes (n, k), as law and as firmware. verdict: of its table."""
    block, task = Block(0, values), work.task
    plants, fields = applied(task.plant, work.varied, values)
    scenarios = work.scenarios(block, fields)
    made = firmware(work.controllers[name], task.loop, task.plant, arithmetic, verdict=verdict, **reach(task))
    found = comparison(made, work.controllers[name], task.on(plants), scenarios)
    return made, Compared(**vars(found), controller=name, arithmetic=arithmetic)


def _asked(work: Work, controller: str | None) -> list[str]:
    """Return the controllers to be verified: one, or all."""
    names = list(work.controllers)
    if controller is not None and controller not in names:
        raise WorkbenchError(f"the study ran no controller '{controller}'; {nearest(controller, names)}")
    return [controller] if controller is not None else names


def verify(
    place: Path, draws: int = 20, controller: str | None = None, say: Callable[[str], None] = lambda _: None
) -> tuple[Compared, ...]:
    """Drive the axes of a study's outputs at `place` by firmware, write `place`/FOLDER, and return what was compared.

    draws: axes, besides the worst ones that the study kept. controller: one of the study's; all where absent, but compensations
    that have no firmware. Raises WorkbenchError where the study has no robustness, or has not been run.
    """
    replaceable(place / FOLDER, FILE)
    kept = place / "robustness" / worst.FILE
    if not kept.is_file():
        raise WorkbenchError(
            f"{kept} is not there: run the study first (workbench run), with [robustness] in its study.toml, whose axes "
            "the firmware is to drive."
        )
    work, cases = worst.read(kept)
    names = _asked(work, controller)
    verdict = judged(place)
    drawn = independent(work.varied, draws, SEED).values
    found, files = [], {}
    for name in names:
        own = [c.values for c in cases if c.controller == name]
        values = np.vstack([drawn, *(v[None, :] for v in own)])
        for arithmetic in ARITHMETICS:
            say(f"{name}, {arithmetic}")
            try:
                made, one = _compared(work, name, arithmetic, values, verdict)
            except WorkbenchError as error:
                if controller is not None or not isinstance(work.controllers[name], Compensated):
                    raise
                say(f"{name}, {arithmetic}: left out, {error}")  # the study says so of its compensation, too
                continue
            found.append(one)
            files[f"{_slug(name)}/{arithmetic}"] = made
    _write(place / FOLDER, tuple(found), files)
    return tuple(found)


def judged(place: Path) -> int:
    """Return the verdict that a study's outputs were given, as its tables hold it; 0 where there is none."""
    file = place / "results.json"
    if not file.is_file():
        return 0
    found = json.loads(file.read_text(encoding="utf-8"))
    passed = all(c["passed"] for c in found["checks"]) if found["checks"] else None
    return verdict_of(passed, found["verdict"])


def _slug(name: str) -> str:
    """A controller's name as a folder."""
    return "".join(c if c.isalnum() else "_" for c in name.lower()).strip("_").replace("__", "_")


def _write(place: Path, found: tuple[Compared, ...], files: dict[str, Firmware]) -> None:
    """Write the sources, tables and figures of every firmware, all or none."""
    with whole(place, FILE) as beside:
        figures = [asdict(c) | {"good": c.good} for c in found]
        for entry, (folder, made) in zip(figures, files.items(), strict=True):
            (beside / folder).mkdir(parents=True)
            for name, content in files_of(made).items():
                (beside / folder / name).write_bytes(content)
            entry |= {"files": folder, "quantisation": quantisation.table(made), "table_bytes": len(made.image.bytes())}
            for key in ("final_error", "time_1pct", "overshoot"):
                entry[key] = entry[key] if np.isfinite(entry[key]) else "inf"
        text = json.dumps({"format": 1, "compared": figures}, indent=1, allow_nan=False)
        (beside / FILE).write_text(text + "\n", encoding="utf-8")
