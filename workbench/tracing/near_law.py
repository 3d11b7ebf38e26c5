"""Declared friction with a free virgin curve: that a declared law is only nearly right is no missing effect.

A law of the catalogue is an approximation: Coulomb friction is declared where half a micrometre of presliding is, a stretched
exponential where asperities slip at lognormal distances. So the search looks beside the declared friction with a free virgin
curve (Maxwell slip of held slips, heights >= 0); what that curve alone takes is a refinement of the declared law.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.definition import FORCE, Effect
from workbench.effects.free_bank import LENGTHS, NAME, bank_beside, hysteresis_bank
from workbench.effects.table import LEAST
from workbench.identification.problem import Problem
from workbench.identification.solve import NoValue, solve
from workbench.inverse.bodies import CHANNEL
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.tracing.candidates import Candidate
from workbench.tracing.free_forms import MEMORY

# Slips of the free curve of Coulomb friction: from 0.3 of a count, which nothing shows because a dead band of one count lies
# before it, to 100 counts or 1e-2 of the travel, the longest presliding of bearings and guides; a factor of 2.1 apart. Half or
# twice as many change the curve's residual by less than 2 %.
FIRST, COUNTS, TRAVEL, APART = 0.3, 100.0, 1e-2, 2.1
# Where the longest element carries more than CARRIES of the height the curve has not ended there: it goes on to FURTHEST of the
# travel: beyond it lies what a gap or a spring does (a band brake with a gap of 5 % of its travel was taken for a curve).
CARRIES, FURTHEST = 0.1, 0.03
UNSEEN = 1e-6  # of the travel: stands for a count where none is known, and where one is finer no curve begins before it
KEPT = 1e-3  # of the curve's height, below which an element is left out
SEEN = 2.0  # encoder counts above which a presliding length is the axis' own and not a matter of counts


@dataclass(frozen=True)
class Law:
    """A declared friction that a free virgin curve takes the place of. declared: its effect, solved; slips: of the curve, SI."""

    declared: Effect
    slips: tuple[float, ...]

    @property
    def key(self) -> str:
        """Key of the free curve in a plant."""
        return f"{NAME}@{self.declared.at}"


def laws(plant: Plant, inverses: Sequence[InverseDynamics]) -> tuple[Law, ...]:
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
            found.append(Law(e, _slips_at(e.at, inverses)))
    return tuple(found)


def _slips_at(place: str, inverses: Sequence[InverseDynamics]) -> tuple[float, ...]:
    """Return the slips of the free curve of a Coulomb friction, SI."""
    count = max(count_at(place, inverses), _unseen(inverses))
    last = max(COUNTS * count, TRAVEL * max(float(np.ptp(p.motion.q)) for p in inverses))
    return tuple(np.geomspace(FIRST * count, last, 1 + int(np.ceil(np.log(last / (FIRST * count)) / np.log(APART)))))


def gives_way(candidate: Candidate, declared: Plant) -> bool:
    """Whether a candidate is a memory of the friction that is declared at its place."""
    here = (e for e in declared.effects if e.at == candidate.at)
    return candidate.family == MEMORY and any("dir" in {*e.reads, *e.provides} for e in here)


def lengthened(known: Sequence[Law], plant: Plant, inverses: Sequence[InverseDynamics]) -> tuple[Law, ...]:
    """Return laws whose slips go on where the longest element of the curve that stands in a plant carries much of its height."""
    found = []
    stands = {e.key: e for e in plant.effects}
    furthest = FURTHEST * max(float(np.ptp(p.motion.q)) for p in inverses)
    for law in known:
        last = law.slips[-1]
        held = heights(stands[law.key]) if law.key in stands else {}
        if held.get(last, 0.0) > CARRIES * sum(held.values()) and last < furthest:
            count = int(np.ceil(np.log(furthest / last) / np.log(APART)))
            more = last * (furthest / last) ** (np.arange(1, count + 1) / count)
            law = replace(law, slips=(*law.slips, *map(float, more)))
        found.append(law)
    return tuple(found)


def count_at(place: str, inverses: Sequence[InverseDynamics]) -> float:
    """Return the encoder's count at a place in SI, UNSEEN of the travel where it is not known."""
    known = [p.bodies.counts(CHANNEL.get(place, "position")) for p in inverses]
    return max(known, default=0.0) or _unseen(inverses)


def _unseen(inverses: Sequence[InverseDynamics]) -> float:
    """Return what stands for a count where none is known, SI."""
    return UNSEEN * max(float(np.ptp(p.motion.q)) for p in inverses)


def as_declared(plant: Plant, known: Sequence[Law]) -> Plant:
    """Return the plant with its free curves put back to the declared laws."""
    held = {e.key for e in plant.effects}
    for law in known:
        if law.key in held:
            plant = plant.without(law.key) + law.declared
    return plant


def freed(plant: Plant, known: Sequence[Law], inverses: Sequence[InverseDynamics]) -> Plant:
    """Return the plant with the free virgin curves of `known`, where their declared laws or earlier curves stand in it.

    Shape parameters hold while the heights are found; elements that hold nothing are left out, and a curve of height 0 leaves
    the declared law. Until then the direction is that of the law or curve that stands there.
    """
    present = {e.key: e for e in plant.effects}
    plant = as_declared(plant, known)
    here = [law for law in known if law.declared.key in {e.key for e in plant.effects}]
    if not here:
        return plant
    held = plant
    for e in plant.effects:
        held = held.swap(replace(e, parameters={n: replace(p, fixed=p.fixed or n not in e.linear) for n, p in e.parameters.items()}))  # fmt: skip
    for law in here:
        stood = heights(present[law.key]) if law.key in present else {}
        holds = any(stood.get(s, 0.0) > 0.0 for s in law.slips)
        begun = _curve(law, stood) if holds else bank_beside(law.slips, [plant[law.declared.key]], law.declared.at)
        held = held.without(law.declared.key) + begun
    try:
        problem = Problem(held, inverses)
        solved = problem.with_linear(held, solve(problem, most=0).c)
    except NoValue:
        return plant
    for law in here:
        found = heights(solved[law.key])
        if sum(found.values()) > 0.0:
            plant = plant.without(law.declared.key) + _curve(law, found)
    return plant


def heights(bank: Effect) -> dict[float, float]:
    """Return slip -> height of the elements of a bank."""
    p = {n: p.value for n, p in bank.parameters.items()}
    return {p[f"slip{n[1:]}"]: value * p[f"slip{n[1:]}"] for n, value in p.items() if n in bank.linear}


def _curve(law: Law, found: Mapping[float, float]) -> Effect:
    """Return the free virgin curve whose elements hold these heights, by slip, those that hold nothing left out."""
    every = np.array([found.get(s, 0.0) for s in law.slips])
    kept = np.sort(np.argsort(-every, kind="stable")[: max(LEAST, np.count_nonzero(every > KEPT * every.sum()))])
    slips, held = np.array(law.slips)[kept], every[kept]
    virgin = np.minimum(slips[:, None] / slips, 1.0) @ held
    return hysteresis_bank(slips, virgin / virgin[-1], virgin[-1], law.declared.at)
