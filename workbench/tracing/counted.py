"""What an effect would explain of a machine that lacks nothing, for no reason but its encoders' counts.

Counts are noise in the motion, from which every column of the model is made, and least squares lean on a noisy column: an
inertia comes out too small, and setting a fixed one free explains a part of what the counts leave (errors in variables;
Fuller, Measurement Error Models, 1987). So the present model is made the machine: it moves between the counts, its drive is
what the model asks for, as is what drives its load, and its encoders read counts.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.identification.solve import NoValue
from workbench.inverse.balances import balances, predicted, required
from workbench.inverse.dynamics import LOAD_DRIVE, InverseDynamics
from workbench.motion import motion
from workbench.plant import Plant
from workbench.record import Record
from workbench.residual.noise_floor import ENCODERS, read_again
from workbench.tracing.budget import BUDGET, Budget
from workbench.tracing.candidates import Candidate
from workbench.tracing.decimation import thin_one
from workbench.tracing.result import CandidateScore
from workbench.tracing.search import fitted, within_reach
from workbench.tracing.state import State
from workbench.tracing.wording_search import of_counts

NEAR = 5.0  # periods of the evaluation band about a step of an encoder, in which the filters let it show


def _sound(inverses: Sequence[InverseDynamics], plant: Plant) -> list[InverseDynamics]:
    """Return decimated inverse dynamics of the records that this plant would leave, without noise of the drive; none where counts are
    unknown."""
    found = []
    for p in inverses:
        records = read_again(p)
        if records is None:
            return []
        band = p.motion.filter.bandwidth
        true, read = InverseDynamics(motion(records[0], band)), records[1]
        made = {"torque" if "torque" in read.channels else "force": predicted(true, plant)}
        if true.rows(plant) > 1:
            made[LOAD_DRIVE] = balances(true, plant)[1]
        found.append(thin_one(InverseDynamics(motion(replace(read, channels={**read.channels, **made}), band))))
    return found


def quantisation_bias(
    candidate: Candidate, state: State, whole: Sequence[InverseDynamics], budget: Budget = BUDGET
) -> float:
    """Return the power that a candidate takes away of what counts alone leave, over that of the state's residual.

    whole: inverse dynamics of the identification records as they are. 0 where nothing comes of it.
    """
    made = _sound(whole, state.plant)
    if not made:
        return 0.0
    try:
        alone = State(within_reach(state.plant, made), made)  # whose travel is not quite that of the records
        _, solution = fitted(candidate, alone.problem, alone.solution, alone.left_at(candidate.at), budget)
    except NoValue:
        return 0.0
    taken = max(alone.solution.cost - solution.cost, 0.0)
    return taken / state.solution.cost if state.solution.cost > 0.0 else 0.0


def by_counts(c: CandidateScore, spurious: float) -> CandidateScore:
    """Return a candidate that does not earn its place, because of what it would take away of the counts alone."""
    return replace(c, earns=False, sentence=f"{c.sentence} {of_counts(spurious)}")


def edge(p: InverseDynamics, plant: Plant) -> float:
    """Return by how much, N*m or N, the drive that a plant asks for changes at most where an encoder goes on by one count; 0 without counts.

    A slow axis goes from count to count, each of which is a jerk of what inertia asks for, far outside what is usual where it stands. Friction,
    which would turn by its whole level, is left out.
    """
    m, record = p.motion, p.motion.record
    after = np.arange(m.u.size) >= m.u.size // 2
    width = round(NEAR / m.filter.bandwidth / m.dt)
    near = slice(max(0, m.u.size // 2 - width), m.u.size // 2 + width)
    smooth = replace(plant, effects=tuple(e for e in plant.effects if not (e.states or "dir" in e.reads)))

    def asked(record: Record) -> np.ndarray:
        """Return the drive that is asked for on a record, behind the evaluation filter."""
        return m.filter(required(InverseDynamics(motion(record, m.filter.bandwidth)), smooth))

    alone, largest = asked(record), 0.0
    for name, count in record.resolution.items():
        if name in ENCODERS and name in record.channels and count > 0.0:
            read = record.channels[name] + count * after
            change = asked(replace(record, channels={**record.channels, name: read})) - alone
            largest = max(largest, float(np.abs(change[near]).max()))
    return largest
