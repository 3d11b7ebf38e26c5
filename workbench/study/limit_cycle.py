"""[limit_cycle] of study.toml: over which gains a controller is looked at for limit cycles."""

from collections.abc import Callable

from workbench.errors import WorkbenchError
from workbench.firmware.naming import slug
from workbench.limit_cycle import Options, regions
from workbench.limit_cycle.wording import hunting
from workbench.readers.declaration import Table
from workbench.robustness.workload import single
from workbench.study.configuration import Study
from workbench.study.outcome import Part
from workbench.study.robustness import chosen
from workbench.task.task import Task

OPTIONAL = ("first", "second", "count", "largest", "duration", "inertia", "friction")
SPAN = (0.1, 10.0)


def asked_of(top: Table, task: Task) -> Options:
    """Return what study.toml asks; WorkbenchError names file and key."""
    one = top.table("limit_cycle", ("controllers",), OPTIONAL)
    names = one.names("controllers")
    if not names:
        raise WorkbenchError(f"{one.path('controllers')} must be a list of names in quotes.")

    def span(key):
        values = one.numbers(key, SPAN)
        if len(values) != 2 or not 0.0 < values[0] < values[1]:
            raise WorkbenchError(f"{one.path(key)} must be two factors, the lowest (above zero) and the highest.")
        return values[0], values[1]

    x = task.plant.displacement
    return Options(
        controllers=names,
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

    asked = asked_of(study.table, task)
    factories = chosen(factories, asked.controllers, f"{study.table.path('limit_cycle')}.controllers")
    found = regions(task, {n: single(make(1)) for n, make in factories.items()}, asked, say)
    figures = {f"{k}_{slug(n)}": v for n, r in found.items() for k, v in r.figures.items()}
    findings = tuple(hunting(n, r) for n, r in found.items())
    tables = {"limit_cycle": {n: r.as_dict for n, r in found.items()}}
    return Part(figures, {}, (chapter(found, task, [f.sentence for f in findings]),), findings, tables)
