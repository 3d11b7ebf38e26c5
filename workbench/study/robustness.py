"""[robustness] of study.toml: what a series of axes differs in, and what its controllers come to on them."""

from collections.abc import Callable, Mapping
from functools import partial

from workbench.control import Controller
from workbench.errors import WorkbenchError, nearest
from workbench.firmware.naming import slug
from workbench.readers.declaration import Table
from workbench.robustness.cases import Varied
from workbench.robustness.distribution import FIXED, KINDS, NORMAL, Distribution
from workbench.robustness.local import on_cores
from workbench.robustness.output import write
from workbench.robustness.perspective import CONFIDENCE
from workbench.robustness.series import Options, Run, series_of
from workbench.robustness.vary import FIELDS, checked, target
from workbench.robustness.wording import ranking
from workbench.study.configuration import Study
from workbench.study.outcome import Part
from workbench.task.task import Task
from workbench.units import to_si

FOLDER = "robustness"
LEVELS = (0.5, 1.0, 1.5)
OPTIONAL = ("draws", "seed", "confidence", "worst", "controllers", "inertias", "frictions", "limits", "vary")
METRICS = {"final_error": "x", "time_1pct": "s", "overshoot": "1"}  # that may have a limit, and their unit


def declared(top: Table, task: Task) -> Options:
    """Return what study.toml says of a series; WorkbenchError names file and key."""
    one = top.table("robustness", ("vary",), OPTIONAL)
    confidence = one.number("confidence", CONFIDENCE, above=0.0)
    if not confidence < 1.0:
        raise WorkbenchError(f"{one.path('confidence')} is {confidence:g}; a number below 1 is needed, such as 0.99.")
    limits = one.table("limits", optional=tuple(METRICS))
    x = task.plant.displacement
    return Options(
        varied=_varied(one, task),
        draws=int(one.number("draws", 10_000, above=0)),
        seed=int(one.number("seed", 1, above=-1)),
        confidence=confidence,
        kept=int(one.number("worst", 3, above=0)),
        controllers=one.names("controllers"),
        inertias=one.numbers("inertias", LEVELS),
        frictions=one.numbers("frictions", LEVELS),
        limits={n: limits.quantity(n, {"x": x}.get(METRICS[n], METRICS[n]), above=0.0) for n in limits.values},
    )


def _varied(one: Table, task: Task) -> tuple[Varied, ...]:
    """Return [robustness.vary]: name -> { KIND = ..., unit, relative, within }."""
    table, out = one.named("vary"), []
    for name in table.values:
        inner = table.table(name, optional=(*KINDS, "within", "unit", "relative"))
        kinds = [k for k in KINDS if k in inner]
        if len(kinds) != 1:
            raise WorkbenchError(f"{table.path(name)}: state one of {', '.join(KINDS)}; there are {len(kinds)}.")
        meant = target(task.plant, name, table.path(name))
        relative = inner.flag("relative", name in ("inertia", "friction"))
        unit = "1" if relative else meant.unit
        v = Varied(name, _distribution(inner, kinds[0], unit), relative and name not in FIELDS, unit)
        checked(task.plant, (v,), table.path(name))
        out.append(v)
    return tuple(out)


def _distribution(inner: Table, kind: str, unit: str) -> Distribution:
    """Return { uniform = [low, high] }, { log_uniform = [low, high] }, { normal = [mean, deviation], within = [low, high] } or
    { value = x }, in `unit`."""
    where, written = inner.path("unit"), inner.text("unit", "1")

    def si(value, step=False):
        return to_si(value, written, unit, where, step=step)

    def pair(key):
        values = inner.numbers(key, ())
        if len(values) != 2:
            raise WorkbenchError(f"{inner.path(key)} needs two numbers; there are {len(values)}.")
        return si(values[0]), si(values[1], step=key == NORMAL)  # a deviation has no zero: 5 degC of it are 5 K

    try:
        if kind == FIXED:
            value = si(inner.number(kind))
            return Distribution(kind, value, value)
        if kind == NORMAL:
            return Distribution(kind, *pair("within"), *pair(kind))
        return Distribution(kind, *pair(kind))
    except WorkbenchError as error:
        sentence = str(error)
        raise WorkbenchError(sentence if inner.file in sentence else f"{inner.path(kind)}: {sentence}") from error


def chosen(factories: Mapping[str, Callable[[int], Controller]], wanted: tuple[str, ...], where: str):
    """Return the controllers that are asked for, in that order; WorkbenchError with the nearest names."""
    for name in wanted:
        if name not in factories:
            raise WorkbenchError(f"{where}: there is no controller '{name}'; {nearest(name, factories)}")
    return {n: factories[n] for n in wanted or factories}


def robustness(study: Study, task: Task, factories, say: Callable[[str], None]) -> Part:
    """Run what [robustness] of a study declares, on the plant of the task, for controllers name -> factory(lanes)."""
    from workbench.report.robustness import chapter

    asked = declared(study.table, task)
    factories = chosen(factories, asked.controllers, f"{study.table.path('robustness')}.controllers")
    found = series_of(task, factories, asked, _runner(study.scheduler), say)
    x = task.plant.displacement
    figures = {f"{k}_{slug(n)}": v for n in found.columns for k, v in found.figures(n).items()}
    units = {n: x for n in figures if n.startswith(("grid_error", "drawn_error"))}
    units |= {n: "s" for n in figures if n.startswith("grid_time")}
    findings = ranking(found.of_grid, found.grid.title, x) + ranking(found.of_draws, found.title, x)
    tables = {"robustness": found.as_dict}
    return Part(figures, units, (chapter(found),), findings, tables, (lambda folder: write(found, folder / FOLDER),))


def _runner(scheduler: str) -> Run:
    """Return who runs the blocks: this machine's threads, or the cluster of a scheduler's address."""
    if not scheduler:
        return on_cores
    from workbench.robustness.cluster import on_cluster

    return partial(on_cluster, scheduler)
