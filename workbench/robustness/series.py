"""A series of axes: a grid of inertia and friction, and draws, run and summed up for every controller."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from workbench.control import Controller
from workbench.robustness import worst
from workbench.robustness.cases import Varied, independent
from workbench.robustness.influence import influences
from workbench.robustness.perspective import perspectives, share_beyond
from workbench.robustness.result import OfGrid, Series
from workbench.robustness.workload import Block, Columns, Work, blocks, joined, work
from workbench.task.task import PHASES, Task

Factories = Mapping[str, Callable[[int], Controller]]  # name -> factory(lanes)
Run = Callable[[Work, list[Block], Callable[[str], None]], Iterator[Columns]]


@dataclass(frozen=True)
class Options:
    """What is asked of a series. varied, draws, seed: the axes that are drawn. inertias, frictions: factors of the grid.
    kept: worst cases that are kept. controllers: their names, the one that matters first; none: all. limits: metric -> SI."""

    varied: tuple[Varied, ...]
    draws: int
    seed: int
    confidence: float
    kept: int
    controllers: tuple[str, ...]
    inertias: tuple[float, ...]
    frictions: tuple[float, ...]
    limits: Mapping[str, float]


def _on_grid(task: Task, factories: Factories, asked: Options) -> OfGrid:
    """Return each controller's errors over factors on inertia and friction, the worst of PHASES encoder phases."""
    scenarios = task.scenarios((0.0,), asked.frictions, asked.inertias, PHASES)
    shape = (len(asked.frictions), len(asked.inertias), PHASES)
    errors, times = {}, {}
    for name, make in factories.items():
        m = task.run(make(scenarios.lanes), scenarios)
        errors[name] = m.final_error.reshape(shape).max(axis=2)
        times[name] = m.time_1pct.reshape(shape).max(axis=2)
    return OfGrid(asked.inertias, asked.frictions, errors, times)


def series_of(task: Task, factories: Factories, asked: Options, run: Run, say: Callable[[str], None]) -> Series:
    """Return all that is found of a series of axes. run: who runs the blocks."""
    say("robustness: the grid")
    grid = _on_grid(task, factories, asked)
    say(f"robustness: {asked.draws} axes")
    given, cases = work(task, factories, asked.varied), independent(asked.varied, asked.draws, asked.seed)
    columns = joined(run(given, blocks(cases), say))
    return Series(
        work=given,
        cases=cases,
        columns=columns,
        grid=grid,
        of_grid={n: perspectives(e) for n, e in grid.errors.items()},
        of_draws={n: perspectives(c["final_error"]) for n, c in columns.items()},
        shares={
            n: {k: share_beyond(cases, c[k], limit, asked.confidence) for k, limit in asked.limits.items()}
            for n, c in columns.items()
        },
        influences={n: influences(cases, c["final_error"]) for n, c in columns.items()},
        worst=worst.worst(cases, columns, asked.kept),
        confidence=asked.confidence,
        seed=asked.seed,
    )
