"""Work as plain data: names and numbers, exact to the last bit, for a file that is replayed and for other machines.

Effects and laws go by their names, so whoever reads a document brings the code: of the same version, or a probe says so.
Floats are written as Python's shortest exact decimals. What is not finite is a text, "inf" or "nan".
"""

from collections.abc import Mapping
from dataclasses import asdict
from math import isfinite

import numpy as np

from workbench import __version__
from workbench.compensation import Compensated, Compensator, compensated
from workbench.control import Controller, Table, law_named
from workbench.definition import Effect, catalogue, find
from workbench.errors import WorkbenchError
from workbench.plant import Geometry, Limits, Plant
from workbench.robustness.cases import Varied
from workbench.robustness.distribution import Distribution
from workbench.robustness.workload import Work
from workbench.simulation import Criteria, Loop
from workbench.task.task import Task

FORMAT = 1
LARGEST = 1e15  # of any number of a task: what is larger overflows within a run, and no axis has it
MOST = 1e8  # integration steps of one case: half a minute; a study's have less than a hundredth of it
PARTS = ("effects", "still", "inertial", "guides")  # of a compensator
NUMBERS = ("source", "gain", "delay", "low_pass", "mass", "bandwidth", "ratio", "pole_pairs")


def number(value: float) -> float | str:
    """A float as strict JSON holds it."""
    return float(value) if isfinite(value) else str(float(value))


def _of_effect(effect: Effect) -> dict:
    known = catalogue().get(effect.name)
    if known is None or known.step is not effect.step:
        raise WorkbenchError(
            f"effect '{effect.name}' is not in the catalogue, so no file and no other machine knows it by name; put it there "
            "(docs/a-new-effect.md)."
        )
    return {"effect": effect.name, "at": effect.at, "parameters": {n: p.value for n, p in effect.parameters.items()}}


def _of_plant(plant: Plant) -> dict:
    return {
        "kind": plant.kind,
        "rotary": plant.rotary,
        "geometry": asdict(plant.geometry),
        "limits": {n: number(v) for n, v in asdict(plant.limits).items()},
        "effects": [_of_effect(e) for e in plant.effects],
    }


def _plant_of(given: Mapping) -> Plant:
    return Plant(
        given["kind"],
        tuple(find(e["effect"])(at=e["at"], **e["parameters"]) for e in given["effects"]),
        given["rotary"],
        Geometry(**given["geometry"]),
        Limits(**{n: float(v) for n, v in given["limits"].items()}),
    )


def _of_compensator(c: Compensator) -> dict:
    parts = {n: [_of_effect(e) for e in getattr(c, n)] for n in PARTS}
    return parts | {n: getattr(c, n) for n in NUMBERS}


def _compensator_of(given: Mapping) -> Compensator:
    parts = {n: tuple(find(e["effect"])(at=e["at"], **e["parameters"]) for e in given[n]) for n in PARTS}
    return Compensator(**parts, **{n: given[n] for n in NUMBERS})


def of_controller(controller: Controller) -> dict:
    if isinstance(controller, Compensated):
        return {"base": of_controller(controller.base), "compensation": _of_compensator(controller.compensator)}
    tables = controller.tables
    if law_named(controller.law.name) is not controller.law:
        raise WorkbenchError(
            f"controller '{controller.name}' has a law of its own, which no other machine knows by name."
        )
    return {
        "name": controller.name,
        "law": controller.law.name,
        "parameters": {n: number(v) for n, v in controller.parameters.items()},
        "knots": tables[0].knots.tolist() if tables else [],
        "columns": {n: c.tolist() for n, c in tables[0].columns.items()} if tables else {},
        "reversal": controller.reversal,
        "velocity_filter": controller.velocity_filter,
    }


def controller_of(given: Mapping) -> Controller:
    if "compensation" in given:
        return compensated(controller_of(given["base"]), _compensator_of(given["compensation"]))
    columns = {n: np.array(c) for n, c in given["columns"].items()}
    return Controller(
        given["name"],
        law_named(given["law"]),
        {n: float(v) for n, v in given["parameters"].items()},
        (Table(np.array(given["knots"]), columns),) if given["knots"] else (),
        None,
        given["reversal"],
        given.get("velocity_filter"),
    )


def of_work(work: Work) -> dict:
    """Return the document of some work; WorkbenchError for an effect or a law that is not known by name."""
    task = work.task
    return {
        "format": FORMAT,
        "workbench": __version__,
        "plant": _of_plant(task.plant),
        "loop": asdict(task.loop),
        "criteria": asdict(task.criteria),
        "step": task.step,
        "duration": task.duration,
        "noise": task.noise,
        "controllers": {n: of_controller(c) for n, c in work.controllers.items()},
        "varied": [asdict(v) for v in work.varied],
    }


def _numbers_in(given: Mapping, where: str, texts: tuple[str, ...] = (), empty: tuple[str, ...] = ()) -> None:
    """Raise WorkbenchError where a value of a table is no number. texts: keys of texts; empty: keys that may hold null."""
    for key, value in given.items():
        sound = isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= LARGEST
        if not (sound or key in texts or (key in empty and value is None)):
            raise WorkbenchError(
                f"{where}{key} is {value!r:.40}, and a number is needed; take the file that the study wrote."
            )


def _checked(given: Mapping) -> None:
    """Raise WorkbenchError where a number of a document's task is none, or its run would not end."""
    _numbers_in({n: given[n] for n in ("step", "duration", "noise")}, "")
    _numbers_in(given["loop"], "loop.", ("feedback",))
    _numbers_in(given["criteria"], "criteria.")
    for name, one in given["controllers"].items():
        base = one.get("base", one)
        _numbers_in(
            {n: base.get(n) for n in ("reversal", "velocity_filter")},
            f"controllers.{name}.",
            empty=("reversal", "velocity_filter"),
        )
    samples = given["duration"] / given["loop"]["sample_time"] * given["loop"].get("substeps", 1)
    if not samples <= MOST:
        raise WorkbenchError(
            f"duration is {given['duration']:g} s, {samples:.3g} integration steps; at most {MOST:g} are run again."
        )


def work_of(given: Mapping) -> Work:
    """Return the work of a document; WorkbenchError for another format, or where something is missing from it."""
    try:
        if not isinstance(given, Mapping):
            raise TypeError("no table")
        if given["format"] != FORMAT:
            raise WorkbenchError(f"the document has format {given['format']}; this workbench reads {FORMAT}.")
        _checked(given)
        task = Task(
            plant=_plant_of(given["plant"]),
            loop=Loop(**given["loop"]),
            step=given["step"],
            duration=given["duration"],
            noise=given["noise"],
            criteria=Criteria(**given["criteria"]),
        )
        varied = tuple(Varied(**{**v, "distribution": Distribution(**v["distribution"])}) for v in given["varied"])
        return Work(task, {n: controller_of(c) for n, c in given["controllers"].items()}, varied)
    except (KeyError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        raise WorkbenchError(
            f"this is not a document of worst cases that the workbench wrote ({type(error).__name__}: {error})."
        ) from error
