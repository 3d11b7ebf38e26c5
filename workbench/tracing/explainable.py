"""How much of a residual anything could predict: out of sample, from what is outside the loop.

In a closed loop noise becomes motion, so that of pure noise more than half is "predicted" from the measured motion. What is
outside the loop is not moved by it: the reference and its past, where it is, which way it goes, how far since it turned, and
bench time (instruments: Young 2011; Janot, Gautier, Brunot 2019). Five kinds are asked, each out of sample:

- exogenous: boosted trees over the reference's motion, blocks of BLOCK s left out by turns, no standstill of an axis that rubs;
- time: a stretch of STRETCH s from its neighbours in bench time, as what goes with the direction, the speed or the acceleration (a
  friction, a damping, a mass that changes), and not as well as a level, or a mass and its weight;
- line: the strongest line of the spectrum that neither the reference nor the drive has. Hum of the mains is told apart (`lines`);
- burst: power of the samples far outside what the residual usually is;
- joint: of two masses, what the deflection says with a stiffness of the joint from neighbours in place on the stroke. The deflection is
  measured, and noise in it biases a stiffness; but everywhere alike, so that only what differs from place to place counts.

Of one mass it is also asked what an inertia, or a drive's constant, that changes along the stroke would take (`along_stroke`). The acceleration of a swing goes
with its place, so that other laws of place look like that, too; it is no sixth kind, and is held against what the effects take. So is a share
of the model's own drive that neighbours in bench time predict, of a drive whose gain changes.
"""

from collections.abc import Sequence
from math import sqrt

import numpy as np

from workbench.identification.cross_validation import Deviations, folds_of
from workbench.inverse.bodies import POSITION
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import MOTION_BAND, LowPass
from workbench.plant import TWO_MASS
from workbench.tracing.along_stroke import by_place
from workbench.tracing.counted import edge
from workbench.tracing.criteria import Criteria
from workbench.tracing.decimation import rubs
from workbench.tracing.evidence import Explainable
from workbench.tracing.foreseen import BLOCK, FOLDS, LEAST_LEAF, foreseen, numbered
from workbench.tracing.lines import Part, strongest_lines
from workbench.tracing.neighbours import STRETCH, gain_over_time, gained, of_neighbours, over_time, payload_over_time
from workbench.tracing.of_the_day import without_the_days
from workbench.tracing.state import State

# Of the stroke, widths of the neighbourhood in place. Where a belt's stiffness changes along it, each from 0.01 to 0.1 takes 4.4 to 3.2 %
# of the drive, and 0.2 takes 2.1; of thirteen complete two-mass axes none takes anything, with any of them
NEARBY = (0.02, 0.05, 0.1)
# Of the speed's rms, and s after a reversal, that are standstill. A complete axis of two masses whose load's friction gives way over 84 counts shows
# 0.4 % of the drive in motion, near the practical size: halved, 0.65 and 0.8, and that memory is a cause; doubled, 0.1 and 0.04. Beside a gap it
# shows less than 0.03 % with any of them
STILL, TURNING = 0.05, 0.06
# Jerks of one count of an encoder (`counted.edge`), that a sample of a burst is larger than: two counts may follow each other.
# Halved or doubled, three axes whose moments it weighs keep their verdicts
EDGES = 2.0
HEAVY = 20.0  # evaluation bandwidth over that of the position's low pass, where no reference was logged
# Of all blocks' weight, that holds each fit to the others at the common one: a knot of a curve that the axis passes in two blocks of one fold alone
# went to 80 000 N, and left 126 % of the drive there. A tenth and ten times as much say the same of it
COMMON = 1e-3


