"""What a controller's firmware comes to in one arithmetic: size, instructions where they were measured, what rounding does to
the loop, and how an axis moves under the compiled C beside the law in float64.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from workbench.control import Controller
from workbench.errors import WorkbenchError
from workbench.firmware import host, quantisation
from workbench.firmware.comparison import Comparison, comparison, reach
from workbench.firmware.make import Firmware, firmware
from workbench.processes import shared
from workbench.task.task import Task

MEASURED = Path(__file__).with_name("measured.json")  # held by the tests that run the target
HEAD, ENCODER, WORD = 13, 4, 4  # words of wb_head and wb_encoder, and bytes of a word


@dataclass(frozen=True)
class Measured:
    """On a Cortex-M4 at -O2: instructions of a step, worst and mean, and bytes of controller and loader."""

    worst: int
    mean: int
    code: int


@dataclass(frozen=True, eq=False)
class Summary:
    """made: the firmware. ram: bytes of table and state. gain: largest relative error of the loop's gain by rounding.

    sensitivity: by what |S| of at most the task's Ms moves with it, no more. measured, moved: None where there is none.
    """

    made: Firmware
    arithmetic: str
    ram: int
    gain: float
    sensitivity: float
    measured: Measured | None
    moved: Comparison | None


@cache
def known() -> dict:
    return json.loads(MEASURED.read_text(encoding="utf-8"))


def measured_of(law: str, arithmetic: str) -> Measured | None:
    """Return what the tests hold of a law on the target; None of a law that they do not run."""
    found = known().get(law, {}).get(arithmetic)
    return Measured(**found) if found else None


def ram_of(made: Firmware) -> int:
    """Bytes that a firmware's table and state take in memory."""
    n = made.numbers
    factor = 1 if made.source.number_type == "int32_t" and n.knots.size else 0
    knots, rows = max(made.source.knots, 1), max(made.source.rows, 1)
    table = (
        HEAD + factor + len(n.values) + knots * (1 + rows) + factor * rows
    )  # in fixed point the last knot stands twice
    beside = made.compensation
    more = HEAD + beside.source.size + ENCODER + 1 + len(beside.made.states) if beside else 0  # 1: the part of a count
    return WORD * (table + ENCODER + len(n.stages.states) + more)


def rounding(made: Firmware) -> float:
    """Return the largest relative error of a number that the loop's gain is proportional to: gains, and the rate of samples."""
    return max((q.error for q in quantisation.numbers(made) if q.wanted), default=0.0)


def _moved(made: Firmware, controller: Callable[[int], Controller], task: Task) -> Comparison | None:
    """Run the task under both; None where this machine has no C compiler."""
    try:
        host.compiler()
    except WorkbenchError:
        return None
    scenarios = task.scenarios()
    return comparison(made, controller(scenarios.lanes), task, scenarios)


def summaries(
    asked: Sequence[tuple[Callable[[int], Controller], str]], task: Task, verdict: int = 0
) -> list[Summary | WorkbenchError]:
    """Return the summary of each (controller(lanes), arithmetic), moved side by side; of one without firmware why, as `firmware`."""
    made = [_made(*one, task, verdict) for one in asked]

    def moved(k: int) -> Comparison | WorkbenchError | None:
        try:
            return None if isinstance(made[k], WorkbenchError) else _moved(made[k].made, asked[k][0], task)
        except WorkbenchError as error:
            return error

    for k, found in enumerate(shared(moved, range(len(made)))):
        if not isinstance(made[k], WorkbenchError):
            made[k] = found if isinstance(found, WorkbenchError) else replace(made[k], moved=found)
    return made


def _made(
    controller: Callable[[int], Controller], arithmetic: str, task: Task, verdict: int
) -> Summary | WorkbenchError:
    """Return the summary of one controller, that has not moved yet."""
    try:
        made = firmware(controller(1), task.loop, task.plant, arithmetic, verdict=verdict, **reach(task))
    except WorkbenchError as error:
        return error
    gain, most = rounding(made), task.weights.sensitivity
    return Summary(
        made, arithmetic, ram_of(made), gain, gain * most * (most + 1.0),  # |dS| = |S T| |dL/L|, and |T| <= 1 + |S|
        measured_of(made.numbers.stages.law.name, arithmetic), None,
    )  # fmt: skip
