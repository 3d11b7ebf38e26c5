"""Whether the schedule over the relative displacement hunts: predicted from the equivalents of the joint, and simulated."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from workbench.design.families.shaped import judged
from workbench.design.joint import unstable
from workbench.design.optimise import Tuned
from workbench.limit_cycle.simulation import simulated
from workbench.report import numbers
from workbench.report.contents import Chapter, Paragraph, Table
from workbench.robustness.workload import single
from workbench.schedule import Schedule
from workbench.task.task import Task

from .controllers import Over

FACTORS = np.geomspace(0.5, 4.0, 7)  # on both gains
START, DURATION = 1e-3, 1.0  # rad from rest, s


@dataclass(frozen=True, eq=False)
class Hunting:
    """Of gains times factors (n,): whether the paper's model, without friction to ground, is predicted to hunt (n,) and does (n,),
    and whether the assumed plant does (n,)."""

    factors: np.ndarray
    predicted: np.ndarray
    model: np.ndarray
    plant: np.ndarray

    @property
    def wrong(self) -> int:
        """Factors at which the prediction does not hold for its own model."""
        return int(np.count_nonzero(self.predicted != self.model))


def looked_at(task: Task, over: Over, schedule: Schedule, tuned: Tuned) -> Hunting:
    """Return what a schedule does with its gains times FACTORS, without the load. tuned: the law that has it, with its filter and
    notch."""
    load = over.loads[0]
    met = partial(judged, numbers=tuned.numbers)
    predicted = unstable(schedule, over.spring, over.motor, load, over.damping, task.loop, FACTORS, met).any(axis=1)
    law = single(tuned.controller(1))
    laws = [replace(law, parameters={**law.parameters, "scale": float(f)}) for f in FACTORS]
    starts = np.full(FACTORS.size, START)
    damped = over.plant + task.plant["linear_damping"]
    model, plant = (simulated(p, task.loop, laws, starts, DURATION).lasts for p in (damped, task.plant))
    return Hunting(FACTORS, predicted, model, plant)


def figures_of(found: Hunting) -> dict[str, float]:
    """Return the figures by which the study may be judged."""
    steady = found.factors[~(found.plant | found.model)]
    return {
        "joint_hunting_wrong": float(found.wrong),
        "joint_steady_up_to": float(steady.max()) if steady.size else 0.0,
    }


def chapter(found: Hunting, pumping: float) -> Chapter:
    """What is predicted, and what is so."""

    def said(hunts: bool) -> str:
        return "hunts" if hunts else "comes to rest"

    rows = tuple(
        (numbers.number(f), *map(said, each))
        for f, *each in zip(found.factors, found.predicted, found.model, found.plant, strict=True)
    )
    table = Table(
        ("gains times", "predicted", "the paper's model, simulated", "the assumed plant, simulated"), rows,
        "Limit cycles of the schedule over the relative displacement, without the load.", "rlll",
    )  # fmt: skip
    text = (
        "Predicted: the linear loop is unstable with the joint's equivalent at some amplitude of the relative displacement. The "
        f"paper's model has no friction to ground, the assumed plant has. Of {found.factors.size} predictions {found.wrong} do not "
        f"hold for the model that they are made for. Moving gains feed in at most {numbers.percent(pumping)} of what damping takes out."
    )
    return Chapter("Limit cycles and passivity of the schedule over the joint", (Paragraph(text), table))