def explainable(state: State, criteria: Criteria) -> Explainable:
    """Return what could be explained of a state's residual of the drive, over the drive's rms."""
    residuals = without_the_days(state, _unseen(state))
    ratio = state.plant.geometry.gear_ratio
    # what has no friction never stands still: a lens on leaf springs turns at 10 Hz, and a magnet that leaves its gap on one side would show in
    # a sixth of what it leaves
    stops = rubs(state.plant)
    parts = [part(p, r, ratio, stops=stops) for p, r in zip(state.inverses, residuals, strict=True)]
    whole = sum(float(p.residual @ p.residual) for p in parts)
    unit = 1.0 / sqrt(state.power) if state.power > 0.0 else 0.0
    referenced = all("reference" in p.motion.record.channels for p in state.inverses)
    line, hum = strongest_lines(parts, criteria.line)
    time, level = over_time(parts, criteria.burst)
    return Explainable(
        exogenous=unit * sqrt(_exogenous(parts)),
        time=unit * sqrt(max(time, payload_over_time(parts))),
        line=unit * sqrt(line.share * whole),
        burst=unit * sqrt(_beyond_counts(state, parts, criteria.burst, criteria.share * whole)),
        frequency=line.frequency,
        hum=unit * sqrt(hum.share * whole),
        mains=hum.frequency,
        joint=unit * sqrt(_over_place(state, parts)),
        inertia=unit * sqrt(max((gained(*told) for told in by_place(state)), default=0.0)),
        level=unit * sqrt(level),
        gain=unit * sqrt(gain_over_time(parts)),
        instrument="reference" if referenced else "low-passed position",
    )


def _unseen(state: State) -> np.ndarray:
    """Return the residual (N,) of each block by a fit to the others: what free laws would take of noise is not taken."""
    model, residual = Deviations(state.problem, state.solution), state.solution.residual
    blocks = state.problem.blocks(BLOCK)
    grams = np.array([model.columns[b].T @ model.columns[b] for b in blocks])
    moments = np.array([model.columns[b].T @ residual[b] for b in blocks])
    found = np.array(residual)
    common = COMMON * grams.sum(axis=0)
    for out, rest in folds_of(len(blocks), FOLDS):
        d = model.best(grams[rest].sum(axis=0) + common, moments[rest].sum(axis=0))
        for i in out:
            found[blocks[i]] -= model.columns[blocks[i]] @ d
    return found


def part(p: InverseDynamics, residual: np.ndarray, ratio: float, *, stops: bool = True) -> Part:
    """Return a record's Part. residual: of the drive, in the samples that count. ratio: motor turns per output turn. stops: whether the axis
    has friction, of which rest and a turn show but counts."""
    m = p.motion
    keep = m.keep
    logged = m.record.channels.get("reference")
    band = MOTION_BAND * m.filter.bandwidth if logged is not None else m.filter.bandwidth / HEAVY
    reference = m.record.channels["position"] if logged is None else logged
    q, v, a = LowPass(band, 1 / m.dt, m.u.size).derivatives(reference, 3)
    way = _held_sign(v)
    near, far = (max(1, round(k / m.filter.bandwidth / m.dt)) for k in (0.5, 2.0))
    turn = 2.0 * np.pi / max(ratio, 1e-12)
    features = [q, v, a, way, np.log(_travelled(q, way) + 1e-3 * np.ptp(q) + 1e-300), np.abs(v)]
    features += [np.roll(a, near), np.roll(a, -near), np.roll(v, far), np.mod(q, turn)]
    moves = _moving(m.v, m.dt, keep) if stops else np.ones(m.v.size, dtype=bool)
    if p.counts is not None:  # where the balance does not count nothing is left, and what is usual there is no measure
        moves &= p.counts[0]
    return Part(
        residual, np.column_stack(features)[keep], moves[keep], _held_sign(m.v)[keep], m.t[keep], m.dt,
        m.filter(m.u)[keep], q[keep], m.filter.bandwidth,
    )  # fmt: skip


def _held_sign(v: np.ndarray) -> np.ndarray:
    """Return the sign of v (n,), where it is 1 % of its rms or less the one before."""
    plain = np.where(np.abs(v) > 0.01 * np.sqrt(np.mean(v**2)), np.sign(v), 0.0)
    last = np.maximum.accumulate(np.where(plain != 0.0, np.arange(v.size), 0))
    return plain[last]


