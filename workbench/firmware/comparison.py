"""A firmware's motion beside its law's: the compiled C and float64 drive the same axes, and where they land is compared."""

from dataclasses import dataclass, replace

import numpy as np

from workbench.control import Controller
from workbench.firmware.loop import run_firmware
from workbench.firmware.make import Firmware
from workbench.simulation import Metrics, ScenarioArrays
from workbench.task.task import Task

COUNTS = 2.0  # of the encoder, by which final errors may differ
# Changes of friction, up to a unit in the last place of float32. Where the law in float64 lands for them is as right as where it lands
# without; of the largest two alone, an axis that a smaller one sets down 4.8 counts elsewhere was taken for steady, and with four a
# landing was 11.6 counts outside that ten put 6.6 outside.
NUDGES = (-1e-7, -7e-8, -5e-8, -3e-8, -1e-8, 1e-8, 3e-8, 5e-8, 7e-8, 1e-7)
TRAVEL = 2.0  # times the step that fixed point tells apart: half of it would cut off a load's swing, twice costs a bit


@dataclass(frozen=True)
class Comparison:
    """How one firmware moves beside its law in float64; differences are the largest over all axes.

    final_error: counts by which it lands outside the span of where float64 lands, with friction as it is and changed by NUDGES.
    scattered: axes of all on which that span is more than COUNTS. time_1pct: s. overshoot: share of the step.
    samples: of each motion; same: in how many of them all the compiled C and the reference in Python commanded the same bits.
    """

    axes: int
    scattered: int
    final_error: float
    time_1pct: float
    overshoot: float
    samples: int
    same: int

    @property
    def good(self) -> bool:
        return self.final_error <= COUNTS and self.same == self.samples


def comparison(made: Firmware, controller: Controller, task: Task, scenarios: ScenarioArrays) -> Comparison:
    """Run a task's scenarios under the firmware and under the law it was made of; both go to a whole count."""
    count = task.loop.count
    whole = np.broadcast_to(count * np.floor(scenarios.target / count + 0.5), scenarios.lanes)
    scenarios = replace(scenarios, target=whole)
    law = task.run(controller, scenarios)
    run = run_firmware(made, task.plant, task.loop, scenarios, task.duration, task.criteria)
    low, high = _landings(task, controller, scenarios, law)
    samples, same = same_bits(made, run, whole)
    return Comparison(
        scenarios.lanes, int(np.count_nonzero(~(high - low <= COUNTS * count))), _outside(run.final_error, low, high) / count,
        _apart(law.time_1pct, run.time_1pct), _apart(law.overshoot, run.overshoot), samples, same,
    )  # fmt: skip


def reach(task: Task) -> dict:
    """Return how far from its target an axis is told, and between which places, for `firmware`."""
    return {
        "travel": TRAVEL * abs(task.step - task.start),
        "places": (task.start - abs(task.step), task.start + abs(task.step)),
    }


def same_bits(made: Firmware, run: Metrics, targets: np.ndarray) -> tuple[int, int]:
    """Return (samples, in how many the reference in Python commands what the C did) along the motions that were run."""
    y, u = run.trajectories["y"], run.trajectories["u"]
    raw = (np.floor(y / made.numbers.count + 0.5).astype(np.int64) & 0xFFFFFFFF).astype(np.uint32)
    aims = (np.floor(targets / made.numbers.count + 0.5).astype(np.int64) & 0xFFFFFFFF).astype(np.uint32)
    other = run.trajectories["other"].astype(np.int64).astype(np.uint32)
    axes, added_by = made.reference.start(raw[0], aims, other[0]), made.compensation
    around = added_by.reference.start(raw[0]) if added_by else None
    same = 0
    for k in range(len(raw)):
        added = added_by.reference.step(around, raw[k] if added_by.reads else aims) if added_by else 0
        found = made.reference.real("u_c", made.reference.step(axes, raw[k], aims, added, other[k]))
        same += int(np.count_nonzero(found == u[k]))
    return raw.size, same


def _apart(a: np.ndarray, b: np.ndarray) -> float:
    """Largest |a - b|; infinite where one is and the other is not."""
    a, b = (np.asarray(x, dtype=float) for x in (a, b))
    both = np.isfinite(a) & np.isfinite(b)
    if (np.isfinite(a) != np.isfinite(b)).any():
        return float("inf")
    return float(np.max(np.abs(a[both] - b[both]), initial=0.0))


def _landings(
    task: Task, controller: Controller, scenarios: ScenarioArrays, law: Metrics
) -> tuple[np.ndarray, np.ndarray]:
    """Return (lowest, highest) final error (n,) of the law in float64, friction as it is and changed by NUDGES."""
    nudged = (replace(scenarios, friction=scenarios.friction * (1.0 + n)) for n in NUDGES)
    every = np.array([law.final_error, *(task.run(controller, s).final_error for s in nudged)])
    return every.min(axis=0), every.max(axis=0)


def _outside(x: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
    """Largest distance of x from its span; infinite where one is a number and the other is not."""
    if (np.isfinite(x) != np.isfinite(low + high)).any():
        return float("inf")
    with np.errstate(invalid="ignore"):
        return float(np.nanmax(np.maximum(np.maximum(low - x, x - high), 0.0), initial=0.0))
