"""What lay before a record: friction with memory starts in a state that no channel holds.

A campaign may promise that its records start with relaxed friction (`initial_condition`). Where it does not, the state is
that after one displacement h from the relaxed one, h of each record: an operator of increments keeps of its past what its
last reversals left, and h is the largest of them. It is searched where the memory is long (a gap before the friction, a belt), and where
a record begins at rest or about a turn, and what it held there is a good part of what is left of it:

    h = argmin over [-SPAN r, SPAN r] of |F(u - R(q; h))|^2        r: the lengths of the operators with memory, summed

h is no parameter of the axis: it is found for validation records, too, as the zeros of two encoders are.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from workbench.inverse.balances import predicted
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import Motion, motion
from workbench.plant import Plant

Made = TypeVar("Made")

# Memory over a record's travel from which its start is searched. Presliding of bearings is below 1e-3: the first move erases
# it. Halved or doubled, no campaign here changes; a gap of a tenth of the travel leaves a third of a record in doubt.
LONG = 0.02
# Share of what a relaxed start leaves of a record, that it leaves before the body has moved as far as its friction remembers, from which the
# start is searched, too. Of a valve it left 15 % of the drive over a twelfth of a record, beside 1.2 elsewhere; of an arm that friction holds against
# its weight it is 0.14 to 0.52. Of some hundred records of strangers that promise nothing a dozen reach it; halved, four more are searched; doubled, one
# of the arm's is not
EARLY = 0.1
# Share of what a relaxed start leaves, above which another one is no start but chance. With 0.96 or 0.99 the errors of eight axes are the same
WORTH = 0.98
# Of its virgin curve a friction has a four-hundredth still to come beyond so many lengths. At 1.5 a platform that hung on its brake leaves 1.5 % on
# validation as it is declared, halved 0.96, and 0.85 with this or with twice as much
SPAN = 6.0
ROUNDS = 4  # of starts and parameters by turns: a length that was fitted to a wrong start is wrong itself
SETTLED = 0.98  # of the cost before a round, above which the next would be the same
PERIODS = 8.0  # of the band's edge beyond where it is forgotten, so that its filter has something to pass; halved or doubled, the same starts
COARSE, FINE = 13, 7  # values of h tried over the span, and then about the best


def begun(plant: Plant, inverses: Sequence[InverseDynamics]) -> tuple[InverseDynamics, ...] | None:
    """Return the inverse dynamics with the displacement before each record that a fitted plant asks for, or None where no start is open,
    or each is what was found before."""
    found = [_begun(plant, p) for p in inverses]
    if all(new is old for new, old in zip(found, inverses, strict=True)):
        return None
    return tuple(found)


def by_turns(fit: Made, again: Callable[[Made], Made | None], cost: Callable[[Made], float]) -> Made:
    """Return a fit of which starts and parameters were found by turns, as long as it then costs less.

    again(fit): fitted on the records as they begin with `fit`; None where no start changes.
    """
    for _ in range(ROUNDS):
        more = again(fit)
        if more is None or cost(more) >= cost(fit):
            break
        settled = cost(more) > SETTLED * cost(fit)
        fit = more
        if settled:
            break
    return fit


def begun_at(inverses: Sequence[InverseDynamics], starts: Sequence[float | None]) -> tuple[InverseDynamics, ...]:
    """Return the inverse dynamics over records that were begun by these displacements (m or rad), None from relaxed friction; those
    of which that was found before as they are."""
    return tuple(_at(p, h) for p, h in zip(inverses, starts, strict=True))


def _at(p: InverseDynamics, h: float | None) -> InverseDynamics:
    """Return the inverse dynamics over a record that was begun by a displacement h, its operators at the rate at which they ran."""
    if h == p.motion.record.found:
        return p
    if p.fine is None or p.times > 1:
        return InverseDynamics(displaced(p.motion, h), counts=p.counts, times=p.times)
    return InverseDynamics(displaced(p.motion, h), InverseDynamics(displaced(p.fine.motion, h)), p.coarse, p.counts)


def _begun(plant: Plant, p: InverseDynamics) -> InverseDynamics:
    reach = _memory(plant)
    if p.motion.record.history is not None or reach <= 0.0:
        return p
    bare = _at(p, None)
    m, relaxed = bare.motion, _residual(plant, bare)
    if reach < LONG * np.ptp(m.q[m.keep]) and _early(relaxed, m, reach) < EARLY:
        return bare
    best, gained = _start(plant, _remembering(bare, reach), reach)
    return bare if gained < (1.0 - WORTH) * float(relaxed @ relaxed) else _at(p, best)


def _start(plant: Plant, p: InverseDynamics, reach: float) -> tuple[float, float]:
    """Return the displacement before a record that leaves least, and how much less power it leaves than none."""
    even = np.linspace(-1.0, 1.0, COARSE)
    tried = SPAN * reach * even * np.abs(even)  # closer where a virgin curve bends
    left = {float(h): _left(plant, p, h) for h in tried}
    at = int(np.argmin([*left.values()]))
    about = np.linspace(tried[max(at - 1, 0)], tried[min(at + 1, COARSE - 1)], FINE)
    left |= {float(h): _left(plant, p, h) for h in about if float(h) not in left}
    best = min(left, key=left.__getitem__)
    return best, left[0.0] - left[best]


def _remembering(p: InverseDynamics, reach: float) -> InverseDynamics:
    """Return the inverse dynamics over the part of a record in which it still matters how it was begun: all of it where the joint's mean torque
    is read off the whole."""
    m = p.motion
    away = np.abs(m.q - m.q[0]) >= 2.0 * SPAN * reach
    end = int(np.argmax(away)) + 2 * m.filter.trim + round(PERIODS / (m.filter.bandwidth * m.dt))
    if not away.any() or m.record.zero is not None or 2 * end > m.q.size:
        return p
    channels = {n: x[:end] for n, x in m.record.channels.items()}
    first = motion(replace(m.record, time=m.record.time[:end], channels=channels), m.filter.bandwidth)
    return InverseDynamics(first, times=p.times)


def _early(residual: np.ndarray, m: Motion, reach: float) -> float:
    """Return the share of a residual's power (n,) before the body is twice `reach` (m or rad) away from where it began."""
    q = m.q[m.keep]
    away = np.abs(q - q[0]) >= 2.0 * reach
    first = residual[: int(np.argmax(away)) if away.any() else None]
    return float(first @ first) / max(float(residual @ residual), 1e-300)