def _travelled(q: np.ndarray, way: np.ndarray) -> np.ndarray:
    """Return the distance (n,) since the way last turned."""
    distance = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(q)))])
    mark = np.zeros(q.size)
    turns = np.flatnonzero(np.diff(way)) + 1
    mark[turns] = distance[turns]
    return distance - np.maximum.accumulate(mark)


def _moving(v: np.ndarray, dt: float, keep: slice) -> np.ndarray:
    """Return where (n,) the axis is neither at rest nor just turned: there friction is a matter of counts."""
    moves = np.abs(v) > STILL * np.sqrt(np.mean(v[keep] ** 2))
    turned = np.concatenate([[0], np.cumsum(np.diff(np.sign(v)) != 0)])
    before = np.concatenate([np.zeros(min(v.size, round(TURNING / dt)), int), turned])[: v.size]
    return moves & (turned == before)


def _exogenous(parts: Sequence[Part]) -> float:
    """Return the power that the reference's motion predicts out of sample, standstill left out; records weigh alike."""
    y, moves = np.concatenate([p.residual for p in parts]), np.concatenate([p.moves for p in parts])
    found, block = foreseen(parts, y, moves), numbered(parts)
    told = np.isfinite(found)
    before = np.bincount(block[told], y[told] ** 2, block[-1] + 1)
    after = np.bincount(block[told], (y[told] - found[told]) ** 2, block[-1] + 1)
    return gained(before, after)


def _over_place(state: State, parts: Sequence[Part]) -> float:
    """Return the power that neighbours in place predict with the joint's deflection, less what is everywhere alike: the best of NEARBY."""
    if state.plant.kind != TWO_MASS:
        return 0.0
    sums = []
    for p, x in zip(parts, state.inverses, strict=True):
        stretch = np.floor((p.time - p.time[0]) / STRETCH).astype(int)
        deflection = x.bodies.joint(state.plant)[1][POSITION][x.motion.keep]
        r, d = (np.where(p.moves, y, 0.0) for y in (p.residual, deflection - deflection.mean()))
        place = np.bincount(stretch, p.outside[:, 0]) / np.maximum(np.bincount(stretch), 1)
        sums.append(np.stack([place, *(np.bincount(stretch, w) for w in (r**2, r * d, d**2))]))
    place, power, total, weight = np.concatenate(sums, axis=1)
    alike = total.sum() / max(weight.sum(), 1e-300)
    power, total = power - 2.0 * alike * total + alike**2 * weight, total - alike * weight
    best = 0.0
    for width in NEARBY:
        mean = of_neighbours(place, width * max(float(np.ptp(place)), 1e-300), total, weight)
        best = max(best, gained(power, power - 2.0 * mean * total + mean**2 * weight))
    return best


def _beyond_counts(state: State, parts: Sequence[Part], usual: float, least: float) -> float:
    """Return the power of bursts, 0 where it is no more than `least`: beyond what a count of the encoders makes, too, which is asked where they are."""
    power = _bursts(parts, usual)
    if power > least:
        power = _bursts(parts, usual, [EDGES * edge(p, state.plant) for p in state.inverses])
    return power if power > least else 0.0


def _bursts(parts: Sequence[Part], least: float, counts: Sequence[float] = ()) -> float:
    """Return the power of moving samples beyond `least` robust standard deviations of their surroundings of 2 s, and beyond what each record's
    `counts` make, none where they are not given."""
    power = 0.0
    for p, edges in zip(parts, counts or [0.0] * len(parts), strict=True):
        count = max(1, round(p.residual.size * p.dt / 2.0))
        for r, moves in zip(np.array_split(p.residual, count), np.array_split(p.moves, count), strict=True):
            x = r[moves]
            if x.size >= LEAST_LEAF:
                # about zero, where a fit leaves it: a level that wanders is usual, and so is a friction that changes sign
                usual = 1.4826 * np.median(np.abs(x))
                power += float(np.sum(x[np.abs(x) > max(least * usual, edges)] ** 2))
    return power
