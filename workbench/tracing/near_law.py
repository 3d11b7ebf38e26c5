"""Declared friction with a free virgin curve: that a declared law is only nearly right is no missing effect.

A law of the catalogue is an approximation: Coulomb friction is declared where half a micrometre of presliding is, a stretched
exponential where asperities slip at lognormal distances. So the search looks beside the declared friction with a free virgin
curve (Maxwell slip of held slips, heights >= 0); what that curve alone takes is a refinement of the declared law.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.definition import FORCE, Effect
from workbench.effects.free_bank import LENGTHS, NAME, hysteresis_bank
from workbench.effects.hysteresis import maxwell_slip
from workbench.identification.bodies import CHANNEL
from workbench.identification.passes import Passes
from workbench.identification.problem import Problem
from workbench.identification.solve import NoValue, solve
from workbench.plant import Plant

# Slips of the free curve of Coulomb friction: from 0.3 of a count, which nothing shows because a dead band of one count lies
# before it, to 100 counts or 1e-2 of the travel, the longest presliding of bearings and guides; a factor of 2.1 apart. Half or
# twice as many change the curve's residual by less than 2 %.
FIRST, COUNTS, TRAVEL, APART = 0.3, 100.0, 1e-2, 2.1
LEAST = 3  # elements of a curve
UNSEEN = 1e-6  # of the travel: stands for a count where none is known
KEPT = 1e-3  # of the curve's height, below which an element is left out


@dataclass(frozen=True)
class Law:
    """A declared friction that a free virgin curve takes the place of. declared: its effect, solved; slips: of the curve, SI."""

    declared: Effect
    slips: tuple[float, ...]

    @property
    def key(self) -> str:
        """Key of the free curve in a plant."""
        return f"{NAME}@{self.declared.at}"


def laws(plant: Plant, passes: Sequence[Passes]) -> tuple[Law, ...]:
    """Return the declared dry frictions and frictions with memory whose size is free, each with the slips of its free curve.

    plant: solved on these records. Coulomb friction beside friction with memory is another contact, and is left as it is.
    """
    found = []
    for e in sorted(plant.effects, key=lambda e: e.key):
        if e.port != FORCE or any(e.parameters[n].fixed for n in e.linear):
            continue
        if "dir" in e.provides and "x0" in e.parameters:
            found.append(Law(e, tuple(e.parameters["x0"].value * k for k in LENGTHS)))
        elif e.reads == ("dir",) and len(e.linear) == 1 and not any(o.provides and o.at == e.at for o in plant.effects):
            found.append(Law(e, slips_at(e.at, passes)))
    return tuple(found)


def slips_at(place: str, passes: Sequence[Passes]) -> tuple[float, ...]:
    """Return the slips of the free curve of a Coulomb friction, SI."""
    count = count_at(place, passes)
    last = max(COUNTS * count, TRAVEL * max(float(np.ptp(p.motion.q)) for p in passes))
    return tuple(np.geomspace(FIRST * count, last, 1 + int(np.ceil(np.log(last / (FIRST * count)) / np.log(APART)))))


def count_at(place: str, passes: Sequence[Passes]) -> float:
    """Return the encoder's count at a place in SI, UNSEEN of the travel where it is not known."""
    known = [p.bodies.counts(CHANNEL.get(place, "position")) for p in passes]
    travel = max(float(np.ptp(p.motion.q)) for p in passes)
    return max([*known, UNSEEN * travel])


def as_declared(plant: Plant, known: Sequence[Law]) -> Plant:
    """Return the plant with its free curves put back to the declared laws."""
    held = {e.key for e in plant.effects}
    for law in known:
        if law.key in held:
            plant = plant.without(law.key) + law.declared
    return plant


def freed(plant: Plant, known: Sequence[Law], passes: Sequence[Passes]) -> Plant:
    """Return the plant with the free virgin curves of `known`, where their declared laws or earlier curves stand in it.

    Shape parameters hold while the heights are found; elements that hold nothing are left out, and a curve of height 0 leaves
    the declared law.
    """
    plant = as_declared(plant, known)
    here = [law for law in known if law.declared.key in {e.key for e in plant.effects}]
    if not here:
        return plant
    held = plant
    for e in plant.effects:
        held = held.swap(replace(e, parameters={n: replace(p, fixed=p.fixed or n not in e.linear) for n, p in e.parameters.items()}))  # fmt: skip
    for law in here:
        held = held.without(law.declared.key) + bank(law)
    try:
        problem = Problem(held, passes)
        solved = problem.with_linear(held, solve(problem, most=0).c)
    except NoValue:
        return plant
    for law in here:
        springs = solved[bank(law).key].parameters
        heights = np.array([springs[f"k{i}"].value * d for i, d in enumerate(law.slips, 1)])
        if heights.sum() > 0.0:
            plant = plant.without(law.declared.key) + curve(law, heights)
    return plant


def curve(law: Law, heights: np.ndarray) -> Effect:
    """Return the free virgin curve whose elements hold these heights (slips,), those that hold nothing left out."""
    kept = np.sort(np.argsort(-heights, kind="stable")[: max(LEAST, np.count_nonzero(heights > KEPT * heights.sum()))])
    slips, held = np.array(law.slips)[kept], heights[kept]
    virgin = np.minimum(slips[:, None] / slips, 1.0) @ held
    return hysteresis_bank(slips, virgin / virgin[-1], virgin[-1], law.declared.at)


def bank(law: Law) -> Effect:
    """Return the Maxwell slip of held slips from which a free curve is found."""
    return maxwell_slip(law.slips)(at=law.declared.at)