def _memory(plant: Plant) -> float:
    """Return the length (m or rad) over which forces on the motor's side remember where they turned: of each the lengths that are free, of a
    bank of given ones the longest."""
    lengths = []
    for e in plant.effects:
        if e.at in ("axis", "motor") and "dq" in e.reads and e.states:
            own = [p for p in e.parameters.values() if p.scale == "stroke"]
            free = [p.value for p in own if not p.fixed]
            lengths.append(sum(free) if free else max((p.value for p in own), default=0.0))
    return float(sum(lengths))


def _left(plant: Plant, p: InverseDynamics, h: float) -> float:
    """Return the power that a plant leaves of the filtered drive where the record was begun by a displacement h."""
    residual = _residual(plant, InverseDynamics(displaced(p.motion, h), times=p.times))
    return float(residual @ residual)


def _residual(plant: Plant, p: InverseDynamics) -> np.ndarray:
    m = p.motion
    return m.filter(m.u - predicted(p, plant))[m.keep]


def displaced(motion: Motion, h: float | None) -> Motion:
    """Return a motion whose record was begun by a displacement h (m or rad) from the relaxed state; None where that is not known."""
    dq = np.array(motion.dq)
    dq[0] += (h or 0.0) - (motion.record.found or 0.0)
    return replace(motion, dq=dq, record=replace(motion.record, found=h))
