"""A plan: motions picked from the pool one after another until every parameter's predicted interval is narrow enough.

Each pick maximises -log det(P + T), P the covariance predicted with it and T what accuracy is asked for: D-optimal
(Fedorov 1972) in what is still missing, and indifferent to what is known well enough. Its size is then optimised within
the limits. The picks are joined by moves into one trajectory, and what is promised is computed from that.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.errors import WorkbenchError
from workbench.identification import intervals
from workbench.identification.result import Estimate
from workbench.planning.envelope import Envelope, Sensing
from workbench.planning.following import followed
from workbench.planning.information import Information, information, names_of
from workbench.planning.motions import Reference, joined
from workbench.planning.pool import pool
from workbench.plant import Plant
from workbench.threads import one_thread

SECONDS = 5.0  # length of each motion of the pool
MOST = 12  # motions of one plan
CHANCE = 0.05  # that any parameter of a record lies outside what was promised
MARGIN = 1.3  # by which a plan aims to be better than what it is asked for
SIZES = (0.6, 0.77, 1.3, 1.7)  # factors on the size of a pick that are tried
WORTH = 1.02  # factor by which the worst parameter must get better for a motion to be added

Progress = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Plan:
    """picks: the motions. trajectory: all of them, joined by moves, one record; the load's where there are two masses.

    drive (n,): what it takes, N*m or N. position (n,): of the drive's encoder, the motor's.

    promised: every parameter as written outside, with the interval that a record of the trajectory would give: all of them
    hold at once in 95 of 100 such records.
    information, covariance (p, p): what this comes from, of the free parameters as information.names_of orders them.
    """

    plant: Plant
    picks: tuple[Reference, ...]
    trajectory: Reference
    drive: np.ndarray
    position: np.ndarray
    promised: tuple[Estimate, ...]
    information: Information
    covariance: np.ndarray


@dataclass(frozen=True, eq=False)
class Trial:
    reference: Reference
    information: Information


class Aim:
    """How good a covariance is, for an accuracy (a share of each parameter's size) that is asked for."""

    def __init__(self, plant: Plant, accuracy: float):
        self.plant, self.names = plant, names_of(plant)
        self.sizes = np.array([_size_of(plant, n) for n in self.names])
        self.width = _width(len(self.names))
        self.variance = (accuracy / self.width / MARGIN) ** 2

    def missing(self, known: Information) -> float:
        """Return log det(P + T), of parameters in units of their sizes: what is still to be learnt."""
        scaled = known.covariance(self.sizes) / np.outer(self.sizes, self.sizes)
        return float(np.linalg.slogdet(scaled + self.variance * np.eye(len(scaled)))[1])

    def reached(self, known: Information) -> bool:
        """Whether every parameter is known as well as is asked for."""
        return bool((np.diag(known.covariance(self.sizes)) <= self.variance * self.sizes**2).all())


def _width(count: int) -> float:
    """Return the half width, in standard deviations, of intervals that hold for all of `count` parameters at once (Bonferroni)."""
    from scipy.special import ndtri

    return float(ndtri(1.0 - CHANCE / (2 * max(count, 1))))


def _size_of(plant: Plant, name) -> float:
    """Return what a parameter's accuracy is a share of: its value; of one that is zero, the largest of its own kind."""
    parameter = plant[name.key].parameters[name.parameter]
    alike = [abs(p.value) for p in plant[name.key].parameters.values() if p.unit == parameter.unit]
    return abs(parameter.value) or max(alike) or 1.0


@one_thread
def design(
    plant: Plant,
    envelope: Envelope,
    sensing: Sensing,
    accuracy: float,
    *,
    seconds: float = SECONDS,
    most: int = MOST,
    progress: Progress = lambda _: None,
) -> Plan:
    """Return the plan that determines the free parameters of a plant at its values.

    accuracy: half width of the interval asked for, a share of each parameter's value. seconds: length of each motion.
    most: motions at most. Raises WorkbenchError where no motion of the pool is within the limits.
    """
    aim = Aim(plant, accuracy)
    progress("trying motions")
    trials = [
        t
        for r in pool(plant.effects, envelope, sensing, seconds, plant.displacement)
        if (t := tried(r, plant, envelope, sensing))
    ]
    if not trials:
        raise WorkbenchError(
            "no motion of the pool is within the limits; allow more travel, speed, acceleration or drive."
        )
    empty = Information(*(np.zeros((len(aim.names), len(aim.names))),) * 2)
    picks: list[Reference] = []
    known = empty
    while len(picks) < most and not (picks and aim.reached(known)):
        progress(f"picking motion {len(picks) + 1}")
        best = min(trials, key=lambda t: aim.missing(known + t.information))
        best = _resized(best, known, aim, plant, envelope, sensing)
        if picks and aim.missing(known + best.information) > aim.missing(known) - len(aim.names) * np.log(WORTH):
            break
        picks.append(best.reference)
        known = known + best.information
    return _finished(plant, aim, sorted(picks, key=lambda r: r.phrase), envelope, sensing)


def tried(reference: Reference, plant: Plant, envelope: Envelope, sensing: Sensing) -> Trial | None:
    """Return what a motion tells; None where it is not within the limits or an effect has no value along it."""
    if not reference.within(envelope):
        return None
    inverse = followed(reference, plant, sensing)
    if not np.abs(inverse.motion.u).max() <= envelope.drive:  # nor one that no drive follows
        return None
    found = information(inverse, plant, sensing)
    return Trial(reference, found) if found else None


def _resized(trial: Trial, known: Information, aim: Aim, plant: Plant, envelope: Envelope, sensing: Sensing) -> Trial:
    """Return the motion at the best of a few sizes within the limits."""
    if trial.reference.sized is None:
        return trial
    others = (tried(trial.reference.sized(factor), plant, envelope, sensing) for factor in SIZES)
    return min((trial, *(t for t in others if t)), key=lambda t: aim.missing(known + t.information))


def _finished(plant: Plant, aim: Aim, picks: Sequence[Reference], envelope: Envelope, sensing: Sensing) -> Plan:
    """Return the plan of these picks, its promise computed from the whole trajectory."""
    trajectory = joined(picks, envelope)
    inverse = followed(trajectory, plant, sensing)
    whole = information(inverse, plant, sensing)
    covariance = whole.covariance(aim.sizes)
    promised = intervals.estimates(plant, aim.names, covariance, aim.width)
    m = inverse.motion
    return Plan(plant, tuple(picks), trajectory, m.u, m.record.channels["position"], promised, whole, covariance)
