"""[limit_cycle] of study.toml: over which gains a controller is looked at for limit cycles."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workbench.errors import WorkbenchError
from workbench.finding import Finding
from workbench.limit_cycle import Region, region
from workbench.readers.declaration import Table
from workbench.robustness.workload import single
from workbench.study.configuration import Study
from workbench.study.controlling import numbers
from workbench.study.outcome import Part
from workbench.study.robustness import chosen, slug
from workbench.task.task import Task

OPTIONAL = ("first", "second", "count", "largest", "duration", "inertia", "friction")
SPAN = (0.1, 10.0)


@dataclass(frozen=True)
class Asked:
    """[limit_cycle]. first, second: lowest and highest factor on each gain, `count` of each. largest: amplitude, SI."""

    controllers: tuple[str, ...]
    first: tuple[float, float]
    second: tuple[float, float]
    count: int
    largest: float
    duration: float
    inertia: float
    friction: float


def _asked_of(top: Table, task: Task) -> Asked:
    """Return what study.toml asks; WorkbenchError names file and key."""
    one = top.table("limit_cycle", ("controllers",), OPTIONAL)
    names = one.values["controllers"]
    if not isinstance(names, list) or not names or not all(isinstance(n, str) for n in names):
        raise WorkbenchError(f"{one.path('controllers')} must be a list of names in quotes.")

    def span(key):
        values = numbers(one, key, SPAN)
        if len(values) != 2 or not 0.0 < values[0] < values[1]:
            raise WorkbenchError(f"{one.path(key)} must be two factors, the lowest (above zero) and the highest.")
        return values[0], values[1]

    x = task.plant.displacement
    return Asked(
        controllers=tuple(names),
        first=span("first"),
        second=span("second"),
        count=int(one.number("count", 10, above=1)),
        largest=one.quantity("largest", x, above=0.0) if "largest" in one else abs(task.step),
        duration=one.quantity("duration", "s", above=0.0) if "duration" in one else 2.0,
        inertia=one.number("inertia", 1.0, above=0.0),
        friction=one.number("friction", 1.0, above=0.0),
    )


def limit_cycles(study: Study, task: Task, factories, say: Callable[[str], None]) -> Part:
    """Run what [limit_cycle] of a study declares, for controllers name -> factory(lanes)."""
    from workbench.report.limit_cycle import chapter

    asked = _asked_of(study.table, task)
    factories = chosen(factories, asked.controllers, f"{study.table.path('limit_cycle')}.controllers")
    first, second = (np.geomspace(*span, asked.count) for span in (asked.first, asked.second))
    found = {}
    for name, make in factories.items():
        say(f"limit cycles of {name}")
        found[name] = region(
            task.plant, task.loop, single(make(1)), first, second, asked.largest, asked.duration,
            inertia=asked.inertia, friction=asked.friction,
        )  # fmt: skip
    figures = {f"{k}_{slug(n)}": v for n, r in found.items() for k, v in _figures_of(r).items()}
    findings = tuple(f for n, r in found.items() for f in _findings_of(n, r))
    tables = {"limit_cycle": {n: _table_of(r) for n, r in found.items()}}
    return Part(figures, {}, (chapter(found, task, [f.sentence for f in findings]),), findings, tables)


def _figures_of(r: Region) -> dict[str, float]:
    """Return how often prediction and simulation agree, and how well the frequency is met; cases with a third harmonic of at
    most 5 % and above ten encoder counts, frequencies of those that the axis' speed does not limit."""
    error = np.abs(r.frequency_error)
    return {
        "limit_cycle_wrong": float(np.sum(r.judged & ~r.right)),
        "limit_cycle_cases": float(np.sum(r.judged)),
        "limit_cycle_frequency_error": float(np.nanmax(error)) if np.isfinite(error).any() else 0.0,
    }


def _findings_of(name: str, r: Region) -> tuple[Finding, ...]:
    """Say whether the gains hunt as they are tuned, and whether the prediction holds."""
    at = tuple(int(np.argmin(np.abs(np.log(x)))) for x in (r.first, r.second))
    hunts = f"hunts at {r.omega[at]:.0f} rad/s" if r.exists[at] else "does not hunt"
    figures = _figures_of(r)
    wrong, cases = int(figures["limit_cycle_wrong"]), int(figures["limit_cycle_cases"])
    agreed = "in all of them" if not wrong else f"in all but {wrong}"
    sentence = (
        f"With its {r.dials.first} times {r.first[at[0]]:.2g} and {r.dials.second} times {r.second[at[1]]:.2g}, {name} {hunts}. "
        f"Of {r.exists.size} cases {int(r.exists.sum())} hunt in simulation; in {cases} the third harmonic is at most 5 % and "
        f"the cycle above ten encoder counts, and {agreed} harmonic balance says rightly whether there is a limit cycle, its frequency within "
        f"{100 * figures['limit_cycle_frequency_error']:.2g} %."
    )
    return (Finding("limit cycle", name, sentence, figures),)


def _table_of(r: Region) -> dict:
    """Return a region as results.json holds it."""
    return {
        "gains": [r.dials.first, r.dials.second],
        "first": r.first,
        "second": r.second,
        "inertia": r.inertia,
        "friction": r.friction,
        "predicted": [[[vars(c) for c in r.cycles[i, j]] for j in range(r.second.size)] for i in range(r.first.size)],
        "exists": r.exists,
        "amplitude": r.amplitude,
        "omega": r.omega,
        "third": r.third,
    }
