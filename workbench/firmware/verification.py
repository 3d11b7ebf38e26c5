"""A study's axes driven by its firmware: the compiled C in the loop, compared with the law in float64."""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from workbench.compensation import Compensated
from workbench.control import Controller
from workbench.errors import WorkbenchError, nearest
from workbench.firmware import quantisation
from workbench.firmware.export import files_of
from workbench.firmware.image import verdict_of
from workbench.firmware.loop import run_firmware
from workbench.firmware.make import ARITHMETICS, Firmware, firmware
from workbench.outputs import replaceable, whole
from workbench.robustness import worst
from workbench.robustness.cases import independent
from workbench.robustness.vary import applied
from workbench.robustness.workload import Block, Work
from workbench.simulation import Metrics, ScenarioArrays
from workbench.verification.task import Task

FOLDER = "firmware/verified"  # beside what the study itself writes of its recommended controller
FILE = "verify.json"
COUNTS = 2.0  # of the encoder, by which final errors may differ
# Changes of friction, about half a unit and a unit in the last place of float32: what the law's own landing hangs on. Of the larger two
# alone, an axis that one of the smaller sets down 4.8 counts elsewhere was taken for steady.
NUDGES = (-1e-7, -3e-8, 3e-8, 1e-7)
TRAVEL = 2.0  # times the step that fixed point tells apart: half of it would cut off a load's swing, twice costs a bit
SEED = 20190  # of the axes that are drawn; another gives other axes of the same kind


@dataclass(frozen=True)
class Compared:
    """One controller in one arithmetic over the axes; differences are the largest over all of them, from float64.

    final_error: counts, over the axes whose landing is steady. chaotic: axes on which float64 itself lands more than
    COUNTS elsewhere where friction is changed by one of NUDGES: there no arithmetic is right. time_1pct: s. overshoot: share of the step. samples: of each motion; same: in how many of them all
    the compiled C and the reference in Python commanded the same bits.
    """

    controller: str
    arithmetic: str
    axes: int
    chaotic: int
    final_error: float
    time_1pct: float
    overshoot: float
    samples: int
    same: int

    @property
    def good(self) -> bool:
        return self.final_error <= COUNTS and self.same == self.samples


def difference(a: np.ndarray, b: np.ndarray) -> float:
    """Largest |a - b|; infinite where one is and the other is not."""
    a, b = (np.asarray(x, dtype=float) for x in (a, b))
    both = np.isfinite(a) & np.isfinite(b)
    if (np.isfinite(a) != np.isfinite(b)).any():
        return float("inf")
    return float(np.max(np.abs(a[both] - b[both]), initial=0.0))


def same_bits(made: Firmware, run: Metrics, targets: np.ndarray) -> tuple[int, int]:
    """Return (samples, in how many the reference in Python commands what the C did) along the motions that were run."""
    y, u = run.trajectories["y"], run.trajectories["u"]
    raw = (np.floor(y / made.numbers.count + 0.5).astype(np.int64) & 0xFFFFFFFF).astype(np.uint32)
    aims = (np.floor(targets / made.numbers.count + 0.5).astype(np.int64) & 0xFFFFFFFF).astype(np.uint32)
    other = run.trajectories["other"].astype(np.int64).astype(np.uint32)
    axes, beside = made.reference.start(raw[0], aims, other[0]), made.compensation
    around = beside.reference.start(raw[0]) if beside else None
    same = 0
    for k in range(len(raw)):
        added = beside.reference.step(around, raw[k] if beside.reads else aims) if beside else 0
        found = made.reference.real("u_c", made.reference.step(axes, raw[k], aims, added, other[k]))
        same += int(np.count_nonzero(found == u[k]))
    return raw.size, same


def reach(task: Task) -> dict:
    """Return how far from its target an axis is told, and between which places, for `firmware`."""
    return {
        "travel": TRAVEL * abs(task.step - task.start),
        "places": (task.start - abs(task.step), task.start + abs(task.step)),
    }


def _chaotic(task: Task, controller: Controller, scenarios: ScenarioArrays, law: Metrics) -> np.ndarray:
    """Return (n,) whether an axis lands elsewhere by more than COUNTS where its friction is a last place larger or less."""
    found = np.zeros(scenarios.lanes, dtype=bool)
    for nudge in NUDGES:
        nudged = task.run(controller, replace(scenarios, friction=scenarios.friction * (1.0 + nudge)))
        with np.errstate(invalid="ignore"):
            found |= ~(np.abs(nudged.final_error - law.final_error) <= COUNTS * task.loop.count)
    return found


def _compared(
    work: Work, name: str, arithmetic: str, values: np.ndarray, verdict: int = 0
) -> tuple[Firmware, Compared]:
    """Run one controller of a study on axes (n, k), as law and as firmware. verdict: of its table."""
    block, task = Block(0, values), work.task
    plants, fields = applied(task.plant, work.varied, values)
    scenarios = work.scenarios(block, fields)
    count = task.loop.count
    scenarios = replace(scenarios, target=count * np.floor(scenarios.target / count + 0.5))  # both go to a whole count
    law = task.on(plants).run(work.controllers[name], scenarios)
    steady = ~_chaotic(task.on(plants), work.controllers[name], scenarios, law)
    made = firmware(work.controllers[name], task.loop, task.plant, arithmetic, verdict=verdict, **reach(task))
    run = run_firmware(made, plants, task.loop, scenarios, task.duration, task.criteria)
    targets = np.broadcast_to(scenarios.target, (len(values),))
    samples, same = same_bits(made, run, targets)
    return made, Compared(
        name, arithmetic, len(values), int(np.count_nonzero(~steady)),
        difference(law.final_error[steady], run.final_error[steady]) / count,
        difference(law.time_1pct, run.time_1pct), difference(law.overshoot, run.overshoot), samples, same,
    )  # fmt: skip


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
