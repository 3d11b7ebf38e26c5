"""The loop that is assumed where nothing is known of the bench's own: its rate, its step, and what gains must be robust on."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, isfinite

import numpy as np

from workbench.definition import FORCE
from workbench.description.friction import equivalent_of, friction_of
from workbench.design.families.linear import Judge, Linear, TwoMasses
from workbench.errors import WorkbenchError
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import ONE_MASS, SENSORS, TWO_MASS, Plant
from workbench.record import VALIDATION, Record
from workbench.simulation import Loop
from workbench.task.task import Task

SUBSTEP = 2.5e-4  # s, at most
STROKE = 0.5  # of the record's travel, that the step goes, from a quarter of it on
LASTS, REST = 5.0, 0.3  # of the time-optimal bound, and s beside, that a step is simulated for
COUNTS = 10.0  # of the amplitude at which presliding is described


@dataclass(frozen=True)
class Shown:
    """What records show of all that a study may leave out, SI. loop: at their rate. start, step: a move within their travel.

    speed: the largest. record: whose they are.
    """

    loop: Loop
    start: float
    step: float
    speed: float
    record: str


def shown_by(plant: Plant, inverses: Sequence[InverseDynamics]) -> Shown:
    """Return what records show of a controller's half: loop, move and speed, by the first that validates."""
    record = next((p.motion.record for p in inverses if p.motion.record.role == VALIDATION), inverses[0].motion.record)
    speed = max(float(np.abs(p.motion.v).max()) for p in inverses)
    return Shown(loop_of(record), *_move_of(plant, record), speed, record.name)


def loop_of(record: Record) -> Loop:
    """Return the loop that is assumed at the rate of a record."""
    dt, counts = record.dt, (record.resolution.get(s, 0.0) for s in SENSORS)
    return Loop(dt, max(2, ceil(dt / SUBSTEP - 1e-9)), dt, dt, *counts)


def task_of(plant: Plant, record: Record, loop: Loop) -> Task:
    """Return the step that gains are tuned for: half of the record's travel, in the middle of it."""
    start, step = _move_of(plant, record)
    task = Task(plant, loop, step, REST, start=start)
    return replace(task, duration=lasting(task))


def _move_of(plant: Plant, record: Record) -> tuple[float, float]:
    """Return (start, step) of a move over half of a record's travel, in the middle of it, rad or m."""
    q = record.channels[SENSORS[plant.kind == TWO_MASS]]
    travel = float(np.ptp(q))
    return float(q.min()) + (1.0 - STROKE) / 2 * travel, STROKE * travel


def lasting(task: Task) -> float:
    """Return how long a step is simulated for, s: LASTS times its bound, and REST; without mass or limit REST alone."""
    mass = sum(e.parameters["inertia"].value for e in task.plant.effects if e.name == "inertia")
    bounded = mass > 0.0 and isfinite(task.plant.limits.drive)
    return LASTS * task.bound() + REST if bounded else REST


def late(plant: Plant) -> float:
    """Return by how much the plant's own command is late, s: its delay and its lag."""
    parameters = [p for e in plant.effects if e.at == "command" for p in e.parameters.items()]
    return float(sum(p.value for n, p in parameters if n in ("delay", "time_constant")))


def judge(plant: Plant, loop: Loop, step: float) -> Judge:
    """Return the linearisations that the gains must be robust on: sliding, and presliding at its stiffest.

    With two masses, the joint without and with what its friction adds near rest.
    """
    least = COUNTS * loop.resolution or 1e-5 * step
    omega = 1.0 / loop.sample_time / COUNTS
    if plant.kind == ONE_MASS:
        friction, inertia, viscous = friction_of(plant)
        spring = float(equivalent_of(friction, [least], [omega], loop.resolution).stiffness.max())
        return Linear(loop, inertia, max(viscous, 0.0), np.array([0.0, spring]))
    joint = equivalent_of(_joint_alone(plant), [least, 1e3 * least], [omega, omega], loop.resolution)
    masses = {e.at: e.parameters["inertia"].value for e in plant.effects if e.name == "inertia"}
    if not ({"motor", "load"} <= set(masses) and joint.stiffness.min() > 0.0):
        raise WorkbenchError("a plant of two masses needs both inertias and a joint with a stiffness to be tuned for.")
    damping = sum(e.parameters["damping"].value for e in plant.effects if e.key == "linear_damping@joint")
    return TwoMasses(loop, masses["motor"], np.full(2, masses["load"]), joint.stiffness, float(damping))


def _joint_alone(plant: Plant) -> Plant:
    """Return the forces of the joint on an axis of their own."""
    forces = [e for e in plant.effects if e.at == "joint" and e.port == FORCE]
    return Plant(ONE_MASS, tuple(replace(e, at="axis", places=("axis",)) for e in forces), plant.rotary, plant.geometry)
