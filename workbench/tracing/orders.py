"""Whether a wave is one: orders of a mechanism are those of its shafts and teeth, and what the travel does not show to return may be any curve."""

from collections.abc import Sequence
from math import pi

import numpy as np

from workbench.definition import Effect
from workbench.effects.families import FREE_FORMS, family_of
from workbench.inverse.dynamics import InverseDynamics
from workbench.plant import Plant
from workbench.tracing.candidates import ADDITION, WHOLE, Candidate, Offer, without
from workbench.tracing.criteria import Criteria
from workbench.tracing.discs import MEETS
from workbench.tracing.judge import ScoredCandidate, everything_free, judged
from workbench.tracing.plausible import returns
from workbench.tracing.state import State

# Orders of one mechanism are those of its shafts and teeth: two stand as small numbers. What lives in position without being
# periodic is dressed by waves whose orders do not (within MEETS). Halved, orders 5 and 6 of a shaft are strangers; doubled, nearly none are.
SMALL = 6
# Share of the residual's power from which a wave that is not seen to return is a sine nevertheless: of a window half as long as its period a sine
# takes 8/pi^2 = 0.81 (a bath that a belt dips into 0.86), of a sine all (a rig's friction of 1.7 periods 0.97). Halved, windows are cyclic friction;
# doubled (1 at most), that friction is "unknown"
SINE = 0.9


def stranger(wave: Effect, plant: Plant, inverses: Sequence[InverseDynamics]) -> bool:
    """Whether a wave of a plant stands to no other one of its name and place as small numbers, nor to a shaft of the axis, though there is
    another one. Of the axis' own turn, and of its motor's, where the travel holds a turn of the axis: else a window of it may be any order's."""
    others = [e for e in plant.effects if (e.name, e.at) == (wave.name, wave.at) and e.key != wave.key]
    name = next((n for n, p in wave.parameters.items() if p.scale == "order"), None)
    if name is None or not others:
        return False
    order = wave.parameters[name].value
    known = [e.parameters[name].value for e in others]
    travel = max(float(np.ptp(p.motion.q)) for p in inverses)
    if plant.rotary and travel >= 2.0 * pi:
        known += [1.0, plant.geometry.gear_ratio]
    ratios = [order / of for of in known if of > 0.0]
    small = [p / q for p in range(1, SMALL + 1) for q in range(1, SMALL + 1)]
    return bool(ratios) and not any(abs(r / s - 1.0) < MEETS for r in ratios for s in small)


def of_no_mechanism(j: ScoredCandidate, state: State) -> bool:
    """Whether a fitted candidate is a further wave of an order that no mechanism has beside the waves that are there. What returns and takes
    SINE of all that is left is a sine, and no part of a curve: a pinion's teeth are as many as they are."""
    if not j.refitted or j.candidate.kind != ADDITION:
        return False
    wave = j.refitted.plant[j.candidate.key]
    if "order" in wave.parameters and j.score.gain >= SINE and returns(wave, state.inverses):
        return False
    return stranger(wave, j.refitted.plant, state.inverses)


def any_curve(j: ScoredCandidate, state: State, criteria: Criteria, offer: Offer = WHOLE) -> bool:
    """Whether a fitted candidate is a wave that draws whatever lives in a part of the stroke: the travel does not show it to return, it leaves
    plainly something, and in its class no law of the catalogue is a curve."""
    if not j.refitted or j.candidate.kind != ADDITION:
        return False
    wave = j.refitted.plant[j.candidate.key]
    form = FREE_FORMS.get(family_of(wave))
    curved = "order" not in wave.parameters or form is None or bool(form.nearest)
    # the angle between two encoders is measured: what takes `near` of it is the gear's, of whatever shape
    measured = j.candidate.at == "joint"
    sure = criteria.near if measured else SINE
    if curved or j.score.gain >= sure or returns(wave, state.inverses, rotary=state.plant.rotary):
        return False
    return not (measured and _share_beside_teeth(j, state, criteria, offer) >= sure)


def _share_beside_teeth(j: ScoredCandidate, state: State, criteria: Criteria, offer: Offer) -> float:
    """Return the share that a fitted wave takes of what a further order of its own leaves that the travel does show to return; 0 where none earns
    its place. Of a pinion's turn, of which a slide's travel held 1.7, and its teeth a sine took 0.73, and 0.99 beside the teeth."""
    with_it = j.refitted.state
    c = next(iter(further_orders(j.candidate, with_it, offer)), None)
    if c is None:
        return 0.0
    teeth = everything_free(with_it, ScoredCandidate(c, **judged(with_it, c, criteria, offer.budget)), criteria)
    if not (teeth.refitted and teeth.score.earns):
        return 0.0
    both = teeth.refitted.state
    if not returns(both.plant[c.key], state.inverses, rotary=state.plant.rotary):
        return 0.0
    alone = State(without(both.plant, j.candidate, state.plant), state.inverses)
    return 1.0 - both.errors.total / alone.errors.total


def further_orders(wave: Candidate, state: State, offer: Offer) -> list[Candidate]:
    """Return what is offered of a wave beside a state that has it: one candidate, the same effect at its next order, or none."""
    name = wave.plant[wave.key].name
    offered = (c for c in offer.candidates(state.plant) if c.kind == ADDITION and c.at == wave.at)
    return [c for c in offered if c.plant[c.key].name == name and c.key != wave.key]
