"""What the joint of two masses carries: whether a fit lets it carry anything, and what holds it away from where it is relaxed.

The load's balance, 0 = inertia and friction there less the joint's torque, has a solution that is always right: no load, and a
joint without stiffness. Where what is wrong with the measured angle (a clock, a zero, counts) is more than what torque does to
it, a fit goes there. The drive's balance then is that of one rigid body, and nothing in either says what a joint lacks.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.definition import FORCE, Effect
from workbench.inverse.balances import balances
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import motion
from workbench.plant import TWO_MASS, Plant
from workbench.record import IDENTIFICATION

# Error of the load's balance, over the torque of the joint, from which the joint explains nothing of how the load moves. Fits
# that carry have 0.01 to 0.5, those that do not 0.98 and more: half of it would take a joint whose law is wrong for an idle one,
# twice of it nothing.
IDLE = 0.9
# Mean square of what a locked record leaves over its mean power, from which its joint was held wound up: of 20 axes one has 0.91 (a weight that a
# clamp holds), others 0.37 at most (creep, friction that begins anywhere). Halved, one more is shifted, and is traced the same; doubled, none is
HELD = 0.6


def load_errors(inverses: Sequence[InverseDynamics], plant: Plant) -> dict[str, float]:
    """Return role -> relative error of the load's balance, of two masses: a second error beside that of the drive.

    rms(F(what is left)) / rms(F(torque of the joint)), F the evaluation filter; the joint's torque is that of its law at the
    measured deflection. Records in which the load is locked have no such balance. Infinite where the joint has no torque.
    """
    power: dict[str, np.ndarray] = {}
    for p in sorted(inverses, key=lambda p: p.motion.record.name):
        if p.rows(plant) != 2:
            continue
        left, joint = np.zeros((2, p.motion.u.size))
        for e, name, column in p.columns(plant):
            force = (e.parameters[name].value if name else 1.0) * column[1]
            left, joint = left + force, joint + force * (e.at == "joint")
        squares = np.sum(p.motion.filter(np.stack([left, joint]))[:, p.motion.keep] ** 2, axis=1)
        role = p.motion.record.role
        power[role] = power.get(role, 0.0) + squares
    return {role: float(np.sqrt(x / whole)) for role, (x, whole) in power.items() if whole > 0.0}


def idle_error(inverses: Sequence[InverseDynamics], plant: Plant) -> float | None:
    """Return the error of the load's balance on the identification records where a fitted plant's joint carries nothing there.

    None where it carries, or where no law of its deflection is declared, which then is what it lacks. Infinite where its law has no
    torque. Then no cause is to be named from its balances.
    """
    free = [p for p in inverses if p.motion.record.role == IDENTIFICATION and not p.motion.record.locked]
    if plant.kind != TWO_MASS or not free or not any(_of_deflection(e) for e in plant.effects):
        return None
    error = load_errors(free, plant).get(IDENTIFICATION, np.inf)
    return None if error < IDLE else error


def _of_deflection(e: Effect) -> bool:
    return e.at == "joint" and e.port == FORCE and bool({"q", "dq"} & set(e.reads))


def wound_up(inverses: Sequence[InverseDynamics], plant: Plant) -> tuple[InverseDynamics, ...]:
    """Return inverse dynamics in which a joint between encoders of separate zeros is deflected by what it carries in the mean.

    Where zeros are free the mean angle of a record was taken for one, or its first reading. A straight joint does not mind: its mean
    torque closes the load's balance. The law of another one is read about where it is relaxed, and a weight holds it away from there by
    T/k, in the mean or where the record begins: T what a fitted plant's load asks for, k its joint's stiffness. A load that is locked asks for
    nothing and may hold the joint wound up: there T is what the drive gives in the mean and the motor does not take, if that is most of what
    is left. What has no such zero, or no straight joint, stays as it is.
    """
    springs = [e for e in plant.effects if e.at == "joint" and e.name == "linear_stiffness"]
    k = sum(e.parameters["stiffness"].value for e in springs)
    if plant.kind != TWO_MASS or k <= 0.0:
        return tuple(inverses)
    return tuple(_wound(p, plant, k) if p.motion.record.zero is not None else p for p in inverses)


def _wound(p: InverseDynamics, plant: Plant, k: float) -> InverseDynamics:
    """Return the same motion with the load's encoder read where a plant whose joint has stiffness k says that it is relaxed."""
    record = p.motion.record
    zero = _locked(p, plant, k) if record.locked else _free(p, plant, k)
    if zero == 0.0:
        return p
    channels = {**record.channels, "load_position": record.channels["load_position"] + zero}
    moved = replace(record, channels=channels, zero=record.zero + zero)
    return InverseDynamics(motion(moved, p.motion.filter.bandwidth), counts=p.counts, times=p.times)


def _locked(p: InverseDynamics, plant: Plant, k: float) -> float:
    """Return by how much more the load's encoder reads where a joint between a driven motor and a locked load is relaxed; 0 where the mean is
    no more than HELD of what is left: it may be anything's."""
    left = p.motion.filter(p.command.applied(plant) - balances(p, plant)[0])[p.motion.keep]
    mean = float(np.mean(left))
    return -mean / k if mean**2 > HELD * np.mean(left**2) else 0.0


def _free(p: InverseDynamics, plant: Plant, k: float) -> float:
    """Return the same of a load that moves: what its balance asks for."""
    record, keep = p.motion.record, p.motion.keep
    angle = record.channels["position"] - record.channels["load_position"]
    load = [((e.parameters[n].value if n else 1.0) * c) for e, n, c in p.columns(plant) if e.at == "load"]
    asked = sum(load, np.zeros((2, angle.size))).sum(axis=0)  # closing gave the mean to the motor's balance
    begins = abs(angle[0]) <= max(record.resolution.get(n, 0.0) for n in ("position", "load_position"))
    where = slice(0, 1) if begins else keep
    return float(np.mean(angle[where]) - np.mean(asked[where]) / k)
