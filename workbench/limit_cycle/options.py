"""What is asked of limit cycles: over which gains of which controllers, and how far they are sought."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from workbench.control import Controller
from workbench.limit_cycle.gain_region import Region, region
from workbench.task.task import Task


@dataclass(frozen=True)
class Options:
    """controllers: their names. first, second: lowest and highest factor on each gain, `count` of each, even in the logarithm.

    largest: amplitude up to which cycles are sought, SI. duration: of the simulation, s. inertia, friction: of the axis, factors.
    """

    controllers: tuple[str, ...]
    first: tuple[float, float]
    second: tuple[float, float]
    count: int
    largest: float
    duration: float
    inertia: float
    friction: float


def regions(
    task: Task, controllers: Mapping[str, Controller], asked: Options, say: Callable[[str], None]
) -> dict[str, Region]:
    """Return name -> the region of a controller's gains that hunt on the plant of a task. controllers: of one lane each."""
    first, second = (np.geomspace(*span, asked.count) for span in (asked.first, asked.second))
    found = {}
    for name, controller in controllers.items():
        say(f"limit cycles of {name}")
        found[name] = region(
            task.plant, task.loop, controller, first, second, asked.largest, asked.duration,
            inertia=asked.inertia, friction=asked.friction,
        )  # fmt: skip
    return found
