"""[robustness] of study.toml: what a series of axes differs in, and what its controllers come to on them."""

import re
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from workbench.control import Controller
from workbench.errors import WorkbenchError, nearest
from workbench.readers.declaration import Table
from workbench.robustness import worst
from workbench.robustness.cases import Cases, Varied
from workbench.robustness.distribution import FIXED, KINDS, NORMAL, Distribution
from workbench.robustness.local import on_cores
from workbench.robustness.perspective import CONFIDENCE, ranking
from workbench.robustness.result import Series
from workbench.robustness.series import Options, Run, series_of
from workbench.robustness.vary import FIELDS, checked, target
from workbench.robustness.workload import KEPT, Columns
from workbench.study.configuration import Study
from workbench.study.controlling import numbers
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
    names = one.values.get("controllers", [])
    if not isinstance(names, list) or not all(isinstance(n, str) for n in names):
        raise WorkbenchError(f"{one.path('controllers')} must be a list of names in quotes.")
    return Options(
        varied=_varied(one, task),
        draws=int(one.number("draws", 10_000, above=0)),
        seed=int(one.number("seed", 1, above=-1)),
        confidence=confidence,
        kept=int(one.number("worst", 3, above=0)),
        controllers=tuple(names),
        inertias=numbers(one, "inertias", LEVELS),
        frictions=numbers(one, "frictions", LEVELS),
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

    def si(value):
        return to_si(value, written, unit, where, step=True)

    def pair(key):
        values = numbers(inner, key, ())
        if len(values) != 2:
            raise WorkbenchError(f"{inner.path(key)} needs two numbers; there are {len(values)}.")
        return si(values[0]), si(values[1])

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


def slug(name: str) -> str:
    """Return a controller's name as a figure of results.json has it."""
    return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")


def chosen(factories: Mapping[str, Callable[[int], Controller]], wanted: tuple[str, ...], where: str):
    """Return the controllers that are asked for, in that order; WorkbenchError with the nearest names."""
    for name in wanted:
        if name not in factories:
            raise WorkbenchError(f"{where}: there is no controller '{name}'; {nearest(name, factories)}")
    return {n: factories[n] for n in wanted or factories}


def _figures_of(found: Series) -> dict[str, float]:
    """Return the figures by which a study may be judged."""
    out = {}
    for name in found.columns:
        end = slug(name)
        out[f"grid_error_{end}"] = found.of_grid[name].maximum
        out[f"grid_error_spread_{end}"] = found.of_grid[name].spread
        out[f"grid_time_{end}"] = float(found.grid.times[name].max())
        out[f"drawn_error_{end}"] = found.of_draws[name].maximum
        out[f"drawn_error_spread_{end}"] = found.of_draws[name].spread
        out[f"drawn_error_99_percent_{end}"] = found.of_draws[name].high
        for metric, share in found.shares[name].items():
            out[f"share_beyond_{metric}_{end}"] = share.upper
    return out


def robustness(study: Study, task: Task, factories, say: Callable[[str], None]) -> Part:
    """Run what [robustness] of a study declares, on the plant of the task, for controllers name -> factory(lanes)."""
    from workbench.report.robustness import chapter

    asked = declared(study.table, task)
    factories = chosen(factories, asked.controllers, f"{study.table.path('robustness')}.controllers")
    found = series_of(task, factories, asked, _runner(study.scheduler), say)
    x = task.plant.displacement
    figures = _figures_of(found)
    units = {n: x for n in figures if n.startswith(("grid_error", "drawn_error"))}
    units |= {n: "s" for n in figures if n.startswith("grid_time")}
    findings = ranking(found.of_grid, found.grid.title, x) + ranking(found.of_draws, found.title, x)
    return Part(figures, units, (chapter(found),), findings, {"robustness": _table_of(found)}, (_writer(found),))


def _runner(scheduler: str) -> Run:
    """Return who runs the blocks: this machine's threads, or the cluster of a scheduler's address."""
    if not scheduler:
        return on_cores
    from workbench.robustness.cluster import on_cluster

    return partial(on_cluster, scheduler)


def _writer(found: Series):
    """Return what writes the worst cases and every draw into the study's outputs."""

    def write(folder) -> None:
        place = folder / FOLDER
        place.mkdir()
        worst.write(found.work, found.worst, place / worst.FILE)
        _write_draws(found.cases, found.columns, place / "draws.csv")

    return write


def _write_draws(cases: Cases, columns: Columns, path) -> None:
    """Write every draw with what came of it, a row each, exact decimals."""
    heads = [*cases.names, *(f"{c}: {m}" for c in columns for m in KEPT)]
    data = np.column_stack([cases.values, *(columns[c][m] for c in columns for m in KEPT)])
    lines = [",".join(f'"{h}"' for h in heads), *(",".join(map(repr, row)) for row in data.tolist())]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _table_of(found: Series) -> dict:
    """Return the series as results.json holds it."""
    return {
        "draws": found.cases.count,
        "seed": found.seed,
        "varied": [
            {"name": v.name, "unit": v.unit, "relative": v.relative, **vars(v.distribution)} for v in found.cases.varied
        ],
        "grid": {
            "inertias": found.grid.inertias,
            "frictions": found.grid.frictions,
            "final_error": found.grid.errors,
            "time_1pct": found.grid.times,
        },
        "perspectives": {n: {"grid": vars(found.of_grid[n]), "draws": vars(found.of_draws[n])} for n in found.columns},
        "shares": {n: {k: vars(s) for k, s in of.items()} for n, of in found.shares.items()},
        "influences": {n: [vars(i) for i in of] for n, of in found.influences.items()},
    }
